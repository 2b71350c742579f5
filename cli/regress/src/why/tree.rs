//! What a scan did, as statements within statements.

use std::ops::Range;

use onescan_iec_run::{Act, StatementId, WayId, Wrote};

/// Statements deeper than this belong to the one around them, as in a unit that calls itself without end.
const DEPTH_MAX: usize = 200;

/// A statement as it was executed.
#[derive(Debug, Default)]
pub(super) struct Node {
    /// The statement; nothing for the scan and for the unit that a task runs.
    pub(super) statement: Option<StatementId>,
    /// What it did, in its order.
    pub(super) items: Vec<Item>,
}

/// A statement of a run that has not executed it.
pub(super) static NOTHING: Node = Node { statement: None, items: Vec::new() };

/// One thing that a statement did.
#[derive(Debug)]
pub(super) enum Item {
    Read(Range<usize>),
    Choice(WayId),
    Wrote(Wrote),
    Child(Node),
}

/// The scan: its units, and in each of them statements.
pub(super) fn tree(acts: &[Act]) -> Node {
    let mut open = Open { nodes: vec![Node::default()] };
    for act in acts {
        match act {
            Act::Unit => {
                open.close_to(1);
                open.nodes.push(Node::default());
            }
            Act::Begin(id) => open.begin(*id),
            Act::End(id) => {
                if let Some(at) = open.place_of(*id) {
                    open.close_to(at);
                }
            }
            Act::Choice(id, way) => {
                // What began in it and was left early is over.
                if let Some(at) = open.place_of(*id) {
                    open.close_to(at + 1);
                }
                open.add(Item::Choice(*way));
            }
            Act::Read(range) => open.add(Item::Read(range.start as usize..range.end as usize)),
            Act::Wrote(wrote) => open.add(Item::Wrote(wrote.clone())),
        }
    }
    open.close_to(1);
    open.nodes.pop().unwrap_or_default()
}

/// The statements that have begun and not ended; the scan is the first.
struct Open {
    nodes: Vec<Node>,
}

impl Open {
    fn begin(&mut self, id: StatementId) {
        if self.nodes.len() < DEPTH_MAX {
            self.nodes.push(Node { statement: Some(id), items: Vec::new() });
        }
    }

    fn place_of(&self, id: StatementId) -> Option<usize> {
        self.nodes.iter().rposition(|node| node.statement == Some(id))
    }

    /// Closes all but the outermost `count`.
    fn close_to(&mut self, count: usize) {
        while self.nodes.len() > count.max(1) {
            if let Some(node) = self.nodes.pop() {
                self.add(Item::Child(node));
            }
        }
    }

    fn add(&mut self, item: Item) {
        if let Some(node) = self.nodes.last_mut() {
            node.items.push(item);
        }
    }
}

impl Node {
    /// The statements directly in it.
    pub(super) fn children(&self) -> impl Iterator<Item = &Node> {
        self.items.iter().filter_map(|item| if let Item::Child(child) = item { Some(child) } else { None })
    }

    /// True if it decided something.
    pub(super) fn has_chosen(items: &[Item]) -> bool {
        items.iter().any(|item| matches!(item, Item::Choice(_)))
    }
}
