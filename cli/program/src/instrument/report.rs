//! What was changed, for people and machines.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use onescan_iec::Diagnostics;
use onescan_iec_project::instrument::{File, Project, diff};
use onescan_report::OutputError;
use serde::Serialize;

use super::error::InstrumentError;
use super::project::relative;
use super::{Destination, Diff, Direction, InstrumentConfig};
use onescan_regress::check::json::Line;
use onescan_regress::check::passed_over::PassedOver;
use onescan_regress::check::report::Report;
use onescan_regress::check::{human, json};
use onescan_runner::format::Format;

/// The report for machines.
#[derive(Serialize)]
struct Json<'a> {
    files: Vec<JsonFile<'a>>,
    /// The file that alone is to be given to the tool, if one holds the whole project.
    #[serde(skip_serializing_if = "Option::is_none")]
    whole: Option<&'a str>,
    /// The file with the gateway's mapping, where the target has addresses.
    #[serde(skip_serializing_if = "Option::is_none")]
    mapping: Option<String>,
    findings: Vec<Line<'a>>,
}

#[derive(Serialize)]
struct JsonFile<'a> {
    file: &'a str,
    change: &'static str,
    /// For each line the line it comes from, `null` for what the shim put in.
    lines: &'a [Option<u32>],
    #[serde(skip_serializing_if = "Option::is_none")]
    diff: Option<String>,
}

/// The file with the gateway's mapping.
#[derive(Clone, Copy)]
pub struct Mapped<'a> {
    /// Where it was written; relative if the project was named so.
    pub path: &'a Path,
    /// The client that it is the link of.
    pub client: &'a str,
}

/// Writes what was found.
///
/// # Errors
/// Those of `out`.
pub fn findings(
    findings: &Diagnostics,
    files: usize,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), InstrumentError> {
    let report = Report { files, findings: vec![findings.clone()], passed_over: PassedOver::default() };
    let written = match format {
        Format::Human => human::write(&report, out),
        Format::Json => json::write(&report, out),
    };
    Ok(written.map_err(OutputError)?)
}

/// Writes what was changed.
///
/// # Errors
/// Those of `out`.
pub fn write(
    config: &InstrumentConfig,
    project: &Project,
    mapping: Option<Mapped<'_>>,
    out: &mut dyn Write,
) -> Result<(), InstrumentError> {
    let written = match config.format {
        Format::Json => write_json(config, project, mapping, out),
        Format::Human => write_human(config, project, mapping, out),
    };
    Ok(written.map_err(OutputError)?)
}

fn write_json(
    config: &InstrumentConfig,
    project: &Project,
    mapping: Option<Mapped<'_>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let file = |file| JsonFile {
        file: file_name(file),
        change: change(file),
        lines: file.lines.lines(),
        diff: (config.diff == Diff::Shown).then(|| diff::unified(file)),
    };
    let findings = project.warnings.findings().iter().map(Line::from).collect();
    let whole = project.whole.as_deref();
    let mapping = mapping.map(|mapped| mapped.path.display().to_string());
    let report = Json { files: project.files.iter().map(file).collect(), whole, mapping, findings };
    serde_json::to_writer(&mut *out, &report)?;
    writeln!(out)
}

fn write_human(
    config: &InstrumentConfig,
    project: &Project,
    mapping: Option<Mapped<'_>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if config.diff == Diff::Shown {
        for file in &project.files {
            write!(out, "{}", diff::unified(file))?;
        }
    }
    if config.destination == Destination::Nowhere {
        return Ok(());
    }
    // A project for MatIEC is one file in one place, with its mapping.
    let is_one = !project.located.is_empty();
    for file in &project.files {
        match mapping {
            Some(Mapped { path, .. }) if is_one && project.whole.as_deref() == Some(file_name(file)) => {
                let name = Path::new(file_name(file)).file_name().unwrap_or_default();
                writeln!(out, "{:<8} {}", change(file), path.with_file_name(name).display())?;
            }
            Some(_) if is_one && file.text.is_some() => {}
            _ => writeln!(out, "{:<8} {}", change(file), written_to(config, file).display())?,
        }
    }
    if let Some(Mapped { path, .. }) = mapping {
        writeln!(out, "new      {}", path.display())?;
    }
    if let Some(whole) = &project.whole {
        let shown = Path::new(whole);
        let whole = shown.file_name().filter(|_| is_one).map_or(shown, Path::new).display();
        let with = if is_one { " and its CONFIGURATION" } else { ": import it alone" };
        writeln!(out, "\n{whole} is the whole project with the shim{with}.")?;
    }
    if let Some(Mapped { path, client }) = mapping {
        let (gap, path) = (if project.whole.is_some() { "" } else { "\n" }, path.display());
        writeln!(out, "{gap}{path} says where the gateway finds its signals: `--gateway {client}={path}`.")?;
    }
    if is_one {
        return Ok(());
    }
    if config.direction == Direction::Attach {
        let gap = if project.whole.is_some() || mapping.is_some() { "" } else { "\n" };
        writeln!(out, "{gap}Run SDSP_Scheduler first in every cycle, in a task of the highest priority.")?;
    }
    Ok(())
}

fn file_name(file: &File) -> &str {
    &file.name
}

/// Where a file of the result is.
fn written_to(config: &InstrumentConfig, file: &File) -> PathBuf {
    match (&config.destination, relative(file, &config.project)) {
        (Destination::Folder(folder), Ok(within)) if file.text.is_some() => folder.join(within),
        _ => PathBuf::from(file_name(file)),
    }
}

fn change(file: &File) -> &'static str {
    match (&file.before, &file.text) {
        (None, _) => "new",
        (_, None) => "deleted",
        (before, text) if before == text => "same",
        _ => "changed",
    }
}
