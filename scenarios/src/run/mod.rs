//! Runs of a scenario: one after the other, each reported, recorded and plotted.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`coverage`] | which statements and branches were executed |
//! | [`error`] | why nothing came of it |
//! | [`lockstep`] | one run in lockstep |
//! | [`processes`] | clients as processes of their own |
//! | [`freewheel`] | one run without lockstep |
//! | [`interrupt`] | Ctrl-C, at a step boundary |
//! | [`progress`] | a bar on a terminal |
//! | [`sampler`] | what a plot shows |
//! | [`recorded`] | a run's recording |
//! | [`rerun`] | a recorded run once more |
//! | [`expectation`] | what a run had to show |
//! | [`watch`] | what watched variables were |
//! | [`report`] | what came of a run, for people and machines |
//! | [`output`] | files that appear whole or not at all |

pub mod config;
pub mod coverage;
pub mod error;
pub mod expectation;
mod freewheel;
pub mod interrupt;
mod lockstep;
pub mod output;
mod processes;
mod progress;
pub mod recorded;
pub mod report;
pub mod rerun;
mod sampler;
pub mod watch;

use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;
use std::time::Instant;

use onescan_server::lockstep::Lockstep;

pub use config::{Format, Mode, RunConfig, Transport};
pub use error::RunError;
pub use report::{RunReport, Verdict};

use crate::expect::{Trace, TraceEnd};
use crate::scenario::Scenario;
use expectation::Witness;
use interrupt::Interrupt;
use recorded::Recorded;
use sampler::{Sampler, Samples};
use watch::WatchReport;

/// Runs a scenario as `config` asks, and writes a report of each run to `out`.
///
/// # Errors
/// See [`RunError`]. A failed client is no error here but a verdict: what there is of the run is
/// recorded, plotted and reported.
pub fn execute(config: &RunConfig, interrupt: &Interrupt, out: &mut dyn Write) -> Result<Verdict, RunError> {
    let mut scenario = Scenario::load(&config.scenario)?;
    if config.coverage.is_some() {
        scenario.cover();
    }
    config.check(&scenario)?;
    if !config.watch.is_empty() {
        scenario.watch(&config.watch, config.watch_changes)?;
    }
    let mut reports: Vec<RunReport> = Vec::new();
    let mut samples = Vec::new();
    for number in 1..=config.runs {
        let (report, sampled) = one_run(config, &scenario, number, interrupt)?;
        report.write(config.format, config.runs, out).map_err(RunError::Output)?;
        reports.push(report);
        samples.push(sampled);
        if interrupt.is_raised() || reports.iter().any(RunReport::is_failed) {
            break;
        }
    }
    if let (Some(request), Some(sink)) = (&config.coverage, scenario.coverage()) {
        request.write(sink)?;
    }
    if let Some(path) = &config.plot {
        let plot = sampler::plot(&scenario, config, &samples, &reports);
        output::write_whole(path, plot.to_svg().as_bytes())?;
    }
    let verdict = Verdict::of(config, &reports);
    verdict.write(config, &reports, out).map_err(RunError::Output)?;
    Ok(verdict)
}

/// One run, and what a plot needs of it.
fn one_run(
    config: &RunConfig,
    scenario: &Scenario,
    number: u32,
    interrupt: &Interrupt,
) -> Result<(RunReport, Samples), RunError> {
    let started = Instant::now();
    let samples = Rc::new(RefCell::new(Samples::new(&config.plotted(scenario))));
    let trace = Rc::new(RefCell::new(Trace::default()));
    let recorded = config.record.as_ref().map(|request| Recorded::begin(request, config, scenario, number));
    let (recorded, recorder) = recorded.transpose()?.unzip();
    let watch = |lockstep: &mut Lockstep| {
        if config.plot.is_some() {
            lockstep.observe(Box::new(Sampler::new(Rc::clone(&samples))));
        }
        let expected = scenario.expectations();
        if !expected.named.is_empty() {
            lockstep.observe(Box::new(Witness::new(Rc::clone(&trace), &expected.signals)));
        }
        if let Some(recorder) = recorder {
            lockstep.observe(Box::new(recorder));
        }
    };
    let outcome = match config.mode {
        Mode::Lockstep => lockstep::run(config, scenario, number, interrupt, watch)?,
        Mode::Freewheel => freewheel::run(config, scenario, number, interrupt, watch)?,
    };
    let mut report = RunReport::new(config, scenario, number, &outcome, started.elapsed());
    let mut trace = trace.replace(Trace::default());
    trace.set_end(if report.status == "completed" { TraceEnd::Complete } else { TraceEnd::Cut });
    report.expectations = expectation::judge(scenario, &trace);
    report.watched = WatchReport::take(config, scenario);
    if let Some(recorded) = &recorded {
        recorded.end(&report)?;
    }
    let sampled = samples.replace(Samples::default());
    Ok((report, sampled))
}
