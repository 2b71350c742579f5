//! Stubs for libraries that a project names and does not have, written into its folder `libraries`.

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_base::regular;
use onescan_iec::{Code, Dialect, Finding, Input, inspect};
use onescan_iec_project::stubs::{self, MARK};
use onescan_report::OutputError;

use super::collect::{self, LIBRARIES, Reading};
use super::error::CheckError;
use onescan_runner::error::{ExitCode, Unreadable, Usage};

/// The file in it that is written here.
const FILE: &str = "stubs.st";

/// What is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StubsConfig {
    /// Files and folders of one project.
    pub paths: Vec<PathBuf>,
    /// The dialect of all files, if not the one that each file's name says.
    pub dialect: Option<Dialect>,
    /// Sources of libraries that the files use.
    pub libraries: Vec<PathBuf>,
    /// Where the stubs go, if not into `libraries` of the project.
    pub folder: Option<PathBuf>,
}

/// Writes what is missing into the file of stubs, and says so to `out`.
///
/// # Errors
/// A file cannot be read or written, or stands where the stubs should and was not written here.
pub fn write(config: &StubsConfig, out: &mut dyn Write) -> Result<ExitCode, CheckError> {
    let folder = config.folder.clone().unwrap_or_else(|| beside(&config.paths));
    let path = folder.join(FILE);
    let present = present(&path)?;
    let identity = path.canonicalize().ok();
    let reading = Reading { dialect: config.dialect, libraries: &config.libraries, ..Reading::default() };
    let programs = collect::programs(&config.paths, reading)?;
    if programs.len() > 1 {
        let help = "name one folder, or the files of one project".to_owned();
        return Err(Usage::new("stubs are written for one program at a time", Some(help)).into());
    }
    let inputs = programs.into_iter().flat_map(|program| program.inputs);
    let is_other = |input: &Input| {
        let same = Path::new(input.file().name()).canonicalize().ok();
        same.is_none() || same != identity
    };
    let inputs: Vec<Input> = inputs.filter(is_other).collect();
    let written = stubs::write(&inputs, present.as_deref());
    let shown = path.display();
    let said = if written.added == 0 {
        writeln!(out, "nothing is missing that stubs could stand for")
    } else {
        std::fs::create_dir_all(&folder).map_err(Unreadable::at(&folder))?;
        std::fs::write(&path, &written.text).map_err(Unreadable::at(&path))?;
        let count = written.added;
        writeln!(out, "{shown}: {count} declaration{} added", if count == 1 { "" } else { "s" })
    };
    said.map_err(OutputError)?;
    Ok(ExitCode::Ok)
}

/// The text of the file that is there already.
fn present(path: &Path) -> Result<Option<String>, CheckError> {
    if !path.exists() {
        return Ok(None);
    }
    let text = regular::read_text(path).map_err(Unreadable::at(path))?;
    if text.starts_with(MARK) {
        return Ok(Some(text));
    }
    let message = format!("{} was not written by `--write-stubs`, and is left as it is", path.display());
    let help = format!("rename it, or name another folder: --write-stubs={LIBRARIES}/generated");
    Err(Usage::new(message, Some(help)).into())
}

/// The folder `libraries` of the project.
fn beside(paths: &[PathBuf]) -> PathBuf {
    let first = paths.first().map_or(Path::new("."), PathBuf::as_path);
    let folder = if first.is_dir() { first } else { first.parent().unwrap_or(Path::new("")) };
    folder.join(LIBRARIES)
}

/// True for a finding about the call of a stub.
pub fn is_stub(finding: &Finding) -> bool {
    finding.diagnostic().code == Code::StubUsed
}

/// Refuses programs that call stubs.
///
/// # Errors
/// One does, or a file cannot be read.
pub fn deny(paths: &[PathBuf], reading: Reading) -> Result<(), CheckError> {
    for program in collect::programs(paths, reading)? {
        let findings = inspect(program.inputs, program.plan.as_ref());
        let mut uses = findings.findings().iter().filter(|finding| is_stub(finding));
        if let Some(first) = uses.next() {
            let mut message = String::new();
            // Text in memory is always written.
            if first.write_line(&mut message).is_err() {
                message = first.to_string();
            }
            let more = uses.count();
            let help = (more > 0).then(|| format!("{more} more stubs are called: `onescan check` names them"));
            return Err(Usage::new(message, help).into());
        }
    }
    Ok(())
}
