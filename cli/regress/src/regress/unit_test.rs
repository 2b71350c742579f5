//! Test programs in ST, in the spirit of `TcUnit`: each runs in a fresh soft PLC, scan by scan on virtual time.
//!
//! A test is a PROGRAM, or a `FUNCTION_BLOCK` without inputs, whose name begins with `TEST_`. If it has a
//! BOOL output `Done`, it runs until that is TRUE; else it runs for one scan. Its asserts (`ASSERT` and
//! its kin, `iec/test/assert.st` of the shim) must all hold. Its tags stand before it.
//!
//! A unit with `{attribute 'test'}` is a test of CODESYS' Test Manager. If it is started by an input `xExecute`, it
//! runs until one of its outputs `xDone`, `xError` and `xAborted` is TRUE.

use onescan_iec::{ElementaryType, Input, Task, TaskPlan, VirtualTime};
use onescan_iec_run::run::FailedAssert as Failed;
use onescan_iec_run::{Application, BuildError, Coverage, PlcFault, SoftPlc, Variable};
use onescan_server::client::SourcePlace;
use onescan_server::time::TimeSpan;

use super::config::WorkerConfig;
use super::declared::{self, Manager, PREFIX, Test};
use super::error::{SourcesReport, TestError};
use super::memory_text;
use super::pool::wall_ns;
use super::ran::{Covered, FailedAssert, Ran, Worked, fault_place};
use super::tcunit;
use super::tcunit::sources::Sources;
use crate::check::collect;
use onescan_runner::error::Usage;
use onescan_runner::run::RunStatus;

/// The output that says that a test has come to its end.
const DONE: &str = "Done";

/// Runs all tests of the sources, in the order in which they are declared.
///
/// # Errors
/// The sources cannot be read, do not compile, or have no test.
pub fn run(config: &WorkerConfig) -> Result<Worked, TestError> {
    let programs = collect::programs(&config.sources, config.reading())?;
    let inputs: Vec<Input> = programs.into_iter().flat_map(|program| program.inputs).collect();
    let sources = Sources::of(&inputs);
    let mut tests: Vec<Test> = Vec::new();
    let mut used: Vec<Input> = Vec::new();
    for input in inputs {
        let (own, is_used) = declared::tests(&input, &sources);
        tests.extend(own);
        used.push(input.used(is_used));
    }
    used.extend(declared::harness(&tests).map(|harness| harness.used(true)));
    let plain = Application::builder().memory_limit(config.memory_limit.unwrap_or_default()).inputs(used);
    let compiled = if config.cover { plain.covered().build() } else { plain.build() };
    let application = compiled.map_err(|error| match error {
        BuildError::Sources(findings) => TestError::Sources(Box::new(SourcesReport { findings })),
        BuildError::Constant(error) => Usage::new(error.to_string(), None).into(),
    })?;
    let mut worked = Worked::default();
    let mut coverage = Coverage::default();
    for test in tests.iter().filter(|test| config.selection.has_tags(&test.tags)) {
        let started = std::time::Instant::now();
        let ran = one(config, &application, test, &mut coverage)?;
        worked.tests.push(Ran { wall_ns: Some(wall_ns(started)), ..ran });
    }
    match tcunit::run(config, &application, &sources, &mut coverage)? {
        Some(ran) => worked.tests.extend(ran),
        None if tests.is_empty() => {
            let help = format!("a test is a PROGRAM or a FUNCTION_BLOCK whose name begins with `{PREFIX}`");
            return Err(Usage::new("there is no test in these sources", Some(help)).into());
        }
        None => {}
    }
    worked.coverage = Covered::all(&coverage);
    Ok(worked)
}

/// How a test says that it has come to its end.
enum End {
    /// It runs for one scan.
    OneScan,
    Done(Variable),
    /// By one of several outputs, once it is started.
    Started(Box<Started>),
}

/// The variables by which CODESYS' Test Manager starts a test and learns what came of it.
struct Started {
    execute: Variable,
    done: Variable,
    error: Option<Variable>,
    aborted: Option<Variable>,
    info: Option<Variable>,
}

impl End {
    fn of(application: &Application, test: &Test) -> Result<Self, TestError> {
        let bool = |name: &str| {
            let found = application.variable(&test.variable(name)).ok();
            found.filter(|variable| variable.ty == Some(ElementaryType::Bool))
        };
        if test.manager.is_some()
            && let Some((execute, done)) = bool("xExecute").zip(bool("xDone"))
        {
            let info = application.variable(&test.variable("sInfo")).ok();
            let started = Started { execute, done, error: bool("xError"), aborted: bool("xAborted"), info };
            return Ok(Self::Started(Box::new(started)));
        }
        let Ok(variable) = application.variable(&test.variable(DONE)) else { return Ok(Self::OneScan) };
        if variable.ty == Some(ElementaryType::Bool) {
            return Ok(Self::Done(variable));
        }
        let message = format!("{}: `{}.{DONE}` is {}, not BOOL", test.place, test.name, variable.type_name);
        Err(Usage::new(message, None).into())
    }

    /// The output that a test which takes too long does not set.
    fn output(&self) -> &'static str {
        if let Self::Started(_) = self { "xDone" } else { DONE }
    }

    /// True if the test has come to its end; why it has failed, if it says so.
    fn reached(&self, memory: &[u8]) -> (bool, Option<String>) {
        let is_set = |variable: &Variable| memory.get(variable.offset as usize).is_some_and(|byte| *byte != 0);
        match self {
            Self::OneScan => (true, None),
            Self::Done(done) => (is_set(done), None),
            Self::Started(started) => {
                let Started { done, error, aborted, info, .. } = &**started;
                let said = info.as_ref().and_then(|info| memory_text::text(info, memory)).unwrap_or_default();
                let said = if said.is_empty() { said } else { format!(": {said}") };
                let failed = [("xError", error), ("xAborted", aborted)].into_iter();
                let failed = failed.filter_map(|(name, output)| output.as_ref().filter(|it| is_set(it)).map(|_| name));
                match failed.into_iter().next() {
                    Some(name) => (true, Some(format!("its output `{name}` is TRUE{said}"))),
                    None => (is_set(done), None),
                }
            }
        }
    }
}

fn one(
    config: &WorkerConfig,
    application: &Application,
    test: &Test,
    coverage: &mut Coverage,
) -> Result<Ran, TestError> {
    let interval = config.scan.unwrap_or(TimeSpan::millis::<10>());
    let mut ran = Ran {
        tags: test.tags.clone(),
        step_ns: interval.as_nanos(),
        place: Some(test.place.clone()),
        ..Ran::new(test.name.clone(), RunStatus::Completed)
    };
    if test.manager.as_ref().is_some_and(|manager| manager.is_multiple) {
        ran.status = RunStatus::Failed;
        ran.error = Some("it is a multitest, which is not run: write a test for each of its cases".to_owned());
        return Ok(ran);
    }
    let programs = vec![test.program()];
    let plan =
        TaskPlan::new(vec![Task { name: "test".to_owned(), interval: Some(interval), programs, ..Task::default() }]);
    let refused = |error: onescan_iec_run::RunError| Usage::new(error.to_string(), None);
    let mut plc = SoftPlc::new(application, &plan).map_err(refused)?;
    let end = End::of(application, test)?;
    let until = until(config, test, &end);
    if let End::Started(started) = &end
        && let Some(byte) = plc.memory_mut().get_mut(started.execute.offset as usize)
    {
        *byte = 1;
    }
    scans(&mut ran, &mut plc, &end, until);
    if let Some(executed) = plc.coverage() {
        coverage.merge(&executed);
    }
    Ok(ran)
}

/// When a test has taken too long.
fn until(config: &WorkerConfig, test: &Test, end: &End) -> VirtualTime {
    let Some(Manager { timeout, .. }) = test.manager.as_ref().filter(|_| matches!(end, End::Started(_))) else {
        return config.until;
    };
    let own = u64::try_from(timeout.as_nanos()).unwrap_or(u64::MAX);
    VirtualTime::from_nanos(own.min(config.until.as_nanos()))
}

fn scans(ran: &mut Ran, plc: &mut SoftPlc, end: &End, until: VirtualTime) {
    loop {
        let now_ns = ran.virtual_time_ns.saturating_add(ran.step_ns);
        if now_ns > until.as_nanos() {
            ran.status = RunStatus::Failed;
            let output = end.output();
            ran.error = Some(format!("it is not done at t_v = {until}: its output `{output}` is still FALSE"));
            return;
        }
        let scanned = plc.scan(VirtualTime::from_nanos(now_ns));
        (ran.virtual_time_ns, ran.steps) = (now_ns, ran.steps + 1);
        note(ran, plc);
        if let Err(fault) = scanned {
            return faulted(ran, &fault);
        }
        let (is_over, error) = end.reached(plc.memory());
        if is_over {
            if error.is_some() {
                ran.status = RunStatus::Failed;
                ran.error = error;
            }
            return;
        }
    }
}

/// What the asserts of a scan have found. One that fails in several scans is reported once.
fn note(ran: &mut Ran, plc: &mut SoftPlc) {
    let found = plc.take_asserts();
    ran.asserts_made += found.made;
    for Failed { text, file, at } in found.failed {
        let place = SourcePlace { file, line: at.line, column: at.column };
        match ran.asserts.iter_mut().find(|known| known.place == place) {
            Some(known) => known.times += 1,
            None => {
                ran.asserts.push(FailedAssert { text, kind: None, place, at_ns: ran.virtual_time_ns, times: 1 });
            }
        }
    }
}

fn faulted(ran: &mut Ran, fault: &PlcFault) {
    let at = &fault.at;
    ran.status = RunStatus::Failed;
    ran.error = Some(format!("PLC fault: {} in {at}{}, t_v = {}", fault.kind, fault.way(), fault.virtual_time));
    if let Some(place) = fault_place(fault) {
        ran.place = Some(place);
    }
}
