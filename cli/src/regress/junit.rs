//! The report format of `JUnit`, as CI servers read it: a suite for each scenario, a case for each test.
//!
//! `time` of a case is virtual time, so that equal runs give equal reports; only the root says how
//! long it all took.

use std::fmt::Write as _;

use super::outcome::{Outcome, Report, Status};
use super::summary::details;
use crate::regress::page::markup::escaped;

/// The report as XML.
pub fn text(report: &Report) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(report, &mut text);
    text
}

fn write(report: &Report, text: &mut String) -> std::fmt::Result {
    let all: Vec<&Outcome> = report.outcomes.iter().collect();
    writeln!(text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    let wall = report.wall_time.as_secs_f64();
    writeln!(text, "<testsuites name=\"onescan\" {} time=\"{wall:.3}\">", counts(&all))?;
    for suite in report.suites() {
        let tests: Vec<&Outcome> = report.outcomes.iter().filter(|outcome| outcome.suite == suite).collect();
        let time = tests.iter().map(|test| test.virtual_time_ns).sum::<u64>() as f64 / 1e9;
        writeln!(
            text,
            "  <testsuite name=\"{}\" {} skipped=\"0\" time=\"{time:.3}\">",
            escaped(suite),
            counts(&tests)
        )?;
        for test in tests {
            case(test, text)?;
        }
        writeln!(text, "  </testsuite>")?;
    }
    writeln!(text, "</testsuites>")
}

fn is_error(status: Status) -> bool {
    matches!(status, Status::Fault | Status::Wrong)
}

fn counts(tests: &[&Outcome]) -> String {
    let errors = tests.iter().filter(|test| is_error(test.status)).count();
    let failures = tests.iter().filter(|test| test.status.is_bad()).count() - errors;
    format!("tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\"", tests.len())
}

fn case(test: &Outcome, text: &mut String) -> std::fmt::Result {
    let name = if test.name.is_empty() { "(all)" } else { &test.name };
    let (name, class) = (escaped(name), escaped(&test.suite));
    let time = test.virtual_time_ns as f64 / 1e9;
    write!(text, "    <testcase name=\"{name}\" classname=\"{class}\" time=\"{time:.3}\"")?;
    if let Some(place) = test.asserts.first().map(|failed| &failed.place).or(test.place.as_ref()) {
        write!(text, " file=\"{}\" line=\"{}\"", escaped(&place.file), place.line)?;
    }
    if !test.status.is_bad() {
        return writeln!(text, "/>");
    }
    let lines = details(test);
    let first = lines.first().map_or_else(|| test.status.word().to_owned(), Clone::clone);
    let kind = if is_error(test.status) { "error" } else { "failure" };
    let (first, all, ty) = (escaped(&first), escaped(&lines.join("\n")), test.status.word());
    writeln!(text, ">\n      <{kind} message=\"{first}\" type=\"{ty}\">{all}</{kind}>\n    </testcase>")
}
