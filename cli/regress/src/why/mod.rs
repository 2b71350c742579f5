//! Why two runs part: from the signal that differs back through the PLC's variables to the statement in which the
//! runs went apart.
//!
//! Both runs are done again side by side. Up to the first scan after which a PLC's memory differs only digests are
//! compared; from there on all that statements read, write and decide.
//!
//! | module | subject |
//! |---|---|
//! | [`abreast`] | two runs side by side, scan by scan |
//! | [`pairs`] | which statement and variable of one program is which of the other |
//! | [`tree`] | what a scan did, as statements within statements |
//! | [`flow`] | how a difference flows from statement to statement |
//! | [`record`] | a difference, and where it comes from |
//! | [`report`] | the way back, for people and machines |

mod abreast;
mod flow;
mod pairs;
mod record;
pub mod report;
mod tree;

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_iec_run::Application;
use onescan_iec_run::run::ACTS_MAX;
use onescan_scenario::compose::Compiled;
use onescan_scenario::file::ClientFile;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;
use onescan_soft_plc::{Bindings, Bound};

pub use abreast::Side;
pub use record::{Origin, Place, Record, What};

use flow::Flow;
use pairs::Leaves;

/// The way from a signal that differs back to where the runs parted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Why {
    /// The signal; nothing if no output differs, only what is inside the PLC.
    pub signal: Option<SignalName>,
    /// The differences on the way, the signal's first, the first in time last.
    pub links: Vec<Record>,
}

impl Why {
    /// Where the runs part: the statement in each.
    pub fn root(&self) -> Option<&Record> {
        self.links.last()
    }
}

/// A soft PLC as both runs have it.
struct Both {
    applications: [Application; 2],
    bindings: Bindings,
}

/// Follows those of `signals` that a soft PLC writes back to where two runs up to `until` part; if none does, the
/// first output that differs. Nothing if no soft PLC's memory differs.
///
/// # Errors
/// A scenario's PLC does not compile.
pub fn explain(
    sides: [&Side<'_>; 2],
    signals: &[SignalName],
    until: VirtualTime,
) -> Result<Option<Why>, ScenarioError> {
    let plcs = plcs(sides)?;
    let parts = [0, 1].map(|side| {
        let of = |(name, both): (&ClientName, &Both)| (name.clone(), Leaves::of(&both.applications).parts(side));
        plcs.iter().map(of).collect()
    });
    let from = match abreast::first_scan(sides, until, parts) {
        Ok(Some(from)) => from,
        Ok(None) => return Ok(None),
        Err(error) => {
            not_looked_for(&error);
            return Ok(None);
        }
    };
    let mut flows: BTreeMap<ClientName, Flow> = plcs
        .iter()
        .map(|(name, both)| {
            let inputs: Vec<_> = both.bindings.inputs.iter().flat_map(ranges).collect();
            (name.clone(), Flow::new(name.clone(), both.applications.clone(), &inputs))
        })
        .collect();
    let is_written = |signal: &SignalName| {
        plcs.values().any(|both| both.bindings.outputs.iter().any(|bound| bound.port.name == *signal))
    };
    // Where no PLC writes what is asked for, the first output that differs is the answer.
    let is_any = !signals.iter().any(is_written);
    let mut records = Vec::new();
    let mut found: Option<(SignalName, usize)> = None;
    let looked = abreast::acts(sides, from, until, |pair| {
        let (Some(flow), Some(both)) = (flows.get_mut(&pair.client), plcs.get(&pair.client)) else { return true };
        if pair.acts.iter().any(|acts| acts.len() >= ACTS_MAX) {
            // The rest of the scan is not known, so nothing after it can be explained.
            return false;
        }
        flow.scan(pair, &mut records);
        let outputs = both.bindings.outputs.iter();
        let differing = outputs.filter_map(|bound| {
            let record = ranges(bound).find_map(|range| flow.record_at(range))?;
            Some((bound.port.name.clone(), record))
        });
        let differing: Vec<_> = differing.collect();
        let asked = differing.iter().find(|(signal, _)| signals.contains(signal));
        found = asked.cloned().or_else(|| found.take()).or_else(|| differing.first().cloned());
        asked.is_none() && !(is_any && found.is_some())
    });
    if let Err(error) = looked {
        not_looked_for(&error);
        return Ok(None);
    }
    let (signal, record) = match found {
        Some((signal, record)) => (Some(signal), record),
        None if records.is_empty() => return Ok(None),
        None => (None, 0),
    };
    Ok(Some(Why { signal, links: way_back(&records, record) }))
}

/// As [`explain`] up to `until`, an expectation's violation; and where nothing differs up to there, up to `end`. An expectation
/// is violated at the instant that it speaks of, which may lie before the first value that differs.
///
/// # Errors
/// As those of [`explain`].
pub fn explain_violation(
    sides: [&Side<'_>; 2],
    signals: &[SignalName],
    until: VirtualTime,
    end: VirtualTime,
) -> Result<Option<Why>, ScenarioError> {
    match explain(sides, signals, until)? {
        None if until < end => explain(sides, signals, end),
        why => Ok(why),
    }
}

/// What differs is known without the reason for it.
fn not_looked_for(error: &std::io::Error) {
    tracing::warn!("it is not looked for why the runs differ: {error}");
}

/// The soft PLCs that both scenarios have, compiled so that their statements report what they do.
fn plcs(sides: [&Side<'_>; 2]) -> Result<BTreeMap<ClientName, Both>, ScenarioError> {
    let [a, b] = sides;
    let (mut ours, mut found) = (compiled(a.scenario)?, BTreeMap::new());
    for (name, (other, _)) in compiled(b.scenario)? {
        if let Some((application, bindings)) = ours.remove(&name) {
            found.insert(name, Both { applications: [application, other], bindings });
        }
    }
    Ok(found)
}

fn compiled(scenario: &Scenario) -> Result<BTreeMap<ClientName, (Application, Bindings)>, ScenarioError> {
    let traced = abreast::traced(scenario);
    let plcs = traced.file().clients.iter().filter_map(|(name, client)| match client.get_ref() {
        ClientFile::SoftPlc { sources, dialect, bind, .. } => Some((name, sources, *dialect, bind)),
        _ => None,
    });
    let compiled = plcs.map(|(name, sources, dialect, bind)| {
        let Compiled { application, paths, .. } = traced.compiled(name, sources, dialect, bind)?;
        let bindings = traced.bindings(name, &application, &paths)?;
        Ok((name.clone(), (application, bindings)))
    });
    compiled.collect()
}

/// Where a signal lies in the PLC's memory.
fn ranges(bound: &Bound) -> impl Iterator<Item = Range<usize>> {
    let size = bound.port.ty.size();
    bound.places.iter().map(move |place| place.offset..place.offset + place.size(size))
}

/// From a difference back to the first; what repeats on the way is passed once.
fn way_back(records: &[Record], from: usize) -> Vec<Record> {
    let mut links = Vec::new();
    let mut next = Some(from);
    // A record comes from an earlier one; its number says so, as long as it does.
    while let Some(record) = next.and_then(|number| records.get(number)) {
        links.push(record.clone());
        next = match record.origin {
            Origin::Earlier(earlier) | Origin::Feedback(earlier) if links.len() <= records.len() => Some(earlier),
            _ => None,
        };
    }
    links
}
