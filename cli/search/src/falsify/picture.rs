//! The finding, run once more from its start: its digest, and what its signals are over time.

use std::convert::Infallible;

use onescan_report::plot::{Mark, Plot};
use onescan_scenario::Scenario;
use onescan_scenario::expect::{Outcome, Verdict};
use onescan_server::digest::Digest;
use onescan_server::signal::SignalName;
use onescan_server::time::VirtualTime;

use crate::forest::{SearchKind, form, run_until};
use onescan_runner::run::SearchError;
use onescan_runner::run::chosen::Chosen;
use onescan_runner::run::judged::Judged;
use onescan_runner::run::sampler::{Samples, panel};

/// A run from the start.
pub(super) struct Whole {
    pub(super) digest: Option<Digest>,
    pub(super) plot: Plot,
}

/// Runs `scenario` and draws the signals of its plot, or those that are varied and expected if it has none.
///
/// # Errors
/// The session cannot be formed or go on.
pub(super) fn whole(scenario: &Scenario, until: VirtualTime) -> Result<Whole, SearchError> {
    let names = plotted(scenario);
    let mut chosen = Chosen::new(&names);
    let mut samples = Samples { values: vec![Vec::new(); names.len()], names, t_ns: Vec::new() };
    let mut judged = form(SearchKind::Falsify, scenario, until, [])?;
    judged.begin()?;
    chosen.find(judged.session());
    run_until(&mut judged, |judged| {
        take(&mut samples, &chosen, judged);
        Ok::<_, SearchError>(None::<Infallible>)
    })?;
    let measured = judged.measure()?;
    let panels = samples.names.iter().map(|name| panel(scenario, name, std::iter::once(&samples)));
    let plot = Plot {
        title: format!("{}: falsified", scenario.name()),
        runs: vec!["counterexample".to_owned()],
        panels: panels.collect(),
        marks: marks(scenario, &measured.outcomes),
    };
    Ok(Whole { digest: measured.digest, plot })
}

fn take(samples: &mut Samples, chosen: &Chosen, judged: &Judged<'_>) {
    samples.t_ns.push(judged.session().t_v().as_nanos());
    for (row, number) in samples.values.iter_mut().zip(chosen.numbers(judged.session())) {
        row.push(number);
    }
}

fn plotted(scenario: &Scenario) -> Vec<SignalName> {
    let asked: Vec<SignalName> = scenario.file().plot.signals.iter().map(|signal| signal.get_ref().clone()).collect();
    if !asked.is_empty() {
        return asked;
    }
    let mut names: Vec<SignalName> = scenario.varied().inputs.iter().map(|input| input.signal.clone()).collect();
    for signal in &scenario.expectations().signals {
        if !names.contains(signal) {
            names.push(signal.clone());
        }
    }
    names
}

/// Where it first went against what is expected.
fn marks(scenario: &Scenario, outcomes: &[Outcome]) -> Vec<Mark> {
    let named = scenario.expectations().named.iter();
    let mark = |((name, _), outcome): (&(String, _), &Outcome)| match outcome.verdict {
        Verdict::Violated { at, .. } => Some(Mark { t_ns: at.as_nanos(), label: format!("`{name}` violated") }),
        _ => None,
    };
    named.zip(outcomes).filter_map(mark).collect()
}
