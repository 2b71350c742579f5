//! One submission, in a process of its own: it compiles the program, runs every case, and says what it finds as it goes.

use std::io::Write;
use std::sync::PoisonError;

use onescan_base::regular::Within;
use onescan_iec::{Input, Severity};
use onescan_iec_run::{Application, BuildError, Coverage};
use onescan_report::OutputError;
use onescan_runner::interrupt::Interrupt;
use onescan_runner::run::{RunConfig, RunStatus, watched};
use onescan_scenario::Scenario;

use super::config::WorkConfig;
use super::error::GradeError;
use super::line::{Line, Read, Refused, Remarks, text_of};
use super::reason::Reasons;
use super::suspect::Spectrum;
use super::task::{Task, TaskCase};
use super::{hand_in, limit, structure};
use crate::regress::limited::end_with_parent;
use crate::regress::ran::{Covered, Ran, Shown};

/// Grades a submission and writes what comes of it to `out`.
///
/// # Errors
/// The task is wrong, or `out` takes nothing. What is wrong with the submission is a line.
pub fn work(config: &WorkConfig, out: &mut dyn Write) -> Result<(), GradeError> {
    end_with_parent()?;
    limit::apply(config.memory_limit_mib)?;
    let task = Task::open(&config.task)?;
    let mut said = Said(out);
    let read = hand_in::read(&task.client, &config.submission).map_err(|why| Refused::because(&why));
    // Somebody may write the program in the task's own folder.
    let is_own = Within::places(vec![task.scenario.folder().to_owned()]).find(&config.submission).is_ok();
    let (scenario, read) = match read.and_then(|program| compiled(&task, program, is_own)) {
        Ok(compiled) => compiled,
        Err(refused) => return said.line(&Line::Refused(refused)),
    };
    said.line(&Line::Read(read))?;
    let (mut all, mut covered, mut spectrum) = (Vec::new(), Coverage::default(), Spectrum::default());
    for (number, case) in task.cases.iter().enumerate() {
        let (ran, executed) = run(&task, &scenario, case);
        if let Some(executed) = executed {
            covered.merge(&executed);
            spectrum.add(&executed, misses_something(&ran));
        }
        said.line(&Line::Ran(number, Box::new(ran.clone())))?;
        all.push(ran);
    }
    said.line(&Line::Covered(Covered::all(&covered)))?;
    let mut reasons = Reasons::new(&task, &scenario);
    for (number, ran) in all.iter().enumerate() {
        for found in reasons.of_case(number, ran) {
            said.line(&Line::Found(found))?;
        }
    }
    said.line(&Line::Suspects(reasons.suspects(&spectrum)))?;
    said.line(&Line::Done)
}

/// Where it is said.
struct Said<'o>(&'o mut dyn Write);

impl Said<'_> {
    /// Says a line at once, so that it counts whatever comes next.
    fn line(&mut self, line: &Line) -> Result<(), GradeError> {
        serde_json::to_writer(&mut *self.0, line).map_err(|error| OutputError(error.into()))?;
        Ok(writeln!(self.0).and_then(|()| self.0.flush()).map_err(OutputError)?)
    }
}

/// The task with a program, which notes what is executed, and what there is to say of the program.
fn compiled(task: &Task, program: Vec<Input>, is_own: bool) -> Result<(Scenario, Read), Refused> {
    let structure = structure::of(&program);
    // A task may come without a program to complete: then nobody hands it in again. The task's own file is always equal to itself.
    let handed_out = if is_own { None } else { task.scenario.program(&task.client).ok() };
    let own = handed_out.map(|own| structure::of(&own));
    let mut scenario = task.scenario.clone().with_program(&task.client, program);
    let warnings = inspected(task, &scenario)?;
    scenario.cover();
    // Signals without a variable, and tasks of programs that are not there, show when the client is made.
    scenario.member(&task.client).map_err(|error| Refused::because(&text_of(&error)))?;
    let is_as_handed_out = own.as_ref() == Some(&structure);
    Ok((scenario, Read { structure, is_as_handed_out, warnings }))
}

/// The warnings of a program that compiles.
fn inspected(task: &Task, scenario: &Scenario) -> Result<Remarks, Refused> {
    let inputs = scenario.program(&task.client).map_err(|error| Refused::because(&text_of(&error)))?;
    let Some(plc) = scenario.plcs().find(|plc| *plc.name == task.client) else {
        let file = scenario.path().display();
        return Err(Refused::because(&format!("{file}: the task has no soft PLC `{}`", task.client)));
    };
    match Application::builder().inputs(inputs).memory_limit(plc.memory_limit).inspected(plc.plan).build() {
        Ok(application) => Ok(Remarks::of(application.warnings().findings().iter())),
        Err(BuildError::Sources(found)) => {
            let errors = found.findings().iter().filter(|finding| finding.diagnostic().severity == Severity::Error);
            Err(Refused { why: "it does not compile".to_owned(), errors: Remarks::of(errors) })
        }
        Err(BuildError::Constant(error)) => Err(Refused::because(&error.to_string())),
    }
}

/// Runs a case, and says what the program executed in it; nothing if it was not run.
fn run(task: &Task, scenario: &Scenario, case: &TaskCase) -> (Ran, Option<Coverage>) {
    let failed = |error: String| Ran { error: Some(error), ..Ran::new(case.name.clone(), RunStatus::Failed) };
    let applied = match task.applied(scenario, case) {
        Ok(applied) => applied,
        Err(error) => return (failed(text_of(&error)), None),
    };
    // What this case executes, and not what those before it did.
    let mut applied = applied.unobserved();
    applied.cover();
    let config = RunConfig::headless(task.scenario.path().to_owned(), Some(case.name.clone()));
    let ran = match watched(&config, &applied, &Interrupt::new(), Vec::new()) {
        Ok((report, _)) => sayable(Ran::of(&case.name, &report, applied.file().step.as_nanos())),
        Err(error) => failed(text_of(&error)),
    };
    let executed = applied.coverage().map(|sink| sink.lock().unwrap_or_else(PoisonError::into_inner).clone());
    (ran, executed)
}

/// True if a case does not show all that it was to show.
fn misses_something(ran: &Ran) -> bool {
    ran.status != RunStatus::Completed || ran.expectations.iter().any(Shown::is_violated)
}

/// The same without values that JSON has no word for: a program may well make a NaN.
fn sayable(mut ran: Ran) -> Ran {
    ran.expectations.iter_mut().for_each(|shown| shown.values.retain(|(_, value)| value.is_finite()));
    ran
}
