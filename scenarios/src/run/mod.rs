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
//! | [`expectation`] | what a run had to show |
//! | [`report`] | what came of a run, for people and machines |
//! | [`session_log`] | which client a session waited for |
//! | [`output`] | files that appear whole or not at all |

pub mod compare;
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
pub mod report;
mod sampler;
pub mod session_log;

use std::cell::RefCell;
use std::io::Write;
use std::path::Path;
use std::rc::Rc;
use std::time::Instant;

use onescan_server::lockstep::Lockstep;
use onescan_server::record::csv::CsvRecorder;

pub use config::{Format, Mode, RunConfig, Transport};
pub use error::RunError;
pub use report::{RunReport, Verdict};

use crate::expect::{Trace, TraceEnd};
use crate::scenario::Scenario;
use expectation::Witness;
use interrupt::Interrupt;
use sampler::{Sampler, Samples};
use session_log::SessionLog;

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
    for (client, url) in &config.gateways {
        scenario.commission(client, url.clone())?;
    }
    config.check(&scenario)?;
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
    let folder = match &config.record {
        Some(folder) => Some(output::create_folder(&folder.join(format!("run-{number}")))?),
        None => None,
    };
    let watch = |lockstep: &mut Lockstep| {
        if config.plot.is_some() {
            lockstep.observe(Box::new(Sampler::new(Rc::clone(&samples))));
        }
        let expected = scenario.expectations();
        if !expected.named.is_empty() {
            lockstep.observe(Box::new(Witness::new(Rc::clone(&trace), &expected.signals)));
        }
        if let Some(folder) = &folder {
            lockstep.observe(Box::new(CsvRecorder::new(&folder.join("trajectory.csv"))));
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
    if let Some(folder) = &folder {
        write_summary(&folder.join("run.json"), &report)?;
    }
    let sampled = samples.replace(Samples::default());
    Ok((report, sampled))
}

fn write_summary(path: &Path, report: &RunReport) -> Result<(), RunError> {
    let mut text = serde_json::to_vec_pretty(report).map_err(|e| RunError::Output(e.into()))?;
    text.push(b'\n');
    output::write_whole(path, &text)
}
