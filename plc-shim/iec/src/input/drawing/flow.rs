//! The order of a chart that its user did not order: by the flow of its data and, where that leaves it open, by position.
//!
//! TwinCAT ("Automatic execution order by data flow") takes the networks from top to bottom and from left to right. In a
//! network an element follows those that its lines come from, and what an element brings to a variable comes right
//! behind it. Where a loop begins the archive does not say, so a chart with one has no order here.

use std::collections::{BTreeMap, BTreeSet};

use super::cfc_element::{Element, Elements, Kind};

/// Positions of the elements in the order in which they are evaluated; nothing if a loop or a jump leaves it open.
pub(super) fn order(read: &Elements<'_>) -> Option<Vec<usize>> {
    let elements = &read.elements;
    if elements.iter().any(|element| matches!(element.kind, Kind::Jump | Kind::Label | Kind::Return)) {
        return None;
    }
    let before = sources(read);
    let networks = networks(&before, elements);
    let rank = |index: usize| (networks[index], weight(&elements[index]), place(&elements[index]), index);
    let mut behind = vec![Vec::new(); elements.len()];
    let mut missing: Vec<usize> = before.iter().map(Vec::len).collect();
    for (index, sources) in before.iter().enumerate() {
        for source in sources {
            behind[*source].push(index);
        }
    }
    let mut ready: BTreeSet<_> = (0..elements.len()).filter(|index| missing[*index] == 0).map(rank).collect();
    let mut order = Vec::with_capacity(elements.len());
    while let Some((_, _, _, next)) = ready.pop_first() {
        order.push(next);
        for index in &behind[next] {
            missing[*index] -= 1;
            if missing[*index] == 0 {
                ready.insert(rank(*index));
            }
        }
    }
    // In a loop each element waits for another.
    (order.len() == elements.len()).then_some(order)
}

/// From the top, then from the left.
fn place(element: &Element<'_>) -> (i64, i64) {
    (element.top, element.left)
}

/// What is evaluated where it is wanted has no turn of its own; what takes a value takes it at once.
fn weight(element: &Element<'_>) -> u8 {
    match element.kind {
        Kind::Box { .. } | Kind::Unknown | Kind::Jump | Kind::Return | Kind::Label => 2,
        Kind::Output => 1,
        Kind::Input | Kind::Comment | Kind::Composer { .. } | Kind::Selector => 0,
    }
}

/// The elements that the lines to each element come from.
fn sources(read: &Elements<'_>) -> Vec<Vec<usize>> {
    let mut owners = BTreeMap::new();
    for (index, element) in read.elements.iter().enumerate() {
        owners.extend(element.outputs.iter().map(|pin| (pin.id.as_str(), index)));
    }
    let of = |element: &Element<'_>| {
        let lines = element.inputs.iter().filter_map(|pin| read.sources.get(&pin.id)).flatten();
        lines.filter_map(|source| owners.get(source.as_str()).copied()).collect()
    };
    read.elements.iter().map(of).collect()
}

/// For each element where its network begins: at the one that is highest, and then furthest to the left.
fn networks(before: &[Vec<usize>], elements: &[Element<'_>]) -> Vec<((i64, i64), usize)> {
    let begin = |index: usize| (place(&elements[index]), index);
    // One element of each network leads to itself, every other one to one nearer to that.
    let mut leads: Vec<usize> = (0..elements.len()).collect();
    for (index, sources) in before.iter().enumerate() {
        for source in sources {
            let (one, other) = (first_of(&mut leads, index), first_of(&mut leads, *source));
            let (first, second) = if begin(one) <= begin(other) { (one, other) } else { (other, one) };
            leads[second] = first;
        }
    }
    (0..elements.len()).map(|index| begin(first_of(&mut leads, index))).collect()
}

/// The element that stands for the network; ways to it are made shorter as they are gone.
fn first_of(leads: &mut [usize], mut index: usize) -> usize {
    while leads[index] != index {
        leads[index] = leads[leads[index]];
        index = leads[index];
    }
    index
}
