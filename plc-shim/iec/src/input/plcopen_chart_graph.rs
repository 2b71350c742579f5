//! The elements of a PLCopen XML chart and what they are connected to (TC6 2.01, `sfcObjects`).

use std::collections::{BTreeMap, BTreeSet};

use onescan_xml::Element;

/// An element of a chart, by its number.
pub(crate) type NodeId = usize;

/// A network of elements, those inside of macro steps too.
#[derive(Default)]
pub struct Graph<'e> {
    pub(crate) nodes: Vec<Node<'e>>,
    /// The elements behind each.
    behind: BTreeMap<NodeId, Vec<NodeId>>,
}

pub struct Node<'e> {
    pub element: &'e Element,
    /// The `SFC` that it stands in: the unit's, or that of a macro step.
    pub chart: &'e Element,
    pub(crate) kind: Kind,
    /// The elements before it.
    before: Vec<NodeId>,
    /// Of a macro step, what it stands for.
    inside: Vec<NodeId>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Step,
    Macro,
    Jump,
    Transition,
    /// Beginning or end of alternatives or simultaneous sequences.
    Branch,
    Actions,
    /// What a condition or action is connected to, comments and the like.
    Other,
}

/// Where a path along the links comes to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    Step(NodeId),
    /// What jumps to a step.
    Jump(NodeId),
    /// Another transition, or nothing.
    Wrong(NodeId),
}

/// A connection to an element that is not there.
pub struct Dangling<'e> {
    pub(crate) connection: &'e Element,
}

fn kind(element: &Element) -> Kind {
    match element.name.as_str() {
        "step" => Kind::Step,
        "macroStep" => Kind::Macro,
        "jumpStep" => Kind::Jump,
        "transition" => Kind::Transition,
        "selectionDivergence" | "selectionConvergence" | "simultaneousDivergence" | "simultaneousConvergence" => {
            Kind::Branch
        }
        "actionBlock" => Kind::Actions,
        _ => Kind::Other,
    }
}

/// What an element's own inputs are connected to; the condition of a transition is none of them.
pub fn connections(element: &Element) -> impl Iterator<Item = &Element> {
    let inputs = element.elements().filter(|inner| inner.name == "connectionPointIn");
    inputs.flat_map(Element::elements).filter(|inner| inner.name == "connection")
}

/// A coordinate or identifier of PLCopen XML, rounded towards zero.
pub fn number(value: &str) -> Option<i64> {
    // Some tools write coordinates as reals.
    value.trim().parse().ok().or_else(|| value.trim().parse::<f64>().ok().map(|real| real as i64))
}

impl<'e> Graph<'e> {
    /// The elements below `chart`, and the connections that lead nowhere.
    pub fn new(chart: &'e Element) -> (Self, Vec<Dangling<'e>>) {
        let mut graph = Self::default();
        let mut dangling = Vec::new();
        graph.add(chart, &mut dangling);
        for (id, node) in graph.nodes.iter().enumerate() {
            for before in &node.before {
                graph.behind.entry(*before).or_default().push(id);
            }
        }
        (graph, dangling)
    }

    /// Numbers `localId` are those of one chart: a macro step has its own.
    fn add(&mut self, chart: &'e Element, dangling: &mut Vec<Dangling<'e>>) -> Vec<NodeId> {
        let mut by_number = BTreeMap::new();
        let mut own = Vec::new();
        for element in chart.elements() {
            let id = self.nodes.len();
            self.nodes.push(Node { element, chart, kind: kind(element), before: Vec::new(), inside: Vec::new() });
            own.push(id);
            if let Some(local) = element.attribute("localId") {
                by_number.entry(local.value.trim().to_owned()).or_insert(id);
            }
            let body = element.child("body").filter(|_| kind(element) == Kind::Macro);
            if let Some(inner) = body.and_then(|body| body.child("SFC")) {
                let inside = self.add(inner, dangling);
                if let Some(node) = self.nodes.get_mut(id) {
                    node.inside = inside;
                }
            }
        }
        for id in &own {
            let Some(element) = self.nodes.get(*id).map(|node| node.element) else { continue };
            if kind(element) == Kind::Other {
                continue;
            }
            for connection in connections(element) {
                let local = connection.attribute("refLocalId").map_or("", |found| found.value.trim());
                match by_number.get(local) {
                    Some(before) => {
                        if let Some(node) = self.nodes.get_mut(*id) {
                            node.before.push(*before);
                        }
                    }
                    None => dangling.push(Dangling { connection }),
                }
            }
        }
        own
    }

    /// The nodes of one kind, in the order of the file.
    pub fn of(&self, wanted: Kind) -> impl Iterator<Item = (NodeId, &Node<'e>)> {
        self.nodes.iter().enumerate().filter(move |(_, node)| node.kind == wanted)
    }

    pub(crate) fn node(&self, id: NodeId) -> Option<&Node<'e>> {
        self.nodes.get(id)
    }

    /// Where it stands from left to right; what has no place keeps that of the file.
    pub(crate) fn column(&self, id: NodeId) -> i64 {
        let position = self.node(id).and_then(|node| node.element.child("position"));
        position.and_then(|position| position.attribute("x")).and_then(|x| number(&x.value)).unwrap_or(0)
    }

    /// The steps before an element.
    pub fn before(&self, id: NodeId) -> Vec<End> {
        let mut found = Vec::new();
        self.collect(id, Way::Before, &mut BTreeSet::new(), &mut found);
        found
    }

    /// The steps behind an element.
    pub(crate) fn behind(&self, id: NodeId) -> Vec<End> {
        let mut found = Vec::new();
        self.collect(id, Way::Behind, &mut BTreeSet::new(), &mut found);
        found
    }

    fn collect(&self, from: NodeId, way: Way, known: &mut BTreeSet<NodeId>, found: &mut Vec<End>) {
        let next = match way {
            Way::Before => self.node(from).map(|node| node.before.clone()),
            Way::Behind => self.behind.get(&from).cloned(),
        };
        for id in next.unwrap_or_default() {
            let Some(node) = self.node(id).filter(|_| known.insert(id)) else { continue };
            match node.kind {
                Kind::Step => found.push(End::Step(id)),
                Kind::Jump => found.push(End::Jump(id)),
                Kind::Branch => self.collect(id, way, known, found),
                Kind::Macro => found.extend(self.edge_of(id, way)),
                Kind::Transition => found.push(End::Wrong(id)),
                Kind::Actions | Kind::Other => {}
            }
        }
    }

    /// The steps at which a macro step is left or entered: those that nothing inside follows or leads to.
    fn edge_of(&self, id: NodeId, way: Way) -> Vec<End> {
        let inside = self.node(id).map_or(&[][..], |node| &node.inside);
        let is_edge = |inner: NodeId| match way {
            Way::Before => self.behind(inner).is_empty() && !self.leads_to_transition(inner),
            Way::Behind => self.node(inner).is_some_and(|node| node.before.is_empty()),
        };
        let mut found = Vec::new();
        for inner in inside {
            match self.node(*inner).map(|node| node.kind) {
                Some(Kind::Step) if is_edge(*inner) => found.push(End::Step(*inner)),
                Some(Kind::Macro) if is_edge(*inner) => found.extend(self.edge_of(*inner, way)),
                _ => {}
            }
        }
        found
    }

    fn leads_to_transition(&self, id: NodeId) -> bool {
        let behind = self.behind.get(&id).map_or(&[][..], Vec::as_slice);
        let leads = [Kind::Transition, Kind::Branch];
        behind.iter().any(|next| self.node(*next).is_some_and(|node| leads.contains(&node.kind)))
    }
}

#[derive(Debug, Clone, Copy)]
enum Way {
    Before,
    Behind,
}
