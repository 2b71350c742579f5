//! The report as GitHub shows it: marks at lines of a pull request, and a table on the page of the job.

use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::Path;

use onescan_report::FileError;
use onescan_server::client::SourcePlace;

use super::outcome::{Outcome, Report};
use super::summary::{causes, details, next, slowest, totals};

/// GitHub cuts the page of a job at 1 MiB: so many failures are shown in full.
const IN_FULL: usize = 50;

/// A workflow command for each failed assert, fault or statement that parts, at its line where it has one.
pub fn annotations(report: &Report) -> String {
    let mut text = String::new();
    for outcome in report.outcomes.iter().filter(|outcome| outcome.status.is_bad()) {
        let title = outcome.full_name();
        for (place, message) in marks(outcome) {
            let place =
                place.map(|place| format!("file={},line={},col={},", property(&place.file), place.line, place.column));
            let place = place.unwrap_or_default();
            writeln!(text, "::error {place}title={}::{}", property(&title), data(&message))
                .expect("a string takes all");
        }
    }
    text
}

/// What went wrong in a test, each with where; at least one.
fn marks(outcome: &Outcome) -> Vec<(Option<&SourcePlace>, String)> {
    let mut marks: Vec<(Option<&SourcePlace>, String)> = Vec::new();
    if let Some(error) = &outcome.error {
        marks.push((outcome.place.as_ref(), error.clone()));
    }
    marks.extend(outcome.asserts.iter().map(|failed| (Some(&failed.place), failed.text.clone())));
    // A cause of several tests is marked once.
    if let Some(cause) = outcome.cause.as_ref().filter(|_| outcome.cause_as_of.is_none()) {
        marks.push((cause.place.as_ref(), cause.lines.join("\n")));
    }
    if marks.is_empty() {
        let lines = details(outcome);
        marks.push((None, if lines.is_empty() { outcome.status.word().to_owned() } else { lines.join("\n") }));
    }
    marks
}

/// Text of a workflow command, which is one line.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// The same, before the `::`.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

/// The table for the page of the job, in Markdown.
pub fn markdown(report: &Report) -> String {
    let mut text = format!("### onescan: {}\n\n", totals(report));
    let bad: Vec<&Outcome> = report.outcomes.iter().filter(|outcome| outcome.status.is_bad()).collect();
    for line in causes(report) {
        writeln!(text, "- {}", html(&line)).expect("a string takes all");
    }
    if !bad.is_empty() {
        text.push_str("\n| | test | what is wrong |\n|---|---|---|\n");
    }
    for outcome in &bad {
        let first = details(outcome).into_iter().next().unwrap_or_default();
        writeln!(text, "| {} | {} | {} |", outcome.status.word(), cell(&outcome.full_name()), cell(&first))
            .expect("a string takes all");
    }
    for outcome in bad.iter().take(IN_FULL) {
        let lines = details(outcome).join("\n").replace("```", "'''");
        write!(
            text,
            "\n<details><summary>{}</summary>\n\n```text\n{lines}\n```\n\n</details>\n",
            html(&outcome.full_name())
        )
        .expect("a string takes all");
    }
    if let Some(more @ 1..) = bad.len().checked_sub(IN_FULL) {
        writeln!(text, "\n{more} more in the log of the job.").expect("a string takes all");
    }
    for line in next(report).into_iter().chain(slowest(report)) {
        writeln!(text, "\n{}", html(&line)).expect("a string takes all");
    }
    text
}

fn html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A cell of a table: one line, and no mark of Markdown.
fn cell(text: &str) -> String {
    let line = html(text.lines().next().unwrap_or_default());
    line.chars().fold(String::new(), |mut text, letter| {
        if "|\\`*_[]".contains(letter) {
            text.push('\\');
        }
        text.push(letter);
        text
    })
}

/// Adds the table to the file that GitHub names; other steps of a job write there, too.
///
/// # Errors
/// It cannot be written.
pub fn append(path: &Path, report: &Report) -> Result<(), FileError> {
    let file = OpenOptions::new().append(true).create(true).open(path);
    file.and_then(|mut file| file.write_all(markdown(report).as_bytes()))
        .map_err(|source| FileError { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_outside_stays_text() {
        assert_eq!(data("100%\nof\r:"), "100%25%0Aof%0D:");
        assert_eq!(property("a,b:c"), "a%2Cb%3Ac");
        assert_eq!(cell("a|b_<c>\nd"), "a\\|b\\_&lt;c&gt;");
    }
}
