//! Test programs in ST, in the spirit of `TcUnit`: each runs in a fresh soft PLC, scan by scan on virtual time.
//!
//! A test is a PROGRAM, or a `FUNCTION_BLOCK` without inputs, whose name begins with `TEST_`. If it has a
//! BOOL output `Done`, it runs until that is TRUE; else it runs for one scan. Its asserts (`ASSERT` and
//! its kin, `iec/test/assert.st` of the shim) must all hold. Its tags stand before it.

use onescan_plc_shim::input::kind::SourceKind;
use onescan_plc_shim::run::FailedAssert as Failed;
use onescan_plc_shim::syntax::ast::{Declaration, PouKind};
use onescan_plc_shim::syntax::{FileId, parse_in};
use onescan_plc_shim::{
    Application, BuildError, Coverage, ElementaryType, Input, PlcFault, SoftPlc, Task, TaskPlan, VirtualTime,
};
use onescan_server::client::SourcePlace;
use onescan_server::time::TimeSpan;

use super::config::WorkerConfig;
use super::error::{SourcesReport, TestError};
use super::ran::{Covered, FailedAssert, Ran, Worked};
use super::tcunit::sources::Sources;
use super::{tcunit, test_tags};
use crate::check::collect;
use crate::error::Usage;
use crate::run::RunStatus;

/// What the names of tests begin with.
pub const PREFIX: &str = "TEST_";
/// What the programs that hold instances of test blocks begin with.
const HARNESS: &str = "ONESCAN_RUN_";
/// The output that says that a test has come to its end.
const DONE: &str = "Done";

/// A test as it is declared.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Test {
    name: String,
    is_program: bool,
    place: SourcePlace,
    tags: Vec<String>,
}

impl Test {
    /// The program that a task runs for it.
    fn program(&self) -> String {
        if self.is_program { self.name.clone() } else { format!("{HARNESS}{}", self.name) }
    }

    /// The path of its output, if it has one.
    fn done(&self) -> String {
        if self.is_program { format!("{}.{DONE}", self.name) } else { format!("{HARNESS}{}.it.{DONE}", self.name) }
    }
}

/// Runs all tests of the sources, in the order in which they are declared.
///
/// # Errors
/// The sources cannot be read, do not compile, or have no test.
pub fn run(config: &WorkerConfig) -> Result<Worked, TestError> {
    let programs = collect::programs(&config.sources, config.reading())?;
    let mut inputs: Vec<Input> = programs.into_iter().flat_map(|program| program.inputs).collect();
    let sources = Sources::of(&inputs);
    let tests: Vec<Test> = inputs.iter().flat_map(|input| declared(input, &sources)).collect();
    inputs.extend(harness(&tests));
    let plain = Application::builder().memory_limit(config.memory_limit.unwrap_or_default()).inputs(inputs);
    let compiled = if config.cover { plain.covered().build() } else { plain.build() };
    let application = compiled.map_err(|error| match error {
        BuildError::Sources(findings) => TestError::Sources(Box::new(SourcesReport { findings })),
        BuildError::Constant(error) => Usage::new(error.to_string(), None).into(),
    })?;
    let mut worked = Worked::default();
    let mut coverage = Coverage::default();
    for test in tests.iter().filter(|test| config.selection.has_tags(&test.tags)) {
        worked.tests.push(one(config, &application, test, &mut coverage)?);
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

/// The tests that a file declares. Suites of `TcUnit`, and what runs them, are no tests by themselves.
fn declared(input: &Input, sources: &Sources) -> Vec<Test> {
    let file = input.file();
    let unit = parse_in(file.dialect(), FileId(0), file.text()).unit;
    let mut tests = Vec::new();
    for declaration in &unit.declarations {
        let Declaration::Pou(pou) = declaration else { continue };
        let is_program = pou.kind == PouKind::Program;
        let name = &pou.name;
        let is_test = name.text.get(..PREFIX.len()).is_some_and(|start| start.eq_ignore_ascii_case(PREFIX));
        let is_own = match pou.kind {
            PouKind::Program => !sources.is_runner(&name.text),
            PouKind::FunctionBlock => !sources.is_suite(&name.text),
            _ => false,
        };
        if is_test && is_own {
            let at = file.line_column(name.span.start);
            let place = SourcePlace { file: file.name().to_owned(), line: at.line, column: at.column };
            let tags = test_tags::tags(file.dialect(), file.text(), name.span.start);
            tests.push(Test { name: name.text.clone(), is_program, place, tags });
        }
    }
    tests
}

/// A program for each test block, which holds its instance.
fn harness(tests: &[Test]) -> Option<Input> {
    let blocks = tests.iter().filter(|test| !test.is_program);
    let text: String = blocks
        .map(|test| {
            let (program, name) = (test.program(), &test.name);
            format!("PROGRAM {program} VAR it : {name}; END_VAR it(); END_PROGRAM\n")
        })
        .collect();
    (!text.is_empty()).then(|| Input::from_text("(test harness)", SourceKind::Text, text))
}

fn one(
    config: &WorkerConfig,
    application: &Application,
    test: &Test,
    coverage: &mut Coverage,
) -> Result<Ran, TestError> {
    let interval = config.scan.unwrap_or(TimeSpan::millis::<10>());
    let programs = vec![test.program()];
    let plan =
        TaskPlan::new(vec![Task { name: "test".to_owned(), interval: Some(interval), programs, ..Task::default() }]);
    let refused = |error: onescan_plc_shim::RunError| Usage::new(error.to_string(), None);
    let mut plc = SoftPlc::new(application, &plan).map_err(refused)?;
    let done = done_offset(application, test)?;
    let mut ran = Ran {
        tags: test.tags.clone(),
        step_ns: interval.as_nanos(),
        place: Some(test.place.clone()),
        ..Ran::new(test.name.clone(), RunStatus::Completed)
    };
    loop {
        let now_ns = ran.virtual_time_ns.saturating_add(interval.as_nanos());
        if now_ns > config.until.as_nanos() {
            ran.status = RunStatus::Failed;
            let until = config.until;
            ran.error = Some(format!("it is not done at t_v = {until}: its output `{DONE}` is still FALSE"));
            break;
        }
        let scanned = plc.scan(VirtualTime::from_nanos(now_ns));
        (ran.virtual_time_ns, ran.steps) = (now_ns, ran.steps + 1);
        note(&mut ran, &mut plc);
        if let Err(fault) = scanned {
            faulted(&mut ran, &fault);
            break;
        }
        if done.is_none_or(|offset| plc.memory().get(offset).is_some_and(|byte| *byte != 0)) {
            break;
        }
    }
    if let Some(executed) = plc.coverage() {
        coverage.merge(&executed);
    }
    Ok(ran)
}

/// Where the output lies that says that the test is done, if it has one.
fn done_offset(application: &Application, test: &Test) -> Result<Option<usize>, TestError> {
    let Ok(variable) = application.variable(&test.done()) else { return Ok(None) };
    if variable.ty == Some(ElementaryType::Bool) {
        return Ok(Some(variable.offset as usize));
    }
    let message = format!("{}: `{}.{DONE}` is {}, not BOOL", test.place, test.name, variable.type_name);
    Err(Usage::new(message, None).into())
}

/// What the asserts of a scan have found. One that fails in several scans is reported once.
fn note(ran: &mut Ran, plc: &mut SoftPlc) {
    let found = plc.take_asserts();
    ran.asserts_made += found.made;
    for Failed { text, file, at } in found.failed {
        let place = SourcePlace { file, line: at.line, column: at.column };
        match ran.asserts.iter_mut().find(|known| known.place == place) {
            Some(known) => known.times += 1,
            None => ran.asserts.push(FailedAssert { text, kind: None, place, at_ns: ran.virtual_time_ns, times: 1 }),
        }
    }
}

fn faulted(ran: &mut Ran, fault: &PlcFault) {
    let at = &fault.at;
    ran.status = RunStatus::Failed;
    ran.error = Some(format!("PLC fault: {} in {at}{}, t_v = {}", fault.kind, fault.way(), fault.virtual_time));
    if !at.file.is_empty() {
        ran.place = Some(SourcePlace { file: at.file.clone(), line: at.line, column: at.column });
    }
}
