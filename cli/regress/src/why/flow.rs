//! How a difference flows through a PLC: both runs' statements side by side, what they read and write, and which of
//! it differs.
//!
//! A value that differs comes from the first differing value that its statement has read, else from the decision
//! that let one run come here and not the other. Where neither is there the runs part.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use onescan_iec_run::{Application, StatementId, Wrote};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::abreast::Pair;
use super::pairs::{Declarations, Leaves, Statements, names};
use super::record::{Origin, Place, Record, What};
use super::tree::{Item, NOTHING, Node, tree};

/// Variables that were written, with who did so last in each run.
type Written<'n> = BTreeMap<usize, [Option<&'n Wrote>; 2]>;

/// What differs in one PLC.
pub(super) struct Flow {
    client: ClientName,
    applications: [Application; 2],
    statements: Statements,
    declarations: Declarations,
    leaves: Leaves,
    /// The variables of input signals.
    inputs: BTreeSet<usize>,
    memories: [Vec<u8>; 2],
    /// The record of each variable that differs.
    origins: BTreeMap<usize, usize>,
    t_v: VirtualTime,
}

impl Flow {
    pub(super) fn new(client: ClientName, applications: [Application; 2], inputs: &[Range<usize>]) -> Self {
        let leaves = Leaves::of(&applications);
        let inputs = inputs.iter().flat_map(|range| leaves.within(0, range.clone())).collect();
        // Of a value only the bytes that change are heard of, and what nothing was heard of is zero: all of it is there.
        let memories = [0, 1].map(|side| vec![0; leaves.end(side)]);
        Self {
            client,
            statements: Statements::of(&applications),
            declarations: Declarations::of(&applications),
            applications,
            leaves,
            inputs,
            memories,
            origins: BTreeMap::new(),
            t_v: VirtualTime::ZERO,
        }
    }

    /// The record of what lies in a part of the first run's memory, if it differs.
    pub(super) fn record_at(&self, range: Range<usize>) -> Option<usize> {
        self.leaves.within(0, range).into_iter().find_map(|leaf| self.origins.get(&leaf).copied())
    }

    /// A variable and its values, if they differ.
    fn difference(&self, leaf: usize) -> Option<What> {
        let memories = self.memories.each_ref().map(Vec::as_slice);
        if !self.leaves.differs(leaf, memories) {
            return None;
        }
        let leaf = &self.leaves.list[leaf];
        let values = [0, 1].map(|side| leaf.text(side, &self.applications[side], memories[side]));
        Some(What::Value { path: leaf.path.clone(), values })
    }

    /// Takes a scan; what differs in it is added to `records`.
    pub(super) fn scan(&mut self, pair: &Pair, records: &mut Vec<Record>) {
        self.t_v = pair.t_v;
        let [a, b] = pair.acts.each_ref().map(|acts| tree(acts));
        let mut walk = Walk { flow: self, records };
        walk.both([&a, &b], None);
    }
}

/// A walk through a scan of both runs.
struct Walk<'w> {
    flow: &'w mut Flow,
    records: &'w mut Vec<Record>,
}

/// Where a walk is in a statement, and what it has found there.
#[derive(Default)]
struct Progress {
    at: [usize; 2],
    /// The first differing value that was read.
    read: Option<usize>,
    /// The last decision in it that went another way, or statement that only one has.
    decided: Option<usize>,
    /// The first differing value that the statement around it has read: it may have chosen whose statement this is, as the
    /// index of an instance that is called does.
    around: Option<usize>,
}

impl Progress {
    fn cause(&self) -> Option<usize> {
        self.read.or(self.decided).or(self.around)
    }
}

impl Walk<'_> {
    /// Goes through a statement that both runs have executed, within one that has read the differing value `around`; gives the
    /// first one that it has read itself.
    fn both(&mut self, nodes: [&Node; 2], around: Option<usize>) -> Option<usize> {
        let mut progress = Progress { around, ..Progress::default() };
        loop {
            self.plain(nodes, &mut progress);
            let next = [0, 1].map(|side| nodes[side].items.get(progress.at[side]));
            match next {
                [None, None] => return progress.read,
                [Some(Item::Choice(a)), Some(Item::Choice(b))] => {
                    progress.at = progress.at.map(|at| at + 1);
                    let ways = [*a, *b];
                    if !self.flow.statements.same_way(ways) {
                        let answers = [0, 1].map(|side| {
                            let way = self.flow.statements.ways[side].get(&ways[side]);
                            way.map_or_else(|| "another way".to_owned(), |way| way.answer.clone())
                        });
                        let decided = self.parting(nodes, What::Way(answers), progress.cause());
                        self.rest(nodes, progress.at, decided);
                        return progress.read;
                    }
                }
                [Some(Item::Child(a)), Some(Item::Child(b))] => self.children(nodes, [a, b], &mut progress),
                [Some(Item::Child(child)), _] => self.only(0, child, &mut progress),
                [_, Some(Item::Child(child))] => self.only(1, child, &mut progress),
                _ => {
                    let decided = progress.cause().unwrap_or_else(|| self.parting(nodes, What::Run, None));
                    self.rest(nodes, progress.at, decided);
                    return progress.read;
                }
            }
        }
    }

    /// What both read and write up to the next statement or decision.
    fn plain(&mut self, nodes: [&Node; 2], progress: &mut Progress) {
        let mut written = Written::new();
        for (side, node) in nodes.into_iter().enumerate() {
            while let Some(item) = node.items.get(progress.at[side]) {
                match item {
                    Item::Read(range) => progress.read = progress.read.or_else(|| self.read(side, range.clone())),
                    Item::Wrote(wrote) => self.apply(side, wrote, &mut written),
                    Item::Choice(_) | Item::Child(_) => break,
                }
                progress.at[side] += 1;
            }
        }
        let cause = progress.cause();
        self.settle(nodes, &written, cause);
    }

    /// Two statements that come next: the same one, or one of them is not in the other run.
    fn children(&mut self, nodes: [&Node; 2], children: [&Node; 2], progress: &mut Progress) {
        let same = match children.map(|child| child.statement) {
            [Some(a), Some(b)] => self.flow.statements.are_one([a, b]),
            [None, None] => true,
            _ => false,
        };
        if same {
            let read = self.both(children, progress.read.or(progress.around));
            let is_value = [0, 1].iter().all(|&side| !Node::has_chosen(&nodes[side].items[..progress.at[side]]));
            // What a function has read is read by the statement that calls it; a branch is not part of a value.
            if is_value && nodes.iter().any(|node| node.statement.is_some()) {
                progress.read = progress.read.or(read);
            }
            progress.at = progress.at.map(|at| at + 1);
            return;
        }
        let known = |side: usize| {
            children[side].statement.is_some_and(|statement| self.flow.statements.has_partner(side, statement))
        };
        let comes = |side: usize| {
            let partner = self.flow.statements.partner(side, children[side].statement?)?;
            let ahead = nodes[1 - side].items.get(progress.at[1 - side]..)?;
            ahead.iter().position(|item| matches!(item, Item::Child(child) if child.statement == Some(partner)))
        };
        // The side whose statement the other has not, or has later, goes ahead alone.
        let side = match [comes(0), comes(1)] {
            _ if !known(0) => 0,
            _ if !known(1) => 1,
            [Some(a), Some(b)] => usize::from(a <= b),
            [came, _] => usize::from(came.is_some()),
        };
        self.only(side, children[side], progress);
    }

    /// A statement that only one run executes here.
    fn only(&mut self, side: usize, child: &Node, progress: &mut Progress) {
        let known = child.statement.is_some_and(|statement| self.flow.statements.has_partner(side, statement));
        let decided = progress.cause().filter(|_| known).unwrap_or_else(|| {
            let mut nodes = [&NOTHING; 2];
            nodes[side] = child;
            self.parting(nodes, What::Run, None)
        });
        let mut written = Written::new();
        self.collect(side, &child.items, &mut written);
        self.settle([&NOTHING; 2], &written, Some(decided));
        progress.decided = progress.decided.or(Some(decided));
        progress.at[side] += 1;
    }

    /// What both still do in a statement in which they went other ways.
    fn rest(&mut self, nodes: [&Node; 2], at: [usize; 2], decided: usize) {
        let mut written = Written::new();
        for side in 0..2 {
            self.collect(side, nodes[side].items.get(at[side]..).unwrap_or_default(), &mut written);
        }
        self.settle(nodes, &written, Some(decided));
    }

    /// Applies all that is written in `items`.
    fn collect<'n>(&mut self, side: usize, items: &'n [Item], written: &mut Written<'n>) {
        for item in items {
            match item {
                Item::Wrote(wrote) => self.apply(side, wrote, written),
                Item::Child(child) => self.collect(side, &child.items, written),
                Item::Read(_) | Item::Choice(_) => {}
            }
        }
    }

    fn apply<'n>(&mut self, side: usize, wrote: &'n Wrote, written: &mut Written<'n>) {
        let memory = &mut self.flow.memories[side];
        for (at, bytes) in &wrote.changes {
            let range = *at as usize..*at as usize + bytes.len();
            if memory.len() < range.end {
                memory.resize(range.end, 0);
            }
            memory[range.clone()].copy_from_slice(bytes);
            for leaf in self.flow.leaves.within(side, range) {
                written.entry(leaf).or_default()[side] = Some(wrote);
            }
        }
    }

    /// The record of a differing value in `range`.
    fn read(&self, side: usize, range: Range<usize>) -> Option<usize> {
        let leaves = self.flow.leaves.within(side, range);
        leaves.into_iter().filter_map(|leaf| self.flow.origins.get(&leaf).copied()).min()
    }

    /// Notes which of what was written differs now.
    fn settle(&mut self, nodes: [&Node; 2], written: &Written<'_>, cause: Option<usize>) {
        for (&leaf, who) in written {
            let Some(what) = self.flow.difference(leaf) else {
                self.flow.origins.remove(&leaf);
                continue;
            };
            let at = [0, 1].map(|side| self.place(side, who[side], nodes[side]));
            // A statement that writes the same variable scan after scan has one record, the first.
            if self.flow.origins.get(&leaf).is_some_and(|&known| self.records[known].at == at) {
                continue;
            }
            let origin = match cause {
                Some(cause) => Origin::Earlier(cause),
                None if at.iter().all(Option::is_none) => self.outside(leaf),
                None => self.here(nodes),
            };
            let record = self.add(at, what, origin);
            self.flow.origins.insert(leaf, record);
        }
    }

    /// Where a value comes from that no statement has written.
    fn outside(&mut self, leaf: usize) -> Origin {
        match (self.flow.inputs.contains(&leaf), self.records.is_empty()) {
            (true, true) => Origin::Input,
            (true, false) => Origin::Feedback(0),
            (false, _) => {
                let path = self.flow.leaves.list[leaf].path.clone();
                self.declared(&path, "").map_or(Origin::Initial, Origin::Earlier)
            }
        }
    }

    /// The declaration of what a text names, if it is another in the other program.
    fn declared(&mut self, text: &str, unit: &str) -> Option<usize> {
        let both = self.flow.declarations.named_in(text, unit)?;
        let [ours, theirs] = both;
        let at = [Some(Place::declared(ours, theirs)), Some(Place::declared(theirs, ours))];
        let name = ours.name.clone();
        Some(self.add(at, What::Declared(name), Origin::Here))
    }

    /// What a statement uses without a word: constants, and the instance that it calls.
    fn unsaid(&mut self, text: &str, unit: &str) -> Option<usize> {
        let used: BTreeSet<String> = names(text).collect();
        let differing = self.flow.origins.iter().filter(|(leaf, _)| {
            let path = &self.flow.leaves.list[**leaf].path;
            names(path).skip(1).any(|part| used.contains(&part))
        });
        differing.map(|(_, record)| *record).min().or_else(|| self.declared(text, unit))
    }

    /// The runs part in a statement: in it, or in one of a function that it calls.
    fn here(&mut self, nodes: [&Node; 2]) -> Origin {
        let is_changed = |side: usize| {
            nodes[side].statement.is_some_and(|statement| !self.flow.statements.is_unchanged(side, statement))
        };
        if is_changed(0) || is_changed(1) {
            return Origin::Here;
        }
        let changed = [0, 1].map(|side| self.changed_within(side, nodes[side]));
        let [a, b] = changed;
        let partner = |side: usize, id: Option<StatementId>| id.and_then(|id| self.flow.statements.partner(side, id));
        let found = [a.or_else(|| partner(1, b)), b.or_else(|| partner(0, a))];
        if found == [None, None] {
            let known = nodes[0].statement.and_then(|statement| self.flow.statements.known[0].get(&statement)).cloned();
            let used = known.and_then(|statement| self.unsaid(&statement.text, &statement.unit));
            return used.map_or(Origin::Here, Origin::Earlier);
        }
        let at = [0, 1].map(|side| self.flow.statements.place(side, found[side]?));
        Origin::Earlier(self.add(at, What::Text, Origin::Here))
    }

    /// The first statement in `node` that is not the same in the other program.
    fn changed_within(&self, side: usize, node: &Node) -> Option<StatementId> {
        node.children().find_map(|child| {
            let own = child.statement.filter(|&statement| !self.flow.statements.is_unchanged(side, statement));
            own.or_else(|| self.changed_within(side, child))
        })
    }

    /// A decision that goes another way, or a statement that only one has.
    fn parting(&mut self, nodes: [&Node; 2], what: What, cause: Option<usize>) -> usize {
        let at = [0, 1].map(|side| self.place(side, None, nodes[side]));
        let origin = match cause {
            Some(cause) => Origin::Earlier(cause),
            None => self.here(nodes),
        };
        self.add(at, what, origin)
    }

    fn add(&mut self, at: [Option<Place>; 2], what: What, origin: Origin) -> usize {
        self.records.push(Record { client: self.flow.client.clone(), t_v: self.flow.t_v, at, what, origin });
        self.records.len() - 1
    }

    /// The statement that wrote; the one that is gone through if it wrote nothing.
    fn place(&self, side: usize, wrote: Option<&Wrote>, node: &Node) -> Option<Place> {
        if let Some(site) = wrote.and_then(|wrote| self.flow.applications[side].site(wrote)) {
            let own = wrote.and_then(|wrote| self.flow.statements.place(side, wrote.statement?));
            let line = own.map_or(site.at.line, |own| own.line);
            return Some(Place { unit: site.at.to_string(), file: site.at.file, line, text: site.statement });
        }
        self.flow.statements.place(side, node.statement?)
    }
}
