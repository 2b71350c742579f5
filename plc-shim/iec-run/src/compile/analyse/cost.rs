//! How large units are and who calls them: what is put in the place of a call, and what a call
//! costs.

use std::collections::{BTreeMap, BTreeSet};

use super::reach;
use super::size::{Size, measure};
use onescan_iec::ir::{Guard, Pou, PouId};

/// What costs at most this many instructions is paid for by what contains it.
pub(crate) const SMALL: u64 = 4_000;

/// A unit of at most this size goes wherever it is called.
const TINY: u32 = 60;

/// So does one that is called from one place only, up to this size.
const LONE: u32 = 250;

/// Greatest size of all units together that are inside of one another.
const MAX_NESTED: u32 = 400;

/// What is known of one unit.
#[derive(Debug, Clone, Copy, Default)]
struct Cost {
    /// Of its own statements and of all that is put in place of calls inside.
    size: u32,
    /// How many calls of it there are.
    sites: u32,
    inlined: bool,
    /// It changes nothing but registers and its instance.
    inside: bool,
    /// What a call costs that the unit does not pay for itself.
    call: u64,
    metered: bool,
}

/// What is known of all units.
#[derive(Debug, Default)]
pub(crate) struct Costs {
    units: BTreeMap<PouId, Cost>,
    /// Some unit has statements that a fault ends.
    tries: bool,
}

impl Costs {
    /// Measures the units; returns them in an order in which each follows all that it calls.
    pub(crate) fn new(pous: &BTreeMap<PouId, Pou>) -> (Self, Vec<PouId>) {
        let sizes: BTreeMap<PouId, Size> = pous.iter().map(|(id, pou)| (*id, measure(&pou.body))).collect();
        let order = callees_first(&sizes);
        debug_assert_eq!(order.len(), sizes.len(), "every unit is measured, and once");
        let mut costs = Self { tries: sizes.values().any(|size| size.tries), ..Self::default() };
        for callee in sizes.values().flat_map(Size::all_calls) {
            costs.units.entry(*callee).or_default().sites += 1;
        }
        for id in &order {
            let Some(own) = sizes.get(id) else { continue };
            let inside = own.calls.iter().filter_map(|callee| costs.units.get(callee));
            let inside: u32 = inside.filter(|cost| cost.inlined).map(|cost| cost.size).fold(0, u32::saturating_add);
            let is_inside = |callee: PouId| costs.units.get(&callee).is_some_and(|cost| cost.inside);
            let stays_inside = pous.get(id).is_some_and(|pou| reach::stays_inside(pou, &is_inside));
            // What may come back to itself is guarded at its beginning, which only a function has.
            let guarded = pous.get(id).is_none_or(|pou| pou.guard != Guard::None);
            let cost = costs.units.entry(*id).or_default();
            // It is called before it is known what it costs: it pays itself.
            (cost.metered, cost.call) = (guarded, u64::from(guarded));
            cost.inside = stays_inside;
            cost.size = own.nodes.saturating_add(inside);
            // What a fault ends is a function that knows its unit's registers alone.
            cost.inlined = !guarded && !own.tries && (cost.size <= TINY || (cost.sites == 1 && cost.size <= LONE));
        }
        (costs, order)
    }

    /// True if the unit goes in the place of its call inside of the `active` units, of which the
    /// first has the function.
    pub(crate) fn is_inlined(&self, pou: PouId, active: impl Iterator<Item = PouId>) -> bool {
        let Some(cost) = self.units.get(&pou).filter(|cost| cost.inlined) else { return false };
        let inside = active.skip(1).filter_map(|id| self.units.get(&id));
        inside.map(|cost| cost.size).fold(cost.size, u32::saturating_add) <= MAX_NESTED
    }

    /// What the function of a unit has turned out to cost.
    pub(crate) fn found(&mut self, pou: PouId, call: u64, metered: bool) {
        let cost = self.units.entry(pou).or_default();
        (cost.call, cost.metered) = (call, metered);
    }

    /// True if a call of the unit changes nothing but the instance that it runs on.
    pub(crate) fn stays_inside(&self, pou: PouId) -> bool {
        self.units.get(&pou).is_some_and(|cost| cost.inside)
    }

    /// True if some unit has statements that a fault ends, and the program goes on.
    pub(crate) fn has_tries(&self) -> bool {
        self.tries
    }

    pub(crate) fn of_call(&self, pou: PouId) -> u64 {
        self.units.get(&pou).map_or(1, |cost| cost.call)
    }

    /// True if the unit's function changes the budget itself.
    pub(crate) fn is_metered(&self, pou: PouId) -> bool {
        self.units.get(&pou).is_none_or(|cost| cost.metered)
    }
}

/// Depth first with its own stack. What calls itself stands behind all else that it calls.
fn callees_first(sizes: &BTreeMap<PouId, Size>) -> Vec<PouId> {
    let mut order = Vec::with_capacity(sizes.len());
    let mut seen = BTreeSet::new();
    for root in sizes.keys() {
        let mut path = vec![(*root, 0_usize)];
        if !seen.insert(*root) {
            continue;
        }
        while let Some((id, next)) = path.last_mut() {
            let callee = sizes.get(id).and_then(|size| size.all_calls().nth(*next)).copied();
            *next += 1;
            match callee {
                None => {
                    order.push(*id);
                    path.pop();
                }
                Some(callee) if sizes.contains_key(&callee) && seen.insert(callee) => path.push((callee, 0)),
                Some(_) => {}
            }
        }
    }
    order
}
