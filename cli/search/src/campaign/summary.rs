//! The table for people, and as JSON.

use std::io::{self, Write};

use onescan_report::number::counted;
use onescan_report::table::write;
use onescan_scenario::case::CampaignVerdict;
use onescan_server::time::VirtualTime;
use serde_json::json;

use super::config::Partition;
use super::table::{Program, Row, Table};
use onescan_runner::format::Format;

/// So many cases that are not accepted are named.
const NAMED_MAX: usize = 10;

/// Writes each campaign as a matrix: one row per fault, one column per activation.
///
/// # Errors
/// Those of `out`.
pub fn write_human(tables: &[Table], out: &mut dyn Write) -> io::Result<()> {
    for (index, table) in tables.iter().enumerate() {
        if index > 0 {
            writeln!(out)?;
        }
        writeln!(out, "{}: {}", table.scenario, totals(table))?;
        write(&matrix(table), out)?;
        if !table.programs.is_empty() {
            writeln!(out)?;
            write(&programs(table), out)?;
        }
        let bad: Vec<&Row> = table.rows.iter().filter(|row| !table.is_accepted(row)).collect();
        for row in bad.iter().take(NAMED_MAX) {
            writeln!(out, "  {}: {}", row.verdict.word(), repeat(table, row))?;
        }
        if let Some(more @ 1..) = bad.len().checked_sub(NAMED_MAX) {
            writeln!(out, "  ... and {more} more")?;
        }
    }
    out.flush()
}

/// Says that a part of each of these campaigns is done, so many of its runs.
///
/// # Errors
/// Those of `out`.
pub(super) fn write_part<'a>(
    format: Format,
    part: Partition,
    campaigns: impl Iterator<Item = (&'a str, usize)>,
    out: &mut dyn Write,
) -> io::Result<()> {
    for (campaign, runs) in campaigns {
        match format {
            Format::Json => {
                writeln!(out, "{}", json!({ "campaign": campaign, "part": part.to_string(), "runs": runs }))?;
            }
            Format::Human => {
                writeln!(out, "campaign {campaign}, part {part}: {} done", counted(runs as u64, "run"))?;
                writeln!(out, "  `onescan campaign merge` makes the table of all parts")?;
            }
        }
    }
    out.flush()
}

/// The verdicts, with a head.
pub(super) fn matrix(table: &Table) -> Vec<Vec<String>> {
    let head = ["fault", "kind"].into_iter().chain(table.activations.iter().map(String::as_str));
    let row = |(fault, rows): (&onescan_scenario::case::campaign::CampaignFault, &[Row])| {
        let names = [fault.name.clone(), fault.kind.word().to_owned()];
        names.into_iter().chain(rows.iter().map(cell)).collect()
    };
    std::iter::once(head.map(str::to_owned).collect()).chain(table.by_fault().map(row)).collect()
}

/// What the programs make of the same faults, with a head.
pub(super) fn programs(table: &Table) -> Vec<Vec<String>> {
    let is_described = table.programs.iter().any(|program| program.about.is_some());
    let what = is_described.then_some("what it is");
    let head =
        ["program", "runs", "other verdicts", "first of them"].into_iter().chain(what).map(str::to_owned).collect();
    let row = |program: &Program| {
        let fails = program.failure.as_ref().map(|failure| format!("without any fault: {}", failure.text));
        let first = fails.or_else(|| program.others.first().cloned()).unwrap_or_else(|| "none".to_owned());
        // A program that says nothing about itself leaves its cell empty.
        let about = is_described.then(|| program.about.clone().unwrap_or_default());
        let cells = [program.name.clone(), program.runs.to_string(), program.others.len().to_string(), first];
        cells.into_iter().chain(about).collect()
    };
    std::iter::once(head).chain(table.programs.iter().map(row)).collect()
}

/// A verdict, and how long it took if that is known.
pub(super) fn cell(row: &Row) -> String {
    match (row.verdict, row.detected_after_ns) {
        (CampaignVerdict::Detected, Some(after_ns)) => format!("detected after {}", VirtualTime::from_nanos(after_ns)),
        (verdict, _) => verdict.word().to_owned(),
    }
}

/// How many there were of each sort.
pub(super) fn totals(table: &Table) -> String {
    let by_verdict = CampaignVerdict::ALL.map(|verdict| (table.count(verdict), verdict.word()));
    let parts: Vec<String> =
        by_verdict.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}")).collect();
    let variants = table.variants.max(1);
    let (faults, activations) = (table.faults.len(), table.activations.len() / variants);
    let mut sizes = vec![counted(faults as u64, "fault"), counted(activations as u64, "activation")];
    if variants > 1 {
        sizes.push(counted(variants as u64, "variant"));
    }
    format!("campaign {}, {}: {}", table.campaign, sizes.join(" \u{d7} "), parts.join(", "))
}

/// How to run one of them again.
pub(super) fn repeat(table: &Table, row: &Row) -> String {
    format!("onescan run {} --case {}", table.scenario, row.case)
}

/// Writes a JSON object for each run with a fault, and one for each campaign.
///
/// # Errors
/// Those of `out`.
pub fn write_json(tables: &[Table], out: &mut dyn Write) -> io::Result<()> {
    for table in tables {
        for (fault, rows) in table.by_fault() {
            for (row, activation) in rows.iter().zip(&table.activations) {
                let mut line = json!({ "scenario": table.scenario, "campaign": table.campaign, "fault": fault.name,
                    "kind": fault.kind, "activation": activation });
                if let (Some(line), Ok(serde_json::Value::Object(row))) =
                    (line.as_object_mut(), serde_json::to_value(row))
                {
                    line.extend(row);
                }
                writeln!(out, "{line}")?;
            }
        }
        let counts: serde_json::Map<String, serde_json::Value> = CampaignVerdict::ALL
            .iter()
            .map(|verdict| (verdict.word().replace(' ', "-"), table.count(*verdict).into()))
            .collect();
        let total = json!({ "scenario": table.scenario, "campaign": table.campaign, "runs": table.rows.len(),
            "counts": counts, "passed": table.is_passed(), "healthy_digest": table.healthy.first().and_then(|first| first.digest.as_ref()),
            "healthy_digests": table.healthy.iter().map(|one| &one.digest).collect::<Vec<_>>(),
            "programs": table.programs, "version": env!("CARGO_PKG_VERSION") });
        writeln!(out, "{total}")?;
    }
    out.flush()
}
