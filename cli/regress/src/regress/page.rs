//! The page about all tests.

use onescan_iec_run::Coverage;
use onescan_report::page::{Mood, Page, Picture, Section};
use onescan_server::signal::SignalType;
use onescan_server::time::VirtualTime;

use super::outcome::{Outcome, Report, Status};
use super::ran::Shown;
use super::summary::{causes, details, totals};
use crate::snapshot::Snapshot;
use crate::snapshot::value::show;
use onescan_runner::run::page::{Event, covered, statistics, timeline};
use onescan_runner::web::charts;

/// The page of a test run.
pub fn of_tests(report: &Report, coverage: &Coverage) -> Page {
    Page {
        title: "onescan test".to_owned(),
        totals: totals(report),
        summary: causes(report),
        wall: format!("{:.1} s", report.wall_time.as_secs_f64()),
        sections: report.outcomes.iter().map(section).collect(),
        coverage: covered(coverage),
        charts: charts(),
        ..Page::default()
    }
}

fn section(outcome: &Outcome) -> Section {
    let Outcome { status, steps, step_ns, virtual_time_ns, digest, expectations, .. } = outcome;
    let mut facts = statistics(*steps, *step_ns, *virtual_time_ns, digest.as_ref());
    if let Some(made) = outcome.asserts_made {
        facts.push(("asserts", made.to_string()));
    }
    if !outcome.tags.is_empty() {
        facts.push(("tags", outcome.tags.join(", ")));
    }
    let mut events = outcome.shown.events.clone();
    events.extend(outcome.shown.snapshot.iter().flat_map(edges));
    let violations = expectations.iter().filter(|shown| shown.is_violated());
    let violations = violations.filter_map(|violated| Some((violated.at_ns?, violated.name.as_str())));
    Section {
        title: format!("{}: {}", outcome.suite, outcome.name),
        status: status.word().to_owned(),
        mood: if status.is_bad() || *status == Status::New { Mood::Bad } else { Mood::Good },
        steps: Some(*steps),
        virtual_time: VirtualTime::from_nanos(*virtual_time_ns).to_string(),
        facts,
        lines: details(outcome),
        expectations: expectations.iter().map(shown).collect(),
        tables: Vec::new(),
        events: timeline(events, violations),
        pictures: pictures(outcome),
    }
}

/// The new trajectory over the reviewed one where the two differ, and the whole of it.
fn pictures(outcome: &Outcome) -> Vec<Picture> {
    let against = outcome.shown.against.iter().map(|svg| Picture::still("reviewed and new", svg.clone()));
    let whole = outcome
        .shown
        .svg
        .iter()
        .map(|svg| Picture { chart: outcome.shown.chart.clone(), ..Picture::still("trajectories", svg.clone()) });
    against.chain(whole).collect()
}

fn shown(Shown { name, verdict, at_ns, values, margin, margin_unit }: &Shown) -> onescan_report::page::Shown {
    onescan_report::page::Shown {
        name: name.clone(),
        verdict: *verdict,
        at: at_ns.map(|at| VirtualTime::from_nanos(at).to_string()).unwrap_or_default(),
        values: values.clone(),
        margin: *margin,
        unit: margin_unit.clone(),
    }
}

/// The changes of all BOOLs.
fn edges(snapshot: &Snapshot) -> impl Iterator<Item = Event> {
    let bools = snapshot.signals.iter().filter(|track| track.ty == SignalType::BOOL);
    bools.flat_map(|track| {
        track.changes.iter().skip(1).map(|(since, bytes)| Event {
            at_ns: since.as_nanos(),
            text: format!("{} becomes {}", track.name, show(track.ty, bytes)),
        })
    })
}
