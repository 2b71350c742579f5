//! Units in processes of their own, several at a time: one that crashes takes no other with it.

use std::num::NonZeroUsize;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use onescan_base::threads;
use onescan_server::time::TimeSpan;
use serde::de::DeserializeOwned;

use super::Selection;
use super::config::{Progress, TestConfig};
use super::error::TestError;
use super::limited::{Limited, Limits, Said};
use super::live::{self, Live};
use super::plan::Unit;
use super::ran::Worked;
use onescan_runner::error::ExitCode;
use onescan_runner::error::SpawnError;

/// Works on all units; the results are in the units' order.
///
/// # Errors
/// A process cannot be started.
pub fn work(config: &TestConfig, units: &[Unit]) -> Result<Vec<Worked>, TestError> {
    let bar = bar(config.progress == Progress::Bar, units.len(), "tests");
    config.how_far.set_total(units.len() as u64);
    let work = |live: &Live| {
        let done = spread(config.jobs, units.len(), &bar, |index| {
            let worked = timed(config, &units[index]);
            live.ended(&units[index]);
            config.how_far.one_more();
            worked
        });
        done.into_iter().collect()
    };
    live::during(config.progress, units.len(), work)
}

/// Works on a unit, and says how long that took where it is one test.
fn timed(config: &TestConfig, unit: &Unit) -> Result<Worked, TestError> {
    let started = Instant::now();
    let mut worked = one(config, unit)?;
    if let (Unit::Case(_), [ran]) = (unit, &mut worked.tests[..]) {
        ran.wall_ns = Some(wall_ns(started));
    }
    Ok(worked)
}

/// The time since then, as reports hold it.
pub(super) fn wall_ns(started: Instant) -> u64 {
    u64::try_from(started.elapsed().as_nanos()).unwrap_or(u64::MAX)
}

/// Does `count` pieces of work, so many at a time; the results are in their order.
pub fn spread<T: Send>(jobs: NonZeroUsize, count: usize, bar: &ProgressBar, one: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        loop {
            // `Relaxed` is enough: the number alone is shared, and results come over with `join`.
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return done;
            }
            done.push((index, one(index)));
            bar.inc(1);
        }
    };
    let mut done: Vec<(usize, T)> = std::thread::scope(|scope| {
        // This thread works, too: where the system has no more, it does all that there is.
        let others = 1..jobs.get().min(count);
        let workers: Vec<_> = others.map_while(|_| threads::start_in(scope, "worker", worker).ok()).collect();
        let own = worker();
        let joined = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        let theirs = joined.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        own.into_iter().chain(theirs).collect()
    });
    bar.finish_and_clear();
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, one)| one).collect()
}

/// A bar over `count` pieces of work, which are called so.
pub fn bar(is_seen: bool, count: usize, noun: &str) -> ProgressBar {
    let target = if is_seen { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(count as u64), target);
    if let Ok(style) = ProgressStyle::with_template(&format!("[{{bar:40}}] {{pos}} / {{len}} {noun}  {{elapsed}} ")) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// What a process says as JSON on its standard output, or its error, drawn, and its exit code.
///
/// # Errors
/// It cannot be started.
pub fn answer<T: DeserializeOwned>(
    command: &mut Command,
    timeout: TimeSpan,
) -> Result<Result<T, (String, i32)>, SpawnError> {
    let output = said(command, Limits::of_time(Duration::from_nanos(timeout.as_nanos())))?;
    let Some(status) = output.status else {
        let error = format!("not done within {timeout}, which is the limit: it was ended (see `--timeout`)");
        return Ok(Err((error, ExitCode::Fault as i32)));
    };
    let said = || String::from_utf8_lossy(&output.stderr).trim_end().to_owned();
    Ok(match (status.code(), serde_json::from_slice::<T>(&output.stdout)) {
        (Some(0), Ok(answer)) => Ok(answer),
        (Some(code), _) if code != 0 => Err((said(), code)),
        _ => {
            let error = format!("the process of the test ended with {status}: {}", said());
            Err((error, ExitCode::Fault as i32))
        }
    })
}

/// What a process says within its limits, and how it ends.
///
/// # Errors
/// It cannot be started.
pub fn said(command: &mut Command, limits: Limits) -> Result<Said, SpawnError> {
    let spawn = |source| SpawnError { client: "test".to_owned(), command: "onescan".to_owned(), source };
    Limited::start(command, limits).and_then(Limited::output).map_err(spawn)
}

/// This program, to be started once more for a piece of work, with what scenarios may do.
///
/// # Errors
/// The system does not say where it is.
pub fn this_program(worker: &str) -> Result<Command, SpawnError> {
    let spawn = |source| SpawnError { client: "test".to_owned(), command: "onescan".to_owned(), source };
    let mut command = Command::new(std::env::current_exe().map_err(spawn)?);
    command.arg(worker);
    command.envs(onescan_scenario::permission::granted().variables());
    Ok(command)
}

fn one(config: &TestConfig, unit: &Unit) -> Result<Worked, TestError> {
    if let Unit::Unreadable { error, .. } = unit {
        let error = Some((error.clone(), ExitCode::WrongInput as i32));
        return Ok(Worked { error, ..Worked::default() });
    }
    let mut command = command(config, unit, this_program("test-worker")?);
    let answer = answer(&mut command, config.timeout)?;
    Ok(answer.unwrap_or_else(|error| Worked { error: Some(error), ..Worked::default() }))
}

/// What the process of a unit is given.
fn command(config: &TestConfig, unit: &Unit, mut command: Command) -> Command {
    match unit {
        Unit::Case(unit) => {
            command.arg("--scenario").arg(&unit.place.scenario);
            if unit.is_named {
                command.arg("--case").arg(&unit.place.case);
            }
        }
        Unit::Sources(paths) => {
            for path in paths {
                command.arg("--source").arg(path);
            }
            let Selection { tags, skipped_tags, .. } = &config.selection;
            for (option, tags) in [("--tag", tags), ("--skip-tag", skipped_tags)] {
                command.args(tags.iter().map(|tag| format!("{option}={tag}")));
            }
            command.arg("--scan").arg(config.scan.to_string());
            command.arg("--until").arg(format!("{}ns", config.until.as_nanos()));
            if let Some(dialect) = config.dialect {
                command.arg("--dialect").arg(dialect.to_string());
            }
            if let Some(size) = config.word_size {
                command.arg("--word-size").arg(size.to_string());
            }
            for library in &config.libraries {
                command.arg("--library").arg(library);
            }
            if let Some(limit) = config.memory_limit {
                command.arg("--memory-limit").arg(limit.mib().to_string());
            }
        }
        Unit::Unreadable { .. } => {}
    }
    if config.covers() {
        command.arg("--cover");
    }
    if config.html.is_some() {
        command.arg("--draw");
    }
    command
}
