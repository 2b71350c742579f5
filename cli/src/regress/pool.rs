//! Units in processes of their own, several at a time: one that crashes takes no other with it.

use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Selection;
use super::config::TestConfig;
use super::error::TestError;
use super::limited::Limited;
use super::plan::Unit;
use super::ran::Worked;
use crate::error::ExitCode;
use crate::error::SpawnError;

/// Works on all units; the results are in the units' order.
///
/// # Errors
/// A process cannot be started.
pub fn work(config: &TestConfig, units: &[Unit]) -> Result<Vec<Worked>, TestError> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<Option<Result<Worked, TestError>>>> = Mutex::new(units.iter().map(|_| None).collect());
    let bar = bar(config, units.len());
    std::thread::scope(|scope| {
        for _ in 0..config.jobs.get().min(units.len()) {
            scope.spawn(|| {
                while let Some((index, unit)) = take(&next, units) {
                    let worked = one(config, unit);
                    // A thread that panicked holds nothing half-written.
                    let mut done = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                    done[index] = Some(worked);
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    let done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    done.into_iter().map(|worked| worked.unwrap_or_else(|| Ok(Worked::default()))).collect()
}

fn take<'u>(next: &AtomicUsize, units: &'u [Unit]) -> Option<(usize, &'u Unit)> {
    let index = next.fetch_add(1, Ordering::Relaxed);
    units.get(index).map(|unit| (index, unit))
}

fn bar(config: &TestConfig, units: usize) -> ProgressBar {
    let target = if config.progress { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(units as u64), target);
    if let Ok(style) = ProgressStyle::with_template("[{bar:40}] {pos} / {len} tests  {elapsed} ") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

fn one(config: &TestConfig, unit: &Unit) -> Result<Worked, TestError> {
    if let Unit::Unreadable { error, .. } = unit {
        let error = Some((error.clone(), ExitCode::WrongInput as i32));
        return Ok(Worked { error, ..Worked::default() });
    }
    let spawn = |source| SpawnError { client: "test".to_owned(), command: "onescan".to_owned(), source };
    let program = std::env::current_exe().map_err(spawn)?;
    let limit = Duration::from_nanos(config.timeout.as_nanos());
    let Some(output) =
        Limited::start(&mut command(config, unit, &program)).map_err(spawn)?.output(limit).map_err(spawn)?
    else {
        let error = format!("not done within {}, which is the limit: it was ended (see `--timeout`)", config.timeout);
        return Ok(Worked { error: Some((error, ExitCode::Fault as i32)), ..Worked::default() });
    };
    let said = || String::from_utf8_lossy(&output.stderr).trim_end().to_owned();
    match (output.status.code(), serde_json::from_slice::<Worked>(&output.stdout)) {
        (Some(0), Ok(worked)) => Ok(worked),
        (Some(code), _) if code != 0 => Ok(Worked { error: Some((said(), code)), ..Worked::default() }),
        _ => {
            let error = format!("the process of the test ended with {}: {}", output.status, said());
            Ok(Worked { error: Some((error, ExitCode::Fault as i32)), ..Worked::default() })
        }
    }
}

/// What the process of a unit is given.
fn command(config: &TestConfig, unit: &Unit, program: &Path) -> Command {
    let mut command = Command::new(program);
    command.arg("test-worker");
    command.envs(onescan_scenario::permission::granted().variables());
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
