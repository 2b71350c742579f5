//! Why a test is not what was reviewed: the statement in which its run parts from that of the reviewed program.

use std::collections::BTreeMap;

use onescan_scenario::Scenario;
use onescan_server::client::SourcePlace;
use onescan_server::signal::SignalName;
use onescan_server::time::VirtualTime;

use super::TestError;
use super::config::TestConfig;
use super::outcome::{Cause, Outcome, Status};
use super::plan::{CaseUnit, Unit, shown};
use super::ran::within;
use super::reference::{Reference, References};
use crate::snapshot::Difference;
use crate::why::report::Runs;
use crate::why::{self, Origin, Place, Record, Side, Why};

/// Tests of a scenario that are explained: what breaks more of them breaks them for the same reason as a rule.
const EXPLAINED: usize = 4;
/// Steps of the way back that a test shows.
const STEPS: usize = 6;

/// Explains the tests that are not what was reviewed, as far as the reviewed program is known.
///
/// # Errors
/// The commit that the user names is none; a file cannot be written.
pub fn explain(config: &TestConfig, units: &[Unit], outcomes: &mut [Outcome]) -> Result<(), TestError> {
    let mut references = References::new(config.against.clone());
    let mut explained: BTreeMap<String, usize> = BTreeMap::new();
    for outcome in outcomes.iter_mut() {
        let is_other = matches!(outcome.status, Status::Changed | Status::Failed | Status::Fault);
        let unit = units.iter().find_map(|unit| match unit {
            Unit::Case(case) if unit.suite() == outcome.suite && case.place.case == outcome.name => Some(case),
            _ => None,
        });
        let Some(unit) = unit.filter(|_| is_other) else { continue };
        let count = explained.entry(outcome.suite.clone()).or_default();
        if *count == EXPLAINED {
            continue;
        }
        *count += 1;
        outcome.cause = cause(unit, outcome, &mut references)?;
    }
    name_alike(outcomes);
    Ok(())
}

/// Names the first test with the same cause in all others that have it.
fn name_alike(outcomes: &mut [Outcome]) {
    let first_of: Vec<Option<usize>> = outcomes
        .iter()
        .map(|outcome| {
            let root = outcome.cause.as_ref()?.root();
            outcomes.iter().position(|other| other.cause.as_ref().is_some_and(|cause| cause.root() == root))
        })
        .collect();
    for (index, first) in first_of.into_iter().enumerate() {
        if let Some(first) = first.filter(|first| *first != index) {
            outcomes[index].cause_as_of = Some(outcomes[first].full_name());
        }
    }
}

fn cause(unit: &CaseUnit, outcome: &Outcome, references: &mut References) -> Result<Option<Cause>, TestError> {
    // A snapshot that cannot be read has been reported with the outcome.
    let Ok(Some(reviewed)) = unit.place.read_reviewed() else { return Ok(None) };
    let Ok(scenario) = Scenario::load_case(&unit.place.scenario, Some(&unit.place.case)) else { return Ok(None) };
    let Some(Reference { commit, scenario: before }) = references.of(unit, &reviewed)? else { return Ok(None) };
    let sides = [&before, &scenario].map(|scenario| Side { scenario, inputs: Vec::new() });
    let (signals, first) = asked(outcome);
    // A PLC that stops has gone another way in the step that it does not end.
    let end = VirtualTime::from_nanos(outcome.virtual_time_ns) + scenario.plan().step();
    let until = first.unwrap_or(end);
    let Some(why) = why::explain_violation(sides.each_ref(), &signals, until, end)? else { return Ok(None) };
    let Lines { shown: mut lines, root, more } = Lines::of(&why, &Runs::since(&commit));
    if more > 0 {
        lines.push(format!("  ... and {more} more: see `onescan diff`"));
    }
    let folder = shown(unit.place.folder());
    let place = why.root().and_then(|root| root.at[1].as_ref().or(root.at[0].as_ref()));
    let place = place.map(|place| SourcePlace { file: within(&folder, &place.file), line: place.line, column: 1 });
    Ok(Some(Cause { commit, place, lines, why: why::report::json(&why), root }))
}

/// The signals that differ, and the time of the first difference or violation, if there is one.
fn asked(outcome: &Outcome) -> (Vec<SignalName>, Option<VirtualTime>) {
    let differing = outcome.differences.iter().filter_map(|difference| match difference {
        Difference::Values { signal, at_ns, .. } => Some((SignalName::new(signal.clone()).ok()?, *at_ns)),
        _ => None,
    });
    let (signals, times): (Vec<SignalName>, Vec<u64>) = differing.unzip();
    let violated = outcome.expectations.iter().filter(|shown| shown.is_violated()).filter_map(|shown| shown.at_ns);
    let first = times.into_iter().chain(violated).min();
    (signals, first.map(VirtualTime::from_nanos))
}

/// The way back in short: where the runs part, in so many lines, then how it comes to the signal.
pub(crate) struct Lines {
    pub(crate) shown: Vec<String>,
    /// So many of them are of the statement in which the runs part.
    pub(crate) root: usize,
    /// So many more links there are.
    pub(crate) more: usize,
}

impl Lines {
    pub(crate) fn of(why: &Why, runs: &Runs) -> Self {
        let mut lines = Vec::new();
        if let Some(root) = why.root() {
            lines.push(format!("the PLC parts from {} here:", runs.names[0]));
            let places = root.at.iter().zip(&runs.names);
            lines.extend(places.filter_map(|(place, name)| Some(statement(name, place.as_ref()?))));
            lines.push(format!("  {}", reason(root, runs)));
        }
        let root = lines.len();
        let rest = why.links.iter().rev().skip(1);
        lines.extend(rest.clone().take(STEPS).map(|record| {
            let place = record.at[1].as_ref().or(record.at[0].as_ref());
            let at = place.map(|place| format!(", {}:{}", place.file, place.line)).unwrap_or_default();
            format!("  {}{at}", why::report::subject(record, runs))
        }));
        Self { shown: lines, root, more: rest.count().saturating_sub(STEPS) }
    }
}

fn statement(name: &str, Place { file, line, unit, text }: &Place) -> String {
    format!("  {name}: {file}:{line} in {unit}: {text}")
}

fn reason(root: &Record, runs: &Runs) -> String {
    let subject = why::report::subject(root, runs);
    match root.origin {
        Origin::Input => format!("{subject}: an input, which comes from outside of the PLC"),
        Origin::Initial => format!("{subject}: it begins with another value"),
        Origin::Here | Origin::Earlier(_) | Origin::Feedback(_) => subject,
    }
}
