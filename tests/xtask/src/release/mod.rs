//! A release: what must hold before it, and the files that it consists of. `RELEASING.md` describes the rest.
//!
//! | module | subject |
//! |---|---|
//! | `check` | what must hold, read from the repository |

mod check;

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::Command;

use crate::error::TaskError;
use crate::scripts;

/// Checks, tests and builds a release; with `dry_run` it checks only.
///
/// # Errors
/// Something does not hold, a test fails, or a file cannot be written.
pub(crate) fn release(root: &Path, dry_run: bool, out: &mut impl Write) -> Result<(), TaskError> {
    let found = check::checked(root)?;
    for each in &found.checks {
        let mark = if each.problems.is_empty() { "ok" } else { "NOT READY" };
        writeln!(out, "{:<44} {mark}", each.about)?;
        for problem in &each.problems {
            writeln!(out, "    {problem}")?;
        }
    }
    let broken: Vec<&str> =
        found.checks.iter().filter(|each| !each.problems.is_empty()).map(|each| each.about).collect();
    if !broken.is_empty() {
        return Err(TaskError::NotReady(broken.join("; ")));
    }
    if dry_run {
        writeln!(out, "not done, for --dry-run: cargo deny check, tests/run, the files of version {}", found.version)?;
        return Ok(());
    }
    out.flush()?;
    run(Command::new("cargo").args(["deny", "--locked", "check"]).current_dir(root))?;
    for script in ["run", "dist"] {
        if scripts::run(root, &[OsString::from(script)])? != 0 {
            return Err(TaskError::Failed(format!("cargo xtask {script}")));
        }
    }
    Ok(())
}

/// Runs a command to its end, with this program's input and output.
fn run(command: &mut Command) -> Result<(), TaskError> {
    let program = command.get_program().to_string_lossy().into_owned();
    let words = command.get_args().map(|word| word.to_string_lossy().into_owned());
    let typed = words.fold(program.clone(), |typed, word| typed + " " + &word);
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(TaskError::Failed(typed)),
        Err(source) => Err(TaskError::NotStarted { program, source }),
    }
}

/// What a command writes to its output.
fn output(command: &mut Command) -> Result<String, TaskError> {
    let program = command.get_program().to_string_lossy().into_owned();
    match command.output() {
        Ok(done) if done.status.success() => Ok(String::from_utf8_lossy(&done.stdout).into_owned()),
        Ok(_) => Err(TaskError::Failed(program)),
        Err(source) => Err(TaskError::NotStarted { program, source }),
    }
}
