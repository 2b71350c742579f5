//! Findings for people: each with its place in the text, a summary at the end.

use std::io::{self, Write};

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use onescan_plc_shim::{Finding, Severity};

use super::report::Report;

/// So many findings are shown; who has more begins with these.
const SHOWN: usize = 100;

/// A longer line is not shown as a whole.
const LINE_MAX: usize = 400;

/// Writes the report.
///
/// # Errors
/// Those of `out`.
pub fn write(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    let handler = handler();
    for finding in report.iter().take(SHOWN) {
        write_finding(finding, &handler, out)?;
    }
    if let Some(more @ 1..) = report.iter().count().checked_sub(SHOWN) {
        writeln!(out, "... and {more} more\n")?;
    }
    let (errors, warnings) = (report.count(Severity::Error), report.count(Severity::Warning));
    let files = counted(report.files, "file");
    match (errors, warnings) {
        (0, 0) => writeln!(out, "{files}, no findings"),
        (errors, 0) => writeln!(out, "{} in {}", counted(errors, "error"), concerned(report)),
        (0, warnings) => writeln!(out, "{} in {}", counted(warnings, "warning"), concerned(report)),
        (errors, warnings) => {
            let (errors, warnings) = (counted(errors, "error"), counted(warnings, "warning"));
            writeln!(out, "{errors}, {warnings} in {}", concerned(report))
        }
    }
}

fn concerned(report: &Report) -> String {
    counted(report.concerned(), "file")
}

fn counted(number: usize, word: &str) -> String {
    format!("{number} {word}{}", if number == 1 { "" } else { "s" })
}

/// Colours and drawing as the terminal has them.
fn handler() -> GraphicalReportHandler {
    let terminal = io::IsTerminal::is_terminal(&io::stdout());
    let colours = terminal && std::env::var_os("NO_COLOR").is_none();
    let theme = if colours { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    GraphicalReportHandler::new_themed(theme).with_links(false).with_width(100)
}

fn write_finding(finding: &Finding, handler: &GraphicalReportHandler, out: &mut dyn Write) -> io::Result<()> {
    let mut text = String::new();
    let drawn = is_drawable(finding) && handler.render_report(&mut text, finding as &dyn Diagnostic).is_ok();
    if !drawn {
        text.clear();
        finding.write_line(&mut text).map_err(io::Error::other)?;
        text.push('\n');
    }
    writeln!(out, "{text}")
}

/// False for places in lines that are too long to be looked at, and in files without text.
fn is_drawable(finding: &Finding) -> bool {
    let text = finding.text();
    let Some((before, after)) = text.split_at_checked(finding.diagnostic().span.start as usize) else {
        return false;
    };
    let line = before.len() - before.rfind('\n').map_or(0, |at| at + 1) + after.find('\n').unwrap_or(after.len());
    !text.is_empty() && line <= LINE_MAX
}
