//! Findings for machines: one JSON object per line. A last one counts the files that were passed over, if there are any.

use std::io::{self, Write};

use onescan_iec::Finding;
use onescan_report::Severity;
use serde::Serialize;

use super::passed_over::PassedOver;
use super::report::{Report, severity};

/// One finding. Lines and columns count from 1, columns count characters.
#[derive(Debug, Serialize)]
pub struct Line<'a> {
    /// The stable code, as in `N0101`; see `onescan explain`.
    pub code: &'a str,
    /// How grave it is.
    pub severity: Severity,
    /// The file as it was named, or found in a folder.
    pub file: &'a str,
    /// The line it begins in.
    pub line: u32,
    /// The column it begins at.
    pub column: u32,
    /// The line it ends in.
    pub end_line: u32,
    /// The column behind its last character.
    pub end_column: u32,
    pub message: &'a str,
    /// What to do about it, or `null`.
    pub help: Option<&'a str>,
}

/// The last line: files of folders that were left out.
#[derive(Debug, Serialize)]
pub struct LastLine {
    /// How many, by the reason.
    pub passed_over: PassedOver,
}

impl<'a> From<&'a Finding> for Line<'a> {
    fn from(finding: &'a Finding) -> Self {
        let found = finding.diagnostic();
        let (start, end) = (finding.start(), finding.end());
        Self {
            code: found.code.text(),
            severity: severity(found.severity),
            file: finding.file(),
            line: start.line,
            column: start.column,
            end_line: end.line,
            end_column: end.column,
            message: &found.message,
            help: found.help.as_deref(),
        }
    }
}

/// Writes the report.
///
/// # Errors
/// Those of `out`.
pub fn write(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    for finding in report.iter() {
        serde_json::to_writer(&mut *out, &Line::from(finding))?;
        writeln!(out)?;
    }
    if !report.passed_over.is_empty() {
        serde_json::to_writer(&mut *out, &LastLine { passed_over: report.passed_over })?;
        writeln!(out)?;
    }
    Ok(())
}
