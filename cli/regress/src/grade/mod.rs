//! `onescan grade`: programs that were handed in for a task, each run in every case, and its marks.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | `task` | a task: its cases, and what each expectation is worth |
//! | `submission` | which submissions are meant |
//! | [`worker`] | one submission, in a process of its own |
//! | `limit` | what that process may take of the machine |
//! | `hand_in` | its sources, within limits |
//! | `structure` | what a program is like, names and layout aside |
//! | `reason` | which statements have to do with what is missed |
//! | `suspect` | which lines are to be looked at first |
//! | `line` | what the process says |
//! | `marks` | the marks, from what was said |
//! | `alike` | submissions that are equal |
//! | `summary`, `json` | for people and machines |
//! | `page`, `junit`, `spreadsheet` | reports for others |
//!
//! **Invariants.** Marks depend on the task and the program alone, not on who else hands something in, how many are graded at
//! a time, or the machine. Nothing that a submission does or names reaches beyond its process, its folder and its limits.

mod alike;
pub mod config;
mod error;
mod hand_in;
mod json;
mod junit;
mod limit;
mod line;
mod marks;
mod page;
mod reason;
mod spreadsheet;
mod structure;
mod submission;
mod summary;
mod suspect;
mod task;
pub mod worker;

use std::io::Write;
use std::process::Command;
use std::time::{Duration, Instant};

use onescan_report::file::write_output;
use onescan_report::{FileError, OutputError};
use onescan_runner::error::{ExitCode, SpawnError};
use onescan_runner::format::Format;
use onescan_scenario::permission::NO_COMMANDS_VARIABLE;

pub use config::{Detail, GradeConfig, TaskConfig, WorkConfig};
pub use error::GradeError;

use crate::regress::limited::Limits;
use crate::regress::pool::{bar, said, spread, this_program};
use marks::{Graded, Standing};
use submission::Submission;
use task::Task;

/// Bytes that a submission's process may say: cases and coverage of the largest task are a hundredth of it.
const OUTPUT_MAX: u64 = 64 << 20;

/// Grades all submissions, and writes what came of them to `out`.
///
/// # Errors
/// The task is wrong, a submission is not there, or a report cannot be written. What is wrong with a submission is not an
/// error here but its result.
pub fn grade(config: &GradeConfig, out: &mut dyn Write) -> Result<ExitCode, GradeError> {
    let started = Instant::now();
    let task = Task::open(&config.task)?;
    let submissions = submission::meant(&config.submissions)?;
    let bar = bar(config.progress, submissions.len(), "submissions");
    let graded = spread(config.jobs, submissions.len(), &bar, |index| one(config, &task, submissions[index].clone()));
    let mut all = graded.into_iter().collect::<Result<Vec<Graded>, SpawnError>>()?;
    alike::note(&mut all);
    write_reports(config, &task, &all, started.elapsed())?;
    match config.format {
        Format::Human => summary::write(&task, &all, config.detail, out),
        Format::Json => json::write(&task, &all, out),
    }
    .map_err(OutputError)?;
    Ok(exit_code(config, &task, &all))
}

/// Grades one in its process.
fn one(config: &GradeConfig, task: &Task, submission: Submission) -> Result<Graded, SpawnError> {
    let started = Instant::now();
    let limits = Limits { time: Duration::from_nanos(config.time_limit.as_nanos()), output_max: Some(OUTPUT_MAX) };
    let said = said(&mut command(config, task, &submission)?, limits)?;
    let graded = Graded::of(task, submission, &said, (limits, config.memory_limit_mib.get()));
    Ok(Graded { wall_time: started.elapsed(), ..graded })
}

/// The process of a submission. It starts no programs, whatever a scenario in its folder says.
fn command(config: &GradeConfig, task: &Task, submission: &Submission) -> Result<Command, SpawnError> {
    let mut command = this_program("grade-worker")?;
    command.env(NO_COMMANDS_VARIABLE, "1");
    command.arg("--task").arg(&config.task.task).arg("--client").arg(task.client.as_str());
    for (option, paths) in [("--hidden", &config.task.hidden), ("--solution", &config.task.solutions)] {
        for path in paths {
            command.arg(option).arg(path);
        }
    }
    let selection = &config.task.selection;
    for (option, tags) in [("--tag", &selection.tags), ("--skip-tag", &selection.skipped_tags)] {
        command.args(tags.iter().map(|tag| format!("{option}={tag}")));
    }
    command.arg("--memory-limit").arg(config.memory_limit_mib.to_string());
    command.arg("--").arg(&submission.path);
    Ok(command)
}

fn write_reports(config: &GradeConfig, task: &Task, all: &[Graded], wall_time: Duration) -> Result<(), FileError> {
    if let Some(path) = &config.html {
        write_output(path, page::of_class(task, all).to_html().as_bytes())?;
    }
    if let Some(path) = &config.junit {
        write_output(path, junit::text(task, all, wall_time).as_bytes())?;
    }
    if let Some(path) = &config.csv {
        write_output(path, spreadsheet::csv(task, all).as_bytes())?;
    }
    Ok(())
}

/// 3 if a process failed that should not have, 1 if somebody has fewer marks than are asked for, else 0.
fn exit_code(config: &GradeConfig, task: &Task, all: &[Graded]) -> ExitCode {
    let has_too_few =
        |graded: &Graded, pct: u8| u64::from(graded.given()) * 100 < u64::from(pct) * u64::from(task.marks());
    if all.iter().any(|graded| matches!(graded.standing, Standing::Broken(_))) {
        ExitCode::Fault
    } else if config.pass_pct.is_some_and(|pct| all.iter().any(|graded| has_too_few(graded, pct))) {
        ExitCode::Unmet
    } else {
        ExitCode::Ok
    }
}
