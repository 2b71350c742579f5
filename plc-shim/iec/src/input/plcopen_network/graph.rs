//! Which element gets its values from which, and where loops begin.

use std::collections::BTreeMap;

use super::element::{Kind, Node, attribute};
use super::order::{Rank, finished};
use crate::diagnostic::Code;

/// Something that is wrong with a network, and the element it is wrong with.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) place: std::ops::Range<u32>,
    pub(super) code: Code,
    pub(super) message: String,
}

/// Finds the sources of all connections; continuations get theirs from the connector of their name.
pub(super) fn connect(nodes: &mut [Node<'_>]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut ids: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, node) in nodes.iter().enumerate() {
        if node.id.is_empty() {
            let message = format!("`<{}>` has no attribute `localId`", node.element.name);
            faults.push(Fault { place: node.place(), code: Code::MalformedXml, message });
        } else if ids.contains_key(node.id) {
            let message = format!("there is an element with `localId` {} already", node.id);
            faults.push(Fault { place: node.place(), code: Code::DuplicateElement, message });
        } else {
            ids.insert(node.id, index);
        }
    }
    for node in nodes.iter_mut() {
        for link in node.inputs.iter_mut().flat_map(|input| &mut input.links) {
            let wanted = attribute(link.element, "refLocalId");
            link.source = ids.get(wanted).copied();
            if link.source.is_none() {
                let message = if wanted.is_empty() {
                    "this connection has no `refLocalId`".to_owned()
                } else {
                    format!("there is no element with `localId` {wanted}")
                };
                faults.push(Fault { place: link.element.open.clone(), code: Code::DanglingConnection, message });
            }
        }
    }
    faults.extend(continuations(nodes));
    faults
}

fn continuations(nodes: &mut [Node<'_>]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut connectors: BTreeMap<String, usize> = BTreeMap::new();
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| node.kind == Kind::Connector) {
        let name = attribute(node.element, "name");
        if connectors.insert(name.to_ascii_uppercase(), index).is_some() {
            let message = format!("there is a connector `{name}` already");
            faults.push(Fault { place: node.place(), code: Code::UnpairedConnector, message });
        }
    }
    for node in nodes.iter_mut().filter(|node| node.kind == Kind::Continuation) {
        let name = attribute(node.element, "name");
        let source = connectors.get(&name.to_ascii_uppercase()).copied();
        if source.is_none() {
            let message = format!("there is no connector `{name}`");
            faults.push(Fault { place: node.place(), code: Code::UnpairedConnector, message });
        }
        let link = super::element::Link { element: node.element, source, pin: "" };
        if let Some(input) = node.inputs.first_mut() {
            input.links = vec![link];
        }
    }
    faults
}

/// The elements that each one gets values from.
pub(super) fn sources(nodes: &[Node<'_>]) -> Vec<Vec<usize>> {
    let of = |node: &Node<'_>| {
        let links = node.inputs.iter().flat_map(|input| &input.links);
        links.filter_map(|link| link.source).collect()
    };
    nodes.iter().map(of).collect()
}

/// The network of each element: elements that are connected have the same number. Power rails connect
/// nothing, since all networks of a diagram may share them.
pub(super) fn networks(nodes: &[Node<'_>], sources: &[Vec<usize>]) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..nodes.len()).collect();
    let rail = |index: usize| nodes.get(index).is_none_or(|node| node.kind.is_rail());
    for (index, list) in sources.iter().enumerate() {
        for source in list.iter().filter(|source| !rail(**source) && !rail(index)) {
            let (one, other) = (root(&mut parent, index), root(&mut parent, *source));
            if let Some(slot) = parent.get_mut(one.max(other)) {
                *slot = one.min(other);
            }
        }
    }
    (0..nodes.len()).map(|index| root(&mut parent, index)).collect()
}

fn root(parent: &mut [usize], mut index: usize) -> usize {
    while let Some(above) = parent.get(index).copied().filter(|above| *above != index) {
        let higher = parent.get(above).copied().unwrap_or(above);
        if let Some(slot) = parent.get_mut(index) {
            *slot = higher;
        }
        index = above;
    }
    index
}

/// Cuts every loop where a feedback variable keeps the value of the evaluation before (3rd ed. 8.1.4.3):
/// at an output of an instance, or at a variable in the line. Of several in one loop the one that is
/// evaluated last feeds back: `executionOrderId` says which that is, and where it does not, where they stand.
pub(super) fn cut_loops(nodes: &[Node<'_>], sources: &mut [Vec<usize>], ranks: &[Rank]) -> Vec<Fault> {
    let mut faults = Vec::new();
    loop {
        let loops = components(sources);
        if loops.is_empty() {
            return faults;
        }
        for inside in loops {
            let last = last_of(nodes, &inside, ranks, &mut faults);
            for index in &inside {
                if let Some(list) = sources.get_mut(*index) {
                    list.retain(|source| *source != last);
                }
            }
        }
    }
}

/// A loop with this element in it has nothing to begin with.
pub(super) fn keeps_nothing(node: &Node<'_>) -> Fault {
    let message = "this loop has no feedback variable: no instance and no variable keeps a value in it".into();
    Fault { place: node.place(), code: Code::FeedbackWithoutVariable, message }
}

/// What this element needs is needed too often elsewhere.
pub(super) fn too_large(node: &Node<'_>) -> Fault {
    let message =
        "the contacts and variables of this body are read again by more than 200,000 others; draw it in several \
                   units, or write values that many need to a variable"
            .into();
    Fault { place: node.place(), code: Code::UnsupportedFeature, message }
}

/// The element of a loop whose value the others take from the evaluation before.
fn last_of(nodes: &[Node<'_>], inside: &[usize], ranks: &[Rank], faults: &mut Vec<Fault>) -> usize {
    let keeps = |node: &Node<'_>| match node.kind {
        Kind::Block => !attribute(node.element, "instanceName").is_empty(),
        Kind::InOutVariable => true,
        _ => false,
    };
    let known = |index: &usize| nodes.get(*index).map(|node| (*index, node));
    let keepers: Vec<(usize, &Node<'_>)> = inside.iter().filter_map(known).filter(|(_, node)| keeps(node)).collect();
    let first = inside.iter().copied().min().unwrap_or(0);
    let mut orders: Vec<u32> = keepers.iter().filter_map(|(_, node)| node.order).collect();
    orders.sort_unstable();
    orders.dedup();
    match keepers.as_slice() {
        [] => {
            let Some(node) = nodes.get(first) else { return first };
            faults.push(keeps_nothing(node));
            first
        }
        [(only, _)] => *only,
        _ if orders.len() == keepers.len() => {
            keepers.iter().max_by_key(|(_, node)| node.order).map_or(first, |(index, _)| *index)
        }
        [(one, node), ..] => {
            let message =
                "several elements keep values in this loop, and `executionOrderId` does not say of each when it \
                           comes: those without come last, the highest first, then the one furthest left"
                    .into();
            faults.push(Fault { place: node.place(), code: Code::FeedbackWithoutOrder, message });
            keepers.iter().map(|(index, _)| *index).max_by_key(|index| ranks.get(*index)).unwrap_or(*one)
        }
    }
}

/// The loops: sets of elements each of which gets values from every other (Kosaraju's algorithm).
fn components(sources: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut targets: Vec<Vec<usize>> = vec![Vec::new(); sources.len()];
    for (index, list) in sources.iter().enumerate() {
        for source in list {
            if let Some(list) = targets.get_mut(*source) {
                list.push(index);
            }
        }
    }
    let order = finished((0..sources.len()).collect(), sources);
    let mut found = Vec::new();
    let mut seen = vec![false; sources.len()];
    for start in order.into_iter().rev() {
        let component = reached(start, &targets, &mut seen);
        let itself = sources.get(start).is_some_and(|list| list.contains(&start));
        if component.len() > 1 || component.len() == 1 && itself {
            found.push(component);
        }
    }
    found
}

/// What is reached from `start` and has not been seen.
fn reached(start: usize, edges: &[Vec<usize>], seen: &mut [bool]) -> Vec<usize> {
    let mut open = vec![start];
    let mut found = Vec::new();
    while let Some(index) = open.pop() {
        match seen.get_mut(index) {
            Some(seen) if !*seen => *seen = true,
            _ => continue,
        }
        found.push(index);
        open.extend(edges.get(index).into_iter().flatten());
    }
    found
}
