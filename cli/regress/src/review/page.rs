//! All pending snapshots as one self-contained page.

use onescan_report::page::{Mood, Page, Picture, Section};

use super::Waiting;
use crate::snapshot::overlay::overlay;
use onescan_runner::web::charts;

/// The page.
pub fn of(waiting: &[Waiting]) -> String {
    let sections = waiting.iter().map(section).collect();
    let (title, totals) = ("onescan review".to_owned(), format!("{} waiting", waiting.len()));
    Page { title, totals, sections, charts: charts(), ..Page::default() }.to_html()
}

fn section(waiting: &Waiting) -> Section {
    let Waiting { old, new, note, differences, .. } = waiting;
    let plot = overlay(&waiting.name(), old.as_ref(), new, differences);
    let title = if old.is_some() { "reviewed and new" } else { "trajectories" };
    Section {
        title: waiting.name(),
        status: waiting.status().to_owned(),
        mood: Mood::Bad,
        steps: Some(new.end.as_nanos() / new.step.as_nanos().max(1)),
        virtual_time: new.end.to_string(),
        lines: note.iter().cloned().chain(differences.iter().map(ToString::to_string)).collect(),
        pictures: vec![Picture::of_plot(title, &plot)],
        ..Section::default()
    }
}
