//! A new trajectory over the reviewed one, as a picture.

use onescan_report::plot::{Mark, Panel, Plot, Shape, Trajectory};
use onescan_server::signal::SignalType;

use super::{Difference, Snapshot, Track};

/// What was reviewed beneath what is new, and below each signal that differs by how much it does; all signals if
/// nothing was reviewed.
pub fn overlay(title: &str, old: Option<&Snapshot>, new: &Snapshot, differences: &[Difference]) -> Plot {
    let mut panels = Vec::new();
    for name in differing(old, new, differences) {
        let of = |tracks: &[Track]| tracks.iter().find(|track| track.name == name).cloned();
        let (was, is) = (old.and_then(|old| of(&old.signals)), of(&new.signals));
        let Some(any) = is.as_ref().or(was.as_ref()) else { continue };
        // A signal that only one of them has is drawn as a line without samples in the other.
        let run = |track: &Option<Track>| track.as_ref().map(|track| trajectory(new, track)).unwrap_or_default();
        let runs = if old.is_some() { vec![run(&was), run(&is)] } else { vec![run(&is)] };
        panels.push(Panel { signal: name.clone(), unit: any.unit.clone(), shape: shape(any), names: Vec::new(), runs });
        if let (Some(was), Some(is), false) = (&was, &is, any.ty == SignalType::BOOL) {
            panels.push(Panel {
                signal: format!("{name}, new less reviewed"),
                unit: any.unit.clone(),
                shape: Shape::Step,
                names: Vec::new(),
                runs: vec![trajectory(new, &is.less(was))],
            });
        }
    }
    let runs = if old.is_some() { vec!["reviewed".to_owned(), "new".to_owned()] } else { vec!["new".to_owned()] };
    Plot { title: title.to_owned(), runs, panels, marks: marks(differences) }
}

/// The signals that differ, or all that are new.
pub fn differing(old: Option<&Snapshot>, new: &Snapshot, differences: &[Difference]) -> Vec<String> {
    if old.is_none() {
        return new.signals.iter().map(|track| track.name.clone()).collect();
    }
    differences.iter().map(|difference| difference.subject().to_owned()).collect()
}

/// The first instant at which something differs.
fn marks(differences: &[Difference]) -> Vec<Mark> {
    let values = |difference: &&Difference| matches!(difference, Difference::Values { .. });
    let first = differences.iter().filter(values).min_by_key(|difference| difference.at_ns());
    let label = |difference: &Difference| format!("first difference: {}", difference.subject());
    first.map(|first| Mark { t_ns: first.at_ns(), label: label(first) }).into_iter().collect()
}

/// Samples are joined by lines, as they are in plots of runs; everything else jumps.
fn shape(track: &Track) -> Shape {
    if track.sampled.is_some() { Shape::Line } else { Shape::Step }
}

fn trajectory(snapshot: &Snapshot, track: &Track) -> Trajectory {
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
        drawn.t_ns.push(snapshot.end.as_nanos());
        drawn.values.push(value);
    }
    drawn
}
