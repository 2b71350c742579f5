//! The page about the runs of one scenario, and what pages of tests have in common with it.

use std::collections::BTreeMap;

use onescan_iec_run::Coverage;
use onescan_iec_run::coverage::{Counted, Row};
use onescan_report::page::{self, CoveredFile, Mood, Page, Picture, Section, Shown};
use onescan_report::plot::Plot;
use onescan_server::time::{TimeSpan, VirtualTime};
use serde::{Deserialize, Serialize};

use super::coverage::share;
use super::expectation::{ExpectationReport, SignalValue};
use super::production::{pictures, tables};
use super::report::{RunReport, RunStatus};
use crate::web::charts;

/// Something that happened to a run from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    pub at_ns: u64,
    pub text: String,
}

/// What is drawn of the runs of one scenario.
pub(super) struct Drawings<'p> {
    /// All runs in one picture.
    pub(super) plot: &'p Plot,
    /// The machines of its plants, as SVG.
    pub(super) scenes: Vec<String>,
    /// Maps as they are at the end of the last run, as SVG.
    pub(super) maps: Vec<String>,
}

/// The page of the runs of one scenario, with what happened to each from outside.
pub(super) fn of_runs(
    reports: &[RunReport],
    events: &[Event],
    Drawings { plot, scenes, maps }: Drawings<'_>,
    coverage: &Coverage,
) -> Page {
    // All runs are in one picture, which stands with the first.
    let scenes = scenes.into_iter().map(|svg| Picture::still("the machine", svg));
    let mut shared: Vec<Picture> = scenes.collect();
    shared.push(Picture::of_plot("trajectories", plot));
    let wall: f64 = reports.iter().map(|report| report.wall_time_s).sum();
    let of_run = |index: usize| {
        let mut own = if index == 0 { shared.clone() } else { Vec::new() };
        if index + 1 == reports.len() {
            own.extend(maps.iter().map(|svg| Picture::still("map at the end", svg.clone())));
        }
        own
    };
    let sections = reports.iter().enumerate().map(|(index, report)| section(report, events.to_vec(), of_run(index)));
    Page {
        title: reports.first().map_or_else(String::new, |report| report.scenario.clone()),
        totals: format!("{} run{}", reports.len(), if reports.len() == 1 { "" } else { "s" }),
        wall: format!("{wall:.1} s"),
        sections: sections.collect(),
        coverage: covered(coverage),
        charts: charts(),
        ..Page::default()
    }
}

fn section(report: &RunReport, events: Vec<Event>, mut drawn: Vec<Picture>) -> Section {
    let is_bad = report.status == RunStatus::Failed || report.is_unmet();
    let digest = report.digest.map(|digest| digest.to_string());
    drawn.extend(report.report.iter().flat_map(pictures::of));
    let violations = report.expectations.iter().filter(|expectation| expectation.is_violated());
    let violations = violations.filter_map(|violated| Some((violated.at?.as_nanos(), violated.name.as_str())));
    Section {
        title: format!("run {}", report.run),
        status: status(report),
        mood: if is_bad { Mood::Bad } else { Mood::Good },
        steps: Some(report.steps.0),
        virtual_time: report.virtual_time.to_string(),
        facts: statistics(report.steps.0, report.step.as_nanos(), report.virtual_time.as_nanos(), digest.as_ref()),
        lines: report.error.iter().cloned().collect(),
        expectations: report.expectations.iter().map(shown).collect(),
        tables: report.report.iter().flat_map(tables::for_pages).collect(),
        events: timeline(events, violations),
        pictures: drawn,
    }
}

/// How a run ended, and whether it showed what it had to.
fn status(report: &RunReport) -> String {
    let word = report.status.word();
    match report.expectations.iter().filter(|expectation| expectation.is_violated()).count() {
        0 => word.to_owned(),
        1 => format!("{word}, an expectation is violated"),
        violated => format!("{word}, {violated} expectations are violated"),
    }
}

fn shown(expectation: &ExpectationReport) -> Shown {
    let ExpectationReport { name, verdict, at, values, margin, margin_unit } = expectation;
    Shown {
        name: name.clone(),
        verdict: *verdict,
        at: at.map(|at| at.to_string()).unwrap_or_default(),
        values: values.iter().map(|SignalValue { signal, value }| (signal.clone(), *value)).collect(),
        margin: *margin,
        unit: margin_unit.clone(),
    }
}

/// Step statistics: how many, how long, and the digest over all of them.
pub fn statistics(steps: u64, step_ns: u64, end_ns: u64, digest: Option<&String>) -> Vec<(&'static str, String)> {
    let step = TimeSpan::from_nanos(step_ns).map(|step| step.to_string()).unwrap_or_default();
    let mut facts = vec![
        ("steps", steps.to_string()),
        ("step", step),
        ("virtual time", VirtualTime::from_nanos(end_ns).to_string()),
    ];
    facts.extend(digest.map(|digest| ("digest", digest.clone())));
    facts
}

/// All that happened, violations of expectations among it, in the order of time.
pub fn timeline<'n>(mut events: Vec<Event>, violations: impl Iterator<Item = (u64, &'n str)>) -> Vec<page::Event> {
    events.extend(violations.map(|(at_ns, name)| Event { at_ns, text: format!("expectation `{name}` violated") }));
    events.sort_by(|a, b| (a.at_ns, &a.text).cmp(&(b.at_ns, &b.text)));
    let shown = |Event { at_ns, text }| page::Event { at: VirtualTime::from_nanos(at_ns).to_string(), what: text };
    events.into_iter().map(shown).collect()
}

/// Coverage by file, in the order of their names.
pub fn covered(coverage: &Coverage) -> Vec<CoveredFile> {
    /// All of something, and how much of it was executed.
    type Part = (usize, usize);
    let mut files: BTreeMap<String, (Part, Part, Vec<u32>)> = BTreeMap::new();
    for Row { file, line, of, count } in coverage.rows() {
        let (lines, branches, missed) = files.entry(file).or_default();
        let part = match of {
            Counted::Unit(_) => continue,
            Counted::Line => {
                if count == 0 {
                    missed.push(line);
                }
                lines
            }
            Counted::Outcome { .. } => branches,
        };
        *part = (part.0 + 1, part.1 + usize::from(count > 0));
    }
    let row = |(file, (lines, branches, missed))| CoveredFile {
        file,
        lines: share(lines),
        branches: share(branches),
        missed,
    };
    files.into_iter().map(row).collect()
}
