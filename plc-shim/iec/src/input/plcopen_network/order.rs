//! The order of evaluation (2nd ed. 4.1.3, 4.3.3; 3rd ed. 8.1.4).
//!
//! An element is evaluated when all its inputs have been; a network is done when all its elements are. That
//! leaves open which network comes first, and which of two elements that do not need each other:
//!
//! 1. labels divide a body, by where they stand, into parts that are evaluated from top to bottom;
//! 2. in a part, what has an `executionOrderId` other than 0 comes first, in the order of the ids;
//! 3. then what stands higher, then what is further left, then what the file has first;
//! 4. jumps and returns come last in their network.
//!
//! A network stands where its highest element does, and has its lowest id.

use super::element::{Kind, Node};

/// Where an element comes if nothing else says so.
pub(super) type Key = (u32, (i64, i64), usize);

pub(super) fn key(nodes: &[Node<'_>], index: usize) -> Key {
    let node = nodes.get(index);
    let order = node.and_then(|node| node.order).unwrap_or(u32::MAX);
    (order, node.map_or((0, 0), |node| node.position), index)
}

/// All elements in the order of their evaluation.
pub(super) fn order(nodes: &[Node<'_>], networks: &[usize], sources: &[Vec<usize>]) -> Vec<usize> {
    let is_label = |index: &usize| nodes.get(*index).is_some_and(|node| node.kind == Kind::Label);
    let place = |index: usize| (nodes.get(index).map_or((0, 0), |node| node.position), index);
    let mut labels: Vec<usize> = (0..nodes.len()).filter(is_label).collect();
    labels.sort_by_key(|index| place(*index));
    let mut groups: std::collections::BTreeMap<usize, Vec<usize>> = std::collections::BTreeMap::new();
    for (index, network) in networks.iter().enumerate().filter(|(index, _)| !is_label(index)) {
        if !nodes.get(index).is_some_and(|node| node.kind.is_rail()) {
            groups.entry(*network).or_default().push(index);
        }
    }
    let mut groups: Vec<Vec<usize>> = groups.into_values().collect();
    let highest = |group: &[usize]| group.iter().map(|index| place(*index)).min();
    let part = |group: &[usize]| labels.iter().filter(|label| Some(place(**label)) < highest(group)).count();
    groups.sort_by_cached_key(|group| {
        let first = group.iter().filter_map(|index| nodes.get(*index).and_then(|node| node.order)).min();
        (part(group), first.unwrap_or(u32::MAX), highest(group))
    });
    let mut order = Vec::with_capacity(nodes.len());
    let mut passed = 0;
    for mut group in groups {
        let reached = part(&group);
        order.extend(labels.get(passed..reached).into_iter().flatten());
        passed = passed.max(reached);
        let control = |index: &usize| nodes.get(*index).is_some_and(|node| node.kind.is_control());
        group.sort_by_key(|index| (control(index), key(nodes, *index)));
        order.extend(finished(group, sources));
    }
    order.extend(labels.get(passed..).into_iter().flatten());
    let mut seen = vec![false; nodes.len()];
    // A power rail is needed by many networks.
    order.retain(|index| seen.get_mut(*index).is_some_and(|seen| !std::mem::replace(seen, true)));
    order
}

/// `starts` and all that they need, each behind what it needs itself.
pub(super) fn finished(starts: Vec<usize>, sources: &[Vec<usize>]) -> Vec<usize> {
    let mut order = Vec::new();
    let mut seen = vec![false; sources.len()];
    for start in starts {
        let mut open = vec![(start, 0)];
        if std::mem::replace(seen.get_mut(start).unwrap_or(&mut false), true) {
            continue;
        }
        while let Some((index, next)) = open.last_mut() {
            let source = sources.get(*index).and_then(|list| list.get(*next)).copied();
            *next += 1;
            if let Some(source) = source {
                if seen.get_mut(source).is_some_and(|seen| !std::mem::replace(seen, true)) {
                    open.push((source, 0));
                }
            } else {
                order.push(*index);
                open.pop();
            }
        }
    }
    order
}
