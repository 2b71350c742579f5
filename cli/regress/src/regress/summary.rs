//! The report for people, and as JSON.

use std::io::{self, Write};
use std::time::Duration;

use onescan_server::time::VirtualTime;
use serde_json::json;

use super::config::{Policy, TestConfig, TestFormat};
use super::outcome::{Cause, Outcome, Report, Status};
use super::plan::shown;
use super::ran::{FailedAssert, Shown};
use onescan_report::colour::Colour;
use onescan_report::number::counted;
use onescan_runner::run::coverage::share;

/// So many differences of one test are shown; who has more begins with these.
const SHOWN: usize = 5;

/// So many tests are named that took longest.
const SLOWEST: usize = 5;

/// Writes the report for people.
///
/// # Errors
/// Those of `out`.
pub fn write_human(config: &TestConfig, report: &Report, out: &mut dyn Write) -> io::Result<()> {
    let width = report.outcomes.iter().map(|outcome| outcome.name.chars().count()).max().unwrap_or(0).min(48);
    for suite in report.suites() {
        writeln!(out, "{suite}")?;
        for outcome in report.outcomes.iter().filter(|outcome| outcome.suite == suite) {
            write_outcome(outcome, width, out)?;
        }
    }
    for orphan in &report.orphans {
        writeln!(out, "{} belongs to no case", shown(orphan))?;
    }
    writeln!(out)?;
    writeln!(out, "{}", totals(report))?;
    causes(report).iter().try_for_each(|line| writeln!(out, "{line}"))?;
    if let Some([lines, branches]) = report.coverage {
        // CI servers look for this line.
        writeln!(out, "lines: {}, branches: {}", share(lines), share(branches))?;
    }
    let pending = report.count(Status::New) + report.count(Status::Changed);
    if config.policy == Policy::Pending && pending > 0 {
        let noun = if pending == 1 { "snapshot waits" } else { "snapshots wait" };
        writeln!(out, "{pending} {noun} for a review: onescan review")?;
    }
    if config.policy == Policy::Check {
        next(report).iter().try_for_each(|line| writeln!(out, "{line}"))?;
    }
    if config.format == TestFormat::Github {
        slowest(report).iter().try_for_each(|line| writeln!(out, "{line}"))?;
    }
    out.flush()
}

/// What to type next where snapshots are missing or differ and none was written.
pub fn next(report: &Report) -> Vec<String> {
    let mut lines = Vec::new();
    if report.count(Status::Changed) > 0 {
        let what = "a change that you meant: type `onescan test` without --check, then `onescan review`, and commit";
        lines.push(what.to_owned());
    }
    if report.count(Status::Missing) > 0 {
        lines.push("a missing snapshot is made by `onescan test`, then `onescan review`".to_owned());
    }
    lines
}

/// How long it all took, and the tests that took longest.
pub fn slowest(report: &Report) -> Vec<String> {
    let mut timed: Vec<(Duration, String)> = Vec::new();
    for outcome in &report.outcomes {
        timed.extend(outcome.wall_time.map(|time| (time, outcome.full_name())));
    }
    timed.sort_by(|one, other| other.cmp(one));
    let mut lines = vec![format!("in {:.1} s", report.wall_time.as_secs_f64())];
    if timed.len() > SLOWEST {
        let named = timed.iter().take(SLOWEST).map(|(time, name)| format!("{name} {:.1} s", time.as_secs_f64()));
        lines.push(format!("slowest: {}", named.collect::<Vec<_>>().join(", ")));
    }
    lines
}

fn write_outcome(outcome: &Outcome, width: usize, out: &mut dyn Write) -> io::Result<()> {
    let Outcome { name, status, steps, virtual_time_ns, step_ns, .. } = outcome;
    let word = if status.is_bad() { status.word().to_uppercase() } else { status.word().to_owned() };
    let word = colour(*status).of(&word);
    if did_not_run(outcome) {
        writeln!(out, "  {word:<8} {name}")?;
        return write_details(outcome, out);
    }
    write!(out, "  {word:<8} {name:<width$}")?;
    if *steps > 0 {
        let unit = if outcome.asserts_made.is_some() { "scan" } else { "step" };
        let plural = if *steps == 1 { "" } else { "s" };
        write!(out, "  {steps} {unit}{plural}, {}", VirtualTime::from_nanos(*virtual_time_ns))?;
    }
    match outcome.asserts_made {
        Some(0) if *step_ns > 0 => write!(out, ", no asserts")?,
        Some(1) => write!(out, ", 1 assert")?,
        Some(made) => write!(out, ", {made} asserts")?,
        None => {}
    }
    writeln!(out)?;
    write_details(outcome, out)
}

/// What a status says at a glance.
fn colour(status: Status) -> Colour {
    match status {
        _ if status.is_bad() => Colour::Bad,
        Status::Passed | Status::Blessed => Colour::Good,
        _ => Colour::Notable,
    }
}

/// True for a test of which there is nothing to count.
fn did_not_run(outcome: &Outcome) -> bool {
    let nothing = outcome.steps == 0 && outcome.asserts_made == Some(0) && outcome.class.is_none();
    nothing || outcome.status == Status::Skipped
}

fn write_details(outcome: &Outcome, out: &mut dyn Write) -> io::Result<()> {
    details(outcome).iter().try_for_each(|line| writeln!(out, "           {line}"))
}

/// What there is to say of a test that did not simply pass, a line each.
pub fn details(outcome: &Outcome) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    if let Some(error) = &outcome.error {
        lines.extend(error.lines().map(str::to_owned));
        if let Some(place) = outcome.place.as_ref().filter(|_| outcome.asserts_made.is_some()) {
            lines.push(format!("at {place}"));
        }
    }
    lines.extend(outcome.asserts.iter().map(assert));
    lines.extend(outcome.notes.iter().cloned());
    lines.extend(outcome.expectations.iter().filter(|shown| shown.is_violated()).map(violation));
    lines.extend(outcome.differences.iter().take(SHOWN).map(ToString::to_string));
    if let Some(more @ 1..) = outcome.differences.len().checked_sub(SHOWN) {
        lines.push(format!("... and {more} more signals"));
    }
    match (&outcome.cause_as_of, &outcome.cause) {
        (Some(first), _) => lines.push(format!("the same cause as {first}")),
        (None, Some(cause)) => lines.extend(cause.lines.iter().cloned()),
        (None, None) => {}
    }
    lines
}

/// Which cause made how many tests another than the reviewed one, where more than one was; a line each.
pub fn causes(report: &Report) -> Vec<String> {
    let traced: Vec<(&Outcome, &Cause)> =
        report.outcomes.iter().filter_map(|outcome| Some((outcome, outcome.cause.as_ref()?))).collect();
    let firsts = traced.iter().filter(|(outcome, _)| outcome.cause_as_of.is_none());
    let mut lines: Vec<String> = firsts
        .map(|(first, cause)| {
            let count = traced.iter().filter(|(_, other)| other.root() == cause.root()).count() as u64;
            let place = cause
                .place
                .as_ref()
                .map_or_else(|| first.full_name(), |place| format!("{}:{}", place.file, place.line));
            format!("{place} is the cause in {}", counted(count, "test"))
        })
        .collect();
    let changed = report.outcomes.iter().filter(|outcome| matches!(outcome.status, Status::Changed | Status::Failed));
    let untraced = changed.filter(|outcome| outcome.cause.is_none()).count() as u64;
    if !lines.is_empty() && untraced > 0 {
        lines.push(format!("{} not traced to a cause: `onescan test -f NAME` traces one", counted(untraced, "test")));
    }
    lines
}

/// An assert that did not hold, in words.
pub fn assert(failed: &FailedAssert) -> String {
    let FailedAssert { text, kind, place, at_ns, times } = failed;
    let often = if *times > 1 { format!(", in {times} scans") } else { String::new() };
    let kind = kind.as_ref().map(|kind| format!("{kind}, ")).unwrap_or_default();
    format!("{place}: {text} ({kind}t_v = {}{often})", VirtualTime::from_nanos(*at_ns))
}

/// A violated expectation, in words.
pub fn violation(shown: &Shown) -> String {
    let at = shown.at_ns.map(|at| format!(" at {}", VirtualTime::from_nanos(at))).unwrap_or_default();
    let values: Vec<String> = shown.values.iter().map(|(signal, value)| format!("{signal} = {value}")).collect();
    let values = if values.is_empty() { String::new() } else { format!(": {}", values.join(", ")) };
    format!("expectation `{}` violated{at}{values}", shown.name)
}

/// How many there were of each sort.
pub fn totals(report: &Report) -> String {
    use Status as S;
    let all = report.outcomes.len();
    let order = [S::Passed, S::New, S::Blessed, S::Missing, S::Changed, S::Failed, S::Fault, S::Wrong, S::Skipped];
    let counts = order.map(|status| (report.count(status), status.word()));
    let parts: Vec<String> =
        counts.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}")).collect();
    format!("{all} test{}: {}", if all == 1 { "" } else { "s" }, parts.join(", "))
}

/// Writes one JSON object a test, then one for all.
///
/// # Errors
/// Those of `out`.
pub fn write_json(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    for outcome in &report.outcomes {
        serde_json::to_writer(&mut *out, outcome)?;
        writeln!(out)?;
    }
    let counts: serde_json::Map<String, serde_json::Value> = [
        Status::Passed,
        Status::New,
        Status::Blessed,
        Status::Missing,
        Status::Changed,
        Status::Failed,
        Status::Fault,
        Status::Wrong,
        Status::Skipped,
    ]
    .iter()
    .map(|status| (status.word().to_owned(), report.count(*status).into()))
    .collect();
    let orphans: Vec<String> = report.orphans.iter().map(|orphan| shown(orphan)).collect();
    let total = json!({ "tests": report.outcomes.len(), "counts": counts, "orphans": orphans,
        "version": env!("CARGO_PKG_VERSION") });
    serde_json::to_writer(&mut *out, &total)?;
    writeln!(out)?;
    out.flush()
}
