//! What was changed, for people and machines.

use std::io::{self, Write};
use std::path::Path;

use onescan_plc_shim::Diagnostics;
use onescan_plc_shim::instrument::{File, Project, diff};
use onescan_report::OutputError;
use serde::Serialize;

use super::error::InstrumentError;
use super::{Destination, Diff, Direction, InstrumentConfig};
use crate::check::json::Line;
use crate::check::report::Report;
use crate::check::{human, json};
use crate::format::Format;

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
    let report = Report { files, findings: vec![findings.clone()] };
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
    mapping: Option<&Path>,
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
    mapping: Option<&Path>,
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
    let mapping = mapping.map(|path| path.display().to_string());
    let report = Json { files: project.files.iter().map(file).collect(), whole, mapping, findings };
    serde_json::to_writer(&mut *out, &report)?;
    writeln!(out)
}

fn write_human(
    config: &InstrumentConfig,
    project: &Project,
    mapping: Option<&Path>,
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
    let is_told = |file: &&File| project.located.is_empty() || file.is_changed() || file.text.is_none();
    for file in project.files.iter().filter(is_told) {
        writeln!(out, "{:<8} {}", change(file), file_name(file))?;
    }
    if let (Some(mapping), Some(whole)) = (mapping, &project.whole) {
        let (mapping, whole) = (mapping.display(), Path::new(whole).file_name().unwrap_or_default().display());
        writeln!(out, "new      {mapping}\n\n{whole} is the whole project with the shim and its CONFIGURATION.")?;
        return writeln!(out, "{mapping} says where the gateway finds its signals: `--gateway plc={mapping}`.");
    }
    if let Some(whole) = &project.whole {
        writeln!(out, "\n{whole} is the whole project with the shim: import it alone.")?;
    }
    if config.direction == Direction::Attach {
        let gap = if project.whole.is_some() { "" } else { "\n" };
        writeln!(out, "{gap}Run SDSP_Scheduler first in every cycle, in a task of the highest priority.")?;
    }
    Ok(())
}

fn file_name(file: &File) -> &str {
    &file.name
}

fn change(file: &File) -> &'static str {
    match (&file.before, &file.text) {
        (None, _) => "new",
        (_, None) => "deleted",
        (before, text) if before == text => "same",
        _ => "changed",
    }
}
