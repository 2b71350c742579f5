//! Findings for people: each with its place in the text, the errors last, a summary at the end.

use std::collections::BTreeMap;
use std::io::{self, Write};

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use onescan_iec::diagnostic::counted;
use onescan_iec::{Finding, Severity};
use onescan_report::colour;

use super::report::Report;

/// So many findings are shown; who has more begins with these.
const SHOWN: usize = 100;

/// So many of them may be of one file: one that is quite wrong does not hide the others.
const SHOWN_OF_FILE: usize = 25;

/// A longer line is not shown as a whole.
const LINE_MAX: usize = 400;

/// Writes the report. Errors are written last: that is what a terminal shows.
///
/// # Errors
/// Those of `out`.
pub fn write(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    let handler = handler();
    let of = |severity| report.iter().filter(move |finding| finding.diagnostic().severity == severity);
    let errors = Shown::new(of(Severity::Error), SHOWN);
    let warnings = Shown::new(of(Severity::Warning), SHOWN - errors.findings.len());
    warnings.write("warning", &handler, out)?;
    errors.write("error", &handler, out)?;
    let (errors, warnings) = (report.count(Severity::Error), report.count(Severity::Warning));
    let files = counted(report.files, "file");
    let summary = match (errors, warnings) {
        (0, 0) => format!("{files}, no findings"),
        (errors, 0) => format!("{} in {}", counted(errors, "error"), concerned(report)),
        (0, warnings) => format!("{} in {}", counted(warnings, "warning"), concerned(report)),
        (errors, warnings) => {
            let (errors, warnings) = (counted(errors, "error"), counted(warnings, "warning"));
            format!("{errors}, {warnings} in {}", concerned(report))
        }
    };
    if report.passed_over.is_empty() {
        writeln!(out, "{summary}")
    } else {
        writeln!(out, "{summary}; {}", report.passed_over)
    }
}

/// What is shown of findings, and how many are not.
struct Shown<'a> {
    findings: Vec<&'a Finding>,
    /// By file, those beyond what is shown of one.
    more_of_file: BTreeMap<&'a str, usize>,
    more: usize,
}

impl<'a> Shown<'a> {
    fn new(findings: impl Iterator<Item = &'a Finding>, limit: usize) -> Self {
        let mut shown = Self { findings: Vec::new(), more_of_file: BTreeMap::new(), more: 0 };
        let mut of_file: BTreeMap<&str, usize> = BTreeMap::new();
        for finding in findings {
            let count = of_file.entry(finding.file()).or_default();
            *count += 1;
            if shown.findings.len() == limit {
                shown.more += 1;
            } else if *count > SHOWN_OF_FILE {
                *shown.more_of_file.entry(finding.file()).or_default() += 1;
            } else {
                shown.findings.push(finding);
            }
        }
        shown
    }

    fn write(&self, word: &str, handler: &GraphicalReportHandler, out: &mut dyn Write) -> io::Result<()> {
        for (index, finding) in self.findings.iter().enumerate() {
            write_finding(finding, handler, out)?;
            let is_last = self.findings.get(index + 1).is_none_or(|next| next.file() != finding.file());
            if let Some(more) = self.more_of_file.get(finding.file()).filter(|_| is_last) {
                writeln!(out, "... and {} in {}\n", more_of(*more, word), finding.file())?;
            }
        }
        match self.more {
            0 => Ok(()),
            more => writeln!(out, "... and {}\n", more_of(more, word)),
        }
    }
}

/// `3 more errors`
fn more_of(number: usize, word: &str) -> String {
    counted(number, &format!("more {word}"))
}

fn concerned(report: &Report) -> String {
    counted(report.concerned(), "file")
}

/// Colours and drawing as the terminal has them.
fn handler() -> GraphicalReportHandler {
    let theme =
        if colour::suits(&io::stdout()) { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
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
