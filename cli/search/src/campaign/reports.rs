//! Campaigns as a page, and in the format of `JUnit`.

use std::time::Duration;

use onescan_report::junit::{Case, Ended, Suite, Tests, Trouble};
use onescan_report::page::{Mood, Page, Section};
use onescan_report::table;
use onescan_scenario::case::campaign::CampaignFault;
use onescan_server::time::VirtualTime;

use super::summary::{cell, matrix, programs, repeat, totals};
use super::table::{Row, Table};

/// So many signals of an effect are named.
const EFFECTS_NAMED: usize = 12;

/// The page: the matrix of each campaign, and a section for each run.
pub(super) fn page(tables: &[Table]) -> Page {
    let of_table = |table: &Table| {
        let runs = table.by_fault().flat_map(|(fault, rows)| rows.iter().map(move |row| run(table, fault, row)));
        std::iter::once(overview(table)).chain(runs).collect::<Vec<_>>()
    };
    Page {
        title: "onescan campaign".to_owned(),
        totals: tables.iter().map(totals).collect::<Vec<_>>().join("; "),
        wall: format!("{:.1} s of virtual time", virtual_time(tables).as_secs_f64()),
        sections: tables.iter().flat_map(of_table).collect(),
        ..Page::default()
    }
}

/// Virtual time of all runs: what the machine took is not a part of a report, which is the same wherever it is made.
fn virtual_time(tables: &[Table]) -> Duration {
    Duration::from_nanos(tables.iter().flat_map(|table| &table.rows).map(|row| row.virtual_time_ns).sum())
}

fn overview(table: &Table) -> Section {
    let passed = table.is_passed();
    let mut rows = matrix(table);
    let head = rows.remove(0).split_off(1).into_iter().map(Into::into).collect();
    let mut programs = programs(table);
    let programs_head = programs.remove(0).split_off(1).into_iter().map(Into::into).collect();
    let beside = (!programs.is_empty()).then(|| table::Table {
        title: "program",
        head: programs_head,
        rows: programs,
        ..table::Table::default()
    });
    let faults = table::Table { title: "fault", head, rows, ..table::Table::default() };
    Section {
        title: format!("{}: {}", table.scenario, table.campaign),
        status: if passed { "passed" } else { "not passed" }.to_owned(),
        mood: if passed { Mood::Good } else { Mood::Bad },
        virtual_time: VirtualTime::from_nanos(table.healthy.iter().map(|one| one.virtual_time_ns).sum()).to_string(),
        lines: table.about.iter().cloned().collect(),
        tables: std::iter::once(faults).chain(beside).collect(),
        ..Section::default()
    }
}

fn run(table: &Table, fault: &CampaignFault, row: &Row) -> Section {
    let time = |ns: u64| VirtualTime::from_nanos(ns).to_string();
    let yes = |flag: bool| if flag { "yes" } else { "no" }.to_owned();
    let facts = [
        ("kind", Some(fault.kind.word().to_owned())),
        ("activated at", row.activated_ns.map(time)),
        ("detected after", row.detected_after_ns.map(time)),
        ("safe", row.safe.map(yes)),
        ("collision", row.collision.map(yes)),
        ("effect on", (!row.effects.is_empty()).then(|| effects(row))),
        ("at the end in the state of the run without faults", row.rejoined.map(yes)),
        ("in that state from", row.joined_ns.map(time)),
        ("alarms", (!row.alarms.is_empty()).then(|| alarms(row))),
        ("digest", row.digest.clone()),
        ("again", Some(repeat(table, row))),
    ];
    Section {
        title: row.case.clone(),
        status: cell(row),
        mood: if table.is_accepted(row) { Mood::Good } else { Mood::Bad },
        virtual_time: time(row.virtual_time_ns),
        facts: facts.into_iter().filter_map(|(name, value)| Some((name, value?))).collect(),
        lines: fault.about.iter().cloned().chain(failures(row)).collect(),
        ..Section::default()
    }
}

/// What ended its run before its time.
fn failures(row: &Row) -> impl Iterator<Item = String> {
    row.failure.iter().map(|failure| failure.text.clone()).chain(row.unfinished.iter().cloned())
}

fn alarms(row: &Row) -> String {
    row.alarms.iter().map(|(name, count)| format!("{name} ({count})")).collect::<Vec<_>>().join(", ")
}

fn effects(row: &Row) -> String {
    let named = row.effects.iter().take(EFFECTS_NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
    match row.effects.len().checked_sub(EFFECTS_NAMED) {
        Some(more @ 1..) => format!("{named} and {more} more"),
        _ => named,
    }
}

/// The report for CI servers: one suite per campaign, one case per run.
pub(super) fn junit(tables: &[Table]) -> String {
    let case = |table: &Table, row: &Row| Case {
        class: None,
        name: row.case.clone(),
        virtual_time_ns: row.virtual_time_ns,
        wall_time: None,
        place: row.failure.as_ref().and_then(|failure| failure.place.as_ref()).map(|at| (at.file.clone(), at.line)),
        ended: if table.is_accepted(row) {
            Ended::Well
        } else {
            Ended::Failure(Trouble {
                word: row.verdict.word(),
                lines: std::iter::once(row.verdict.word().to_owned())
                    .chain(failures(row))
                    .chain([repeat(table, row)])
                    .collect(),
            })
        },
    };
    let suite = |table: &Table| Suite {
        name: format!("{}/{}", table.scenario, table.campaign),
        cases: table.rows.iter().map(|row| case(table, row)).collect(),
    };
    Tests { suites: tables.iter().map(suite).collect(), wall_time: virtual_time(tables) }.to_xml()
}
