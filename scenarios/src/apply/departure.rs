//! Where a case departs from the scenario as it is, or from another case: up to there both do the same.

use onescan_server::time::VirtualTime;
use onescan_server::timeline::{Scheduled, When};

use crate::load::Scenario;

/// Where a run of a case can fork from a run without it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Departure {
    /// The last boundary before it does something at a time that the other does not.
    pub at: Option<VirtualTime>,
    /// The conditions on which it does so; the last boundary before one of them comes true.
    pub conditions: Vec<When>,
    /// It does so in the set-up: there is no boundary before.
    pub from_start: bool,
}

impl Scenario {
    /// Where this departs from `other`, which has the same settings.
    pub fn departs_from(&self, other: &Self) -> Departure {
        let mut departure = Departure::default();
        let step = self.file().step;
        for scheduled in only_in_one(self.timeline(), other.timeline()) {
            match &scheduled.when {
                When::At(VirtualTime::ZERO) => departure.from_start = true,
                When::At(at) => {
                    let grid = at.as_nanos().div_ceil(step.as_nanos()).saturating_mul(step.as_nanos());
                    let before = VirtualTime::from_nanos(grid).saturating_sub(step);
                    departure.at = Some(departure.at.map_or(before, |earlier| earlier.min(before)));
                }
                once @ When::Once { .. } if !departure.conditions.contains(once) => {
                    departure.conditions.push(once.clone());
                }
                When::Once { .. } => {}
            }
        }
        departure
    }
}

/// What stands in one list only, each entry as often as it does.
fn only_in_one<'a>(one: &'a [Scheduled], other: &'a [Scheduled]) -> Vec<&'a Scheduled> {
    // What both begin with is most of it where one was made from the other.
    let same = one.iter().zip(other).take_while(|(one, other)| one == other).count();
    let (one, other) = (&one[same..], &other[same..]);
    let mut left: Vec<&Scheduled> = other.iter().collect();
    let mut found = Vec::new();
    for scheduled in one {
        match left.iter().position(|theirs| *theirs == scheduled) {
            Some(place) => drop(left.remove(place)),
            None => found.push(scheduled),
        }
    }
    found.extend(left);
    found
}

#[cfg(test)]
mod tests {
    use onescan_server::operation::Operation;

    use super::*;

    fn stop_at(ns: u64) -> Scheduled {
        Scheduled { when: When::At(VirtualTime::from_nanos(ns)), operation: Operation::Stop }
    }

    #[test]
    fn what_stands_in_both_is_not_a_difference() {
        let (one, other) = ([stop_at(1), stop_at(2), stop_at(2)], [stop_at(2), stop_at(3)]);
        let times: Vec<_> = only_in_one(&one, &other).into_iter().cloned().collect();
        assert_eq!(times, [stop_at(1), stop_at(2), stop_at(3)]);
        assert!(only_in_one(&one, &one).is_empty());
    }
}
