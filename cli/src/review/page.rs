//! All pending snapshots as one self-contained page.

use onescan_report::page::{Mood, Page, Section};
use onescan_report::plot::{Mark, Panel, Plot, Shape, Trajectory};
use onescan_server::signal::SignalType;

use super::{Waiting, chart, view};
use crate::snapshot::{Difference, Track};

/// The page.
pub fn of(waiting: &[Waiting]) -> String {
    let sections: Vec<Section> = waiting
        .iter()
        .map(|one| {
            let lines = one.differences.iter().map(ToString::to_string).collect();
            Section {
                title: one.name(),
                status: one.status().to_owned(),
                mood: Mood::Bad,
                lines,
                svg: Some(plot(one).to_svg()),
                ..Section::default()
            }
        })
        .collect();
    let (title, totals) = ("onescan review".to_owned(), format!("{} waiting", waiting.len()));
    Page { title, totals, sections, ..Page::default() }.to_html()
}

/// Old over new, and beneath each signal that differs by how much it does.
fn plot(waiting: &Waiting) -> Plot {
    let names = view::differing(waiting);
    let old = waiting.old.as_ref();
    let mut panels = Vec::new();
    for name in &names {
        let of = |tracks: &[Track]| tracks.iter().find(|track| track.name == *name).cloned();
        let (was, is) = (old.and_then(|old| of(&old.signals)), of(&waiting.new.signals));
        let Some(any) = is.as_ref().or(was.as_ref()) else { continue };
        let runs = |tracks: &[Option<Track>]| -> Vec<Trajectory> {
            tracks
                .iter()
                .map(|track| track.as_ref().map(|track| trajectory(waiting, track)).unwrap_or_default())
                .collect()
        };
        let (signal, unit, shape) = (any.name.clone(), any.unit.clone(), shape(any));
        let both = if old.is_some() { runs(&[was.clone(), is.clone()]) } else { runs(std::slice::from_ref(&is)) };
        panels.push(Panel { signal: signal.clone(), unit: unit.clone(), shape, runs: both });
        if let (Some(was), Some(is), false) = (&was, &is, any.ty == SignalType::BOOL) {
            let difference = chart::difference(was, is);
            let signal = format!("{signal}, new less old");
            panels.push(Panel { signal, unit, shape: Shape::Step, runs: vec![trajectory(waiting, &difference)] });
        }
    }
    let runs = if old.is_some() { vec!["reviewed".to_owned(), "new".to_owned()] } else { vec!["new".to_owned()] };
    Plot { title: waiting.name(), runs, panels, marks: marks(waiting) }
}

/// The first instant at which something differs.
fn marks(waiting: &Waiting) -> Vec<Mark> {
    let values = |difference: &&Difference| matches!(difference, Difference::Values { .. });
    let first = waiting.differences.iter().filter(values).map(Difference::at_ns).min();
    first.map(|t_ns| Mark { t_ns, label: "first difference".to_owned() }).into_iter().collect()
}

/// Samples are joined by lines, as they are in plots of runs; everything else jumps.
fn shape(track: &Track) -> Shape {
    if track.sampled.is_some() { Shape::Line } else { Shape::Step }
}

fn trajectory(waiting: &Waiting, track: &Track) -> Trajectory {
    let number = |bytes: &[u8]| track.ty.as_f64(bytes).unwrap_or(f64::NAN);
    let mut drawn = Trajectory::default();
    // A line that rests for a while does not slope towards its next sample.
    let every = track.sampled.map(|sampled| sampled.every);
    for (since, bytes) in &track.changes {
        if let (Some(every), Some(last), Some(value)) =
            (every, drawn.t_ns.last().copied(), drawn.values.last().copied())
        {
            let before = since.saturating_sub(every).as_nanos();
            if before > last {
                drawn.t_ns.push(before);
                drawn.values.push(value);
            }
        }
        drawn.t_ns.push(since.as_nanos());
        drawn.values.push(number(bytes));
    }
    if let Some(value) = drawn.values.last().copied() {
        drawn.t_ns.push(waiting.new.end.as_nanos());
        drawn.values.push(value);
    }
    drawn
}
