//! The tests of `TcUnit`: the library runs them, unchanged, in a soft PLC on virtual time; what it has stored of
//! them is read out of the PLC's memory.
//!
//! | module | subject |
//! |---|---|
//! | [`sources`] | which units are suites, which programs run them, where tests are declared |
//! | [`memory`] | values of variables by path |
//! | [`log`] | messages of `ADSLOGSTR`, with which `TcUnit` reports asserts that do not hold |
//! | [`results`] | what `TcUnit` stores when all suites have finished |
//! | [`suites`] | the suites themselves, where they do not finish |
//! | [`judged`] | a test of `TcUnit` as one of ours |
//!
//! **Invariants.** Nothing is written into the PLC. What `TcUnit` says of a test is taken as it is.

mod judged;
mod log;
mod memory;
mod results;
pub(super) mod sources;
mod suites;

use onescan_iec::{Task, TaskPlan, VirtualTime};
use onescan_iec_run::{Application, Coverage, PlcFault, SoftPlc};
use onescan_server::time::TimeSpan;

use super::config::WorkerConfig;
use super::error::TestError;
use super::ran::Ran;
use judged::{Judge, Reason};
use log::{Log, Message};
use memory::View;
use onescan_runner::error::Usage;
use results::Results;
use sources::Sources;

/// A scan may use so many times the instructions that it may elsewhere: a test computes in one scan what a machine does in
/// an hour, and asserts that do not hold are compared with all those before them. A loop without an end takes a minute or
/// so to be found.
const FUEL_FACTOR: u64 = 10_000;

/// How a run of the suites ended.
enum End {
    /// All suites have finished, and their results are stored.
    Finished,
    /// The time was up.
    Late,
    /// The PLC has stopped.
    Fault(Box<PlcFault>),
}

/// Runs the suites of the application, if it has the runner of `TcUnit`.
///
/// # Errors
/// Nothing runs the suites, or the PLC cannot be set up.
pub(super) fn run(
    config: &WorkerConfig,
    application: &Application,
    sources: &Sources,
    coverage: &mut Coverage,
) -> Result<Option<Vec<Ran>>, TestError> {
    let Some(results) = Results::find(application) else { return Ok(None) };
    let plan = plan(config, application, sources)?;
    let mut plc = SoftPlc::new(application, &plan).map_err(|error| Usage::new(error.to_string(), None))?;
    let step = plc.period().or(config.scan).unwrap_or(TimeSpan::millis::<10>());
    let (end, messages) = scans(config, &results, &mut plc, step);
    if let Some(executed) = plc.coverage() {
        coverage.merge(&executed);
    }
    let view = View::new(application, plc.memory());
    let judge = Judge { view, sources, step, now_ns: plc.now().as_nanos(), messages: &messages };
    let tests = match &end {
        End::Finished => judge.stored(),
        End::Late => judge.unfinished(Reason::Late),
        End::Fault(fault) => judge.unfinished(Reason::Fault(fault)),
    };
    if tests.is_empty() {
        return Err(Usage::new("the suites of TcUnit have no test", None).into());
    }
    Ok(Some(tests.into_iter().filter(|test| config.selection.has_tags(&test.tags)).collect()))
}

/// The tasks of the project; without any, one task with the programs that run the suites.
fn plan(config: &WorkerConfig, application: &Application, sources: &Sources) -> Result<TaskPlan, TestError> {
    let own = application.configured_tasks().filter(|plan| !plan.tasks.is_empty());
    let mut plan = if let Some(own) = own {
        own
    } else {
        let interval = Some(config.scan.unwrap_or(TimeSpan::millis::<10>()));
        let programs = sources.runners().map(str::to_owned).collect::<Vec<_>>();
        if programs.is_empty() {
            let help = "write `TcUnit.RUN();` in a program, or name the project whose task runs it".to_owned();
            return Err(Usage::new("no program runs the suites of TcUnit", Some(help)).into());
        }
        TaskPlan::new(vec![Task { name: "test".to_owned(), interval, programs, ..Task::default() }])
    };
    plan.fuel_per_task = plan.fuel_per_task.saturating_mul(FUEL_FACTOR);
    Ok(plan)
}

/// Scans until all is stored and all messages are sent, or the time is up.
fn scans(config: &WorkerConfig, results: &Results, plc: &mut SoftPlc, step: TimeSpan) -> (End, Vec<Message>) {
    let mut log = Log::find(plc.application());
    let mut now_ns: u64 = 0;
    loop {
        now_ns = now_ns.saturating_add(step.as_nanos());
        let is_stored = results.are_stored(plc.memory());
        if now_ns > config.until.as_nanos() {
            // What is stored counts, even if messages about it are still to be sent.
            return (if is_stored { End::Finished } else { End::Late }, log.messages());
        }
        let scanned = plc.scan(VirtualTime::from_nanos(now_ns));
        log.take(plc.memory(), now_ns);
        if let Err(fault) = scanned {
            return (End::Fault(Box::new(fault)), log.messages());
        }
        if results.are_stored(plc.memory()) && results.are_sent(plc.memory()) {
            return (End::Finished, log.messages());
        }
    }
}
