//! The first decision of a PLC that went another way.
//!
//! The two programs need not be the same. A decision is known again by its number in its unit; where
//! the unit has more or fewer of them, by what it asks. One that only one of them has does not count.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec_run::{Way, WayId};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use onescan_soft_plc::Ways;

/// Where two runs of a PLC's program first go different ways.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parting {
    pub client: ClientName,
    pub at: VirtualTime,
    /// The decision and its way in each; nothing where a scan has no decision any more.
    pub ways: [Option<Way>; 2],
}

/// What a decision is known by in both programs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Decision {
    /// Its number in its unit.
    Number(u32),
    /// What it asks, and how many of its unit have asked the same before.
    Question(String, usize),
}

/// A way as it is held against those of the other program.
type Key = (String, Decision, Option<u32>);

/// The first scan and decision in which `a` and `b` differ.
pub(super) fn parting(client: &ClientName, a: &Ways, b: &Ways) -> Option<Parting> {
    let keys = [keys(a, b), keys(b, a)];
    let times: BTreeSet<VirtualTime> = a.scans.iter().chain(&b.scans).map(|(at, _)| *at).collect();
    let until = [a, b].into_iter().filter_map(|ways| ways.cut_off).min();
    times.into_iter().take_while(|at| until.is_none_or(|until| *at < until)).find_map(|at| {
        let [mut ours, mut theirs] = [(a, &keys[0]), (b, &keys[1])]
            .map(|(ways, keys)| scan(ways, at).filter_map(|way| Some((*way, keys.get(way)?))));
        let ways = loop {
            match (ours.next(), theirs.next()) {
                (None, None) => return None,
                (Some((_, one)), Some((_, other))) if one == other => {}
                (one, other) => {
                    let known = |ways: &Ways, way: Option<(WayId, &Key)>| ways.known.get(&way?.0).cloned();
                    break [known(a, one), known(b, other)];
                }
            }
        };
        Some(Parting { client: client.clone(), at, ways })
    })
}

/// The ways of the scan at an instant.
fn scan(ways: &Ways, at: VirtualTime) -> impl Iterator<Item = &WayId> {
    let next = ways.scans.partition_point(|(since, _)| *since <= at);
    let found = next.checked_sub(1).and_then(|index| ways.scans.get(index));
    found.into_iter().flat_map(|(_, scan)| scan)
}

/// What the ways of `ours` are known by; those of decisions that `other` has not are left out.
fn keys(ours: &Ways, other: &Ways) -> BTreeMap<WayId, Key> {
    let (named, elsewhere) = (decisions(ours), decisions(other));
    let key = |(id, way): (&WayId, &Way)| {
        let (unit, (number, of)) = (&way.unit, way.number);
        let (here, there) = (named.get(unit)?, elsewhere.get(unit)?);
        let decision = if there.len() == of as usize {
            Decision::Number(number)
        } else {
            let asked = here.get(&number)?;
            there.values().find(|decision| *decision == asked)?.clone()
        };
        Some((*id, (unit.clone(), decision, way.branch)))
    };
    ours.known.iter().filter_map(key).collect()
}

/// The decisions of each unit by their numbers, known by what they ask.
fn decisions(ways: &Ways) -> BTreeMap<&String, BTreeMap<u32, Decision>> {
    let mut units: BTreeMap<&String, BTreeMap<u32, &str>> = BTreeMap::new();
    for way in ways.known.values() {
        units.entry(&way.unit).or_default().insert(way.number.0, &way.question);
    }
    let named = |asked: BTreeMap<u32, &str>| {
        let mut before: BTreeMap<&str, usize> = BTreeMap::new();
        let mut name = |(number, question)| {
            let count = before.entry(question).or_default();
            *count += 1;
            (number, Decision::Question(str::to_owned(question), *count))
        };
        asked.into_iter().map(&mut name).collect()
    };
    units.into_iter().map(|(unit, asked)| (unit, named(asked))).collect()
}
