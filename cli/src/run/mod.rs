//! Runs of a scenario: one after the other, each reported, recorded and plotted.
//!
//! | module | subject |
//! |---|---|
//! | [`compare`] | lockstep beside the other ways |
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
//! | `seats` | clients that take part over OPC UA |
//! | [`session_log`] | which client a session waited for |

pub mod compare;
pub mod config;
pub mod coverage;
pub mod error;
pub mod expectation;
mod freewheel;
pub mod interrupt;
mod lockstep;
mod processes;
mod progress;
pub mod recorded;
pub mod report;
pub mod rerun;
mod sampler;
mod seats;
pub mod session_log;
pub mod watch;

use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;
use std::time::Instant;

use onescan_report::file;
use onescan_report::plot::Plot;
use onescan_scenario::expect::{Trace, TraceEnd};
use onescan_scenario::{Mode, Scenario};
use onescan_server::lockstep::Lockstep;
use onescan_server::record::Observer;

pub use config::{Format, RunConfig, Transport};
pub use error::RunError;
pub use report::{RunReport, Verdict};

use crate::regress::page::of_runs;
use crate::regress::ran::Event;
use expectation::Witness;
use interrupt::Interrupt;
use recorded::Recorded;
use sampler::{Sampler, Samples};
use session_log::SessionLog;
use watch::WatchReport;

/// Runs a scenario as `config` asks, and writes a report of each run to `out`.
///
/// # Errors
/// See [`RunError`]. A failed client is no error here but a verdict: what there is of the run is
/// recorded, plotted and reported.
pub fn execute(config: &RunConfig, interrupt: &Interrupt, out: &mut dyn Write) -> Result<Verdict, RunError> {
    let mut scenario = Scenario::load_case(&config.scenario, config.case.as_deref())?;
    // A page says what was executed where that is seen.
    if config.coverage.is_some() || (config.html.is_some() && config.transport == Transport::Inproc) {
        scenario.cover();
    }
    for (client, url) in &config.gateways {
        scenario.commission(client, url.clone())?;
    }
    config.check(&scenario)?;
    if !config.watch.is_empty() {
        scenario.watch(&config.watch, config.watch_changes)?;
    }
    let mut reports: Vec<RunReport> = Vec::new();
    let mut samples = Vec::new();
    for number in 1..=config.runs {
        let (report, sampled) = one_run(config, &scenario, number, interrupt, Vec::new())?;
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
        file::write_whole(path, sampler::picture(&scenario, config, &samples, &reports).as_bytes())?;
    }
    if let Some(path) = &config.html {
        let plot = sampler::plot(&scenario, config, &samples, &reports);
        file::write_whole(path, page(&scenario, &reports, &plot).as_bytes())?;
    }
    let verdict = Verdict::of(config, &reports);
    verdict.write(config, &reports, out).map_err(RunError::Output)?;
    Ok(verdict)
}

/// The page about all runs.
fn page(scenario: &Scenario, reports: &[RunReport], plot: &Plot) -> String {
    let events: Vec<Event> = scenario.case_events().into_iter().map(|(at_ns, text)| Event { at_ns, text }).collect();
    let coverage =
        scenario.coverage().map(|sink| sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone());
    of_runs(reports, scenario.file().step.as_nanos(), &events, plot, &coverage.unwrap_or_default())
}

/// One run that others watch, and its plot; without signals unless the run has a plot.
///
/// # Errors
/// See [`RunError`].
pub(crate) fn watched(
    config: &RunConfig,
    scenario: &Scenario,
    interrupt: &Interrupt,
    observers: Vec<Box<dyn Observer>>,
) -> Result<(RunReport, Plot), RunError> {
    let (report, samples) = one_run(config, scenario, 1, interrupt, observers)?;
    let plot = sampler::plot(scenario, config, &[samples], std::slice::from_ref(&report));
    Ok((report, plot))
}

/// One run, and what a plot needs of it.
fn one_run(
    config: &RunConfig,
    scenario: &Scenario,
    number: u32,
    interrupt: &Interrupt,
    observers: Vec<Box<dyn Observer>>,
) -> Result<(RunReport, Samples), RunError> {
    let started = Instant::now();
    let samples = Rc::new(RefCell::new(Samples::new(&config.sampled(scenario))));
    let trace = Rc::new(RefCell::new(Trace::default()));
    let recorded = config.record.as_ref().map(|request| Recorded::begin(request, config, scenario, number));
    let (recorded, recorder) = recorded.transpose()?.unzip();
    let watch = |lockstep: &mut Lockstep| {
        for observer in observers {
            lockstep.observe(observer);
        }
        if config.plot.is_some() || config.html.is_some() {
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
    let log = SessionLog::default();
    let outcome = match config.mode {
        Mode::Lockstep => lockstep::run(config, scenario, number, interrupt, &log, watch)?,
        Mode::Freewheel | Mode::Halt | Mode::Follow => freewheel::run(config, scenario, number, interrupt, watch)?,
    };
    let mut report = RunReport::new(config, scenario, number, &outcome, started.elapsed());
    report.latency = log.latencies();
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
