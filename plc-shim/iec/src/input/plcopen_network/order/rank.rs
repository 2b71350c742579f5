//! What comes first where the flow of data leaves it open: an `executionOrderId`, then rows from top to bottom and
//! each from left to right, then the order of the file.
//!
//! Nobody draws to the pixel: what begins less than [`ROW`] lower than the first element of a row is in that row.

use std::collections::BTreeMap;

use crate::input::plcopen_network::element::{Kind, Node};

/// An `executionOrderId`; what has none comes last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::input::plcopen_network) enum Number {
    Given(u32),
    Missing,
}

/// Number, row and how far right, place in the file.
pub(in crate::input::plcopen_network) type Rank = (Number, (i64, i64), usize);

/// Height of a row in units of the drawing, as in Beremiz' generator and in that of `OpenPLC`.
const ROW: i64 = 10;

/// Where the rows begin that these heights make.
fn rows(mut heights: Vec<i64>) -> Vec<i64> {
    heights.sort_unstable();
    let mut starts: Vec<i64> = Vec::new();
    for height in heights {
        if starts.last().is_none_or(|start| height.saturating_sub(*start) >= ROW) {
            starts.push(height);
        }
    }
    starts
}

/// Where the row begins that is at this height.
fn row(starts: &[i64], height: i64) -> i64 {
    let above = starts.partition_point(|start| *start <= height);
    above.checked_sub(1).and_then(|index| starts.get(index)).copied().unwrap_or(height)
}

fn number(node: &Node<'_>) -> Number {
    node.order.map_or(Number::Missing, Number::Given)
}

pub(super) fn by_file(nodes: &[Node<'_>]) -> Vec<Rank> {
    nodes.iter().enumerate().map(|(index, node)| (number(node), (0, 0), index)).collect()
}

pub(super) fn by_drawing(nodes: &[Node<'_>], networks: &[usize]) -> Vec<Rank> {
    // What is read where it is wanted, or is written with its block, makes no rows.
    let apart = |node: &Node<'_>| {
        let with_block = |source: usize| nodes.get(source).is_some_and(|source| source.kind == Kind::Block);
        let mut links = node.inputs.iter().flat_map(|input| &input.links);
        node.kind == Kind::InVariable
            || node.kind == Kind::OutVariable && links.any(|link| link.source.is_some_and(with_block))
    };
    let mut heights: BTreeMap<usize, Vec<i64>> = BTreeMap::new();
    for (node, network) in nodes.iter().zip(networks).filter(|(node, _)| !apart(node)) {
        heights.entry(*network).or_default().push(node.position.0);
    }
    let starts: BTreeMap<usize, Vec<i64>> = heights.into_iter().map(|(network, list)| (network, rows(list))).collect();
    let of = |(index, (node, network)): (usize, (&Node<'_>, &usize))| {
        let (down, right) = node.position;
        let down = starts.get(network).map_or(down, |starts| row(starts, down));
        (number(node), (down, right), index)
    };
    nodes.iter().zip(networks).enumerate().map(of).collect()
}

/// Labels and networks, from the first to the last that is evaluated.
#[derive(Debug)]
pub(super) enum Place {
    Label(usize),
    /// Its elements without power rails and labels.
    Network(Vec<usize>),
}

/// Where a network stands.
struct Corner {
    /// Height of its highest element.
    top: i64,
    /// Where its leftmost element begins.
    left: i64,
    /// How high that stands, or the highest of those below one another.
    beginning: i64,
}

fn corner(nodes: &[Node<'_>], group: &[usize]) -> Corner {
    let places = || group.iter().filter_map(|index| nodes.get(*index)).map(|node| node.position);
    let top = places().map(|(down, _)| down).min().unwrap_or(0);
    let left = places().map(|(_, right)| right).min().unwrap_or(0);
    let leftmost = places().filter(|(_, right)| right.saturating_sub(left) < ROW);
    Corner { top, left, beginning: leftmost.map(|(down, _)| down).min().unwrap_or(top) }
}

/// Networks come as their highest elements stand; of those in one row, the one that begins further left, then the one
/// that begins higher. A network has the lowest of its numbers. Labels divide a body into parts.
pub(super) fn places(nodes: &[Node<'_>], networks: &[usize], as_in_file: bool) -> Vec<Place> {
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut labels = Vec::new();
    for (index, (node, network)) in nodes.iter().zip(networks).enumerate() {
        match node.kind {
            Kind::Label => labels.push(index),
            Kind::LeftRail | Kind::RightRail => {}
            _ => groups.entry(*network).or_default().push(index),
        }
    }
    let groups: Vec<Vec<usize>> = groups.into_values().collect();
    let corner = |group: &[usize]| corner(nodes, group);
    let tops = || groups.iter().map(Vec::as_slice).chain(labels.iter().map(std::slice::from_ref)).map(corner);
    let down_to = rows(tops().map(|corner| corner.top).collect());
    let right_to = rows(tops().map(|corner| corner.left).collect());
    let begin_at = rows(tops().map(|corner| corner.beginning).collect());
    let place = |group: &[usize]| {
        let corner = corner(group);
        let at = [row(&down_to, corner.top), row(&right_to, corner.left), row(&begin_at, corner.beginning)];
        (if as_in_file { [0; 3] } else { at }, group.iter().min().copied().unwrap_or(0))
    };
    let mut labels = labels.clone();
    labels.sort_by_key(|label| place(&[*label]));
    let part = |group: &[usize]| labels.partition_point(|label| place(&[*label]) < place(group));
    let first = |group: &[usize]| {
        let numbers = group.iter().filter_map(|index| nodes.get(*index)).map(number);
        numbers.min().unwrap_or(Number::Missing)
    };
    let mut keyed: Vec<_> =
        groups.iter().map(|group| ((part(group), first(group), place(group)), group.clone())).collect();
    keyed.sort_by_key(|(key, _)| *key);
    let mut found = Vec::with_capacity(keyed.len() + labels.len());
    let mut labels = labels.into_iter().enumerate().peekable();
    for ((part, ..), group) in keyed {
        while let Some((_, label)) = labels.next_if(|(number, _)| *number < part) {
            found.push(Place::Label(label));
        }
        found.push(Place::Network(group));
    }
    found.extend(labels.map(|(_, label)| Place::Label(label)));
    found
}
