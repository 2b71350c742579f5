//! What was found, or that nothing was.

use std::io::{self, Write};

use onescan_report::number::counted;
use onescan_scenario::Scenario;
use onescan_scenario::case::written::spelt;
use onescan_server::time::VirtualTime;
use serde_json::json;

use super::config::ExploreConfig;
use super::search::{Finding, Found};
use crate::format::Format;

/// Writes what came of an exploration.
pub(super) fn write(config: &ExploreConfig, scenario: &Scenario, found: &Found, out: &mut dyn Write) -> io::Result<()> {
    match config.format {
        Format::Human => human(config, scenario, found, out)?,
        Format::Json => {
            for (number, finding) in found.findings.iter().enumerate() {
                writeln!(
                    out,
                    "{}",
                    json!({ "deviations": finding.deviations, "violated": finding.violated, "failure": finding.failure,
                        "digest": finding.digest, "case": case(number + 1, finding, found.until) })
                )?;
            }
            let statement = json!({ "scenario": scenario.name(), "holds": found.findings.is_empty(),
                "schedules": found.schedules, "runs": found.runs, "edges": found.edges, "bound": config.bound,
                "exhausted": found.exhausted, "version": env!("CARGO_PKG_VERSION") });
            writeln!(out, "{statement}")?;
        }
    }
    out.flush()
}

fn human(config: &ExploreConfig, scenario: &Scenario, found: &Found, out: &mut dyn Write) -> io::Result<()> {
    for (number, finding) in found.findings.iter().enumerate() {
        let what: Vec<String> =
            finding.violated.iter().map(|one| format!("`{}`", one.name)).chain(finding.failure.clone()).collect();
        writeln!(out, "{}: {} does not hold if", scenario.name(), what.join(", "))?;
        if finding.deviations.is_empty() {
            writeln!(out, "  nothing is late: the run without deviations is wrong already")?;
            continue;
        }
        for deviation in &finding.deviations {
            writeln!(out, "  {deviation}")?;
        }
        for line in case(number + 1, finding, found.until).lines() {
            writeln!(out, "    {line}")?;
        }
    }
    writeln!(out, "{}: {}", scenario.name(), statement(config, scenario, found))
}

/// What is known now: no more than was tried.
fn statement(config: &ExploreConfig, scenario: &Scenario, found: &Found) -> String {
    let latest = scenario.late().iter().map(|late| late.steps).max().unwrap_or(0);
    let late = if latest == 1 { "1 step".to_owned() } else { format!("1 to {latest} steps") };
    let edges = counted(found.edges as u64, "edge");
    let schedules = counted(found.schedules, "schedule");
    match (found.findings.len(), found.exhausted) {
        (0, Some(bound)) if bound == config.bound => {
            format!("all {schedules} with at most {bound} of {edges} late by {late} hold")
        }
        (0, exhausted) => {
            let known = exhausted.map_or_else(
                || "nothing is exhausted".to_owned(),
                |bound| format!("only those with at most {bound} late of {edges} are exhausted"),
            );
            format!(
                "{schedules} hold; {known}, because {} were done, which is the limit (see `--runs`)",
                counted(found.runs, "run")
            )
        }
        (findings, _) if config.all => {
            let wrong = if findings == 1 { "does not" } else { "do not" };
            format!("{findings} of {schedules} {wrong} hold, with at most {} of {edges} late by {late}", config.bound)
        }
        _ => format!("found in {schedules}"),
    }
}

/// All findings as a file of cases.
pub(super) fn cases(found: &Found) -> String {
    let mut text = "version = 1\n".to_owned();
    for (number, finding) in found.findings.iter().enumerate() {
        text.push('\n');
        text.push_str(&case(number + 1, finding, found.until));
    }
    text
}

/// A finding as a case that runs by itself.
fn case(number: usize, finding: &Finding, until: VirtualTime) -> String {
    let about: Vec<String> = finding.deviations.iter().map(ToString::to_string).collect();
    let about = about.join("; ");
    let head = format!("[[case]]\nname = \"timing-{number}\"\nabout = \"{about}\"\nuntil = \"{}\"\n", spelt(until));
    if finding.deviations.is_empty() {
        return head;
    }
    let forces: Vec<String> = finding.deviations.iter().map(|one| format!("    {},\n", one.as_toml())).collect();
    format!("{head}force = [\n{}]\n", forces.concat())
}
