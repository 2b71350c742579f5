//! A part of a picture, drawn enlarged beside the whole; a frame in the whole shows where it is.

use super::caption;
use super::palette::FAINT_INK;
use super::range::{TimeRange, ValueRange, finite_range, is_empty, samples};
use super::reduce::Point;
use super::svg::{Document, Pixels};
use super::trace::Area;
use super::{Panel, Plot, Shape, Trajectory};
use crate::number::short;

/// A frame is at least this wide and high, so that it is seen.
const FRAME_LEAST_CPX: i64 = 600;

/// A part of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// Of a picture over time, in nanoseconds of virtual time.
    Times { from_ns: u64, until_ns: u64 },
    /// Of a picture in a plane, in the units of its signals.
    Plane {
        /// From left to right.
        across: [f64; 2],
        up: [f64; 2],
    },
}

/// No run comes to the part that is to be enlarged.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("nothing is drawn in the part to be enlarged")]
pub struct NothingThere {
    /// What is drawn in the whole picture.
    pub drawn: String,
}

/// What is drawn of a plot between two instants.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cut {
    pub(super) times: TimeRange,
    pub(super) panels: Vec<Panel>,
}

impl Cut {
    /// The panels between two instants, with the values that their lines have there.
    ///
    /// # Errors
    /// There is nothing to draw in it.
    pub(super) fn of(plot: &Plot, from_ns: u64, until_ns: u64) -> Result<Self, NothingThere> {
        let whole = TimeRange::of(plot);
        let times = TimeRange { start_ns: from_ns.max(whole.start_ns), end_ns: until_ns.min(whole.end_ns) };
        let panel = |panel: &Panel| Panel {
            signal: panel.signal.clone(),
            unit: panel.unit.clone(),
            shape: panel.shape,
            names: panel.names.clone(),
            runs: panel.runs.iter().map(|run| between(run, panel.shape, times)).collect(),
        };
        let panels: Vec<Panel> = plot.panels.iter().map(panel).collect();
        if times.start_ns >= times.end_ns || panels.iter().all(is_empty) {
            let seconds = whole.seconds();
            return Err(NothingThere { drawn: format!("time is from {} s to {} s", seconds.low, seconds.high) });
        }
        Ok(Self { times, panels })
    }
}

/// The samples within these times, and what the line between samples is where they begin and end.
fn between(run: &Trajectory, shape: Shape, times: TimeRange) -> Trajectory {
    let mut part = Trajectory::default();
    let mut take = |t_ns, value| {
        part.t_ns.push(t_ns);
        part.values.push(value);
    };
    let mut before: Option<(u64, f64)> = None;
    for (t_ns, value) in samples(run) {
        if let Some(before) = before {
            for edge_ns in [times.start_ns, times.end_ns] {
                if before.0 < edge_ns && edge_ns < t_ns {
                    take(edge_ns, on_the_way(before, (t_ns, value), shape, edge_ns));
                }
            }
        }
        if (times.start_ns..=times.end_ns).contains(&t_ns) {
            take(t_ns, value);
        }
        before = Some((t_ns, value));
    }
    part
}

/// What a line is at an instant between two samples.
fn on_the_way(before: (u64, f64), after: (u64, f64), shape: Shape, t_ns: u64) -> f64 {
    match shape {
        Shape::Step => before.1,
        Shape::Line => {
            let part = (t_ns - before.0) as f64 / (after.0 - before.0) as f64;
            before.1 * (1.0 - part) + after.1 * part
        }
    }
}

/// The pieces of a path that are within two ranges, with gaps between them: each line is cut where it leaves them.
pub(super) fn within(path: impl Iterator<Item = [f64; 2]>, across: ValueRange, up: ValueRange) -> Vec<[f64; 2]> {
    const GAP: [f64; 2] = [f64::NAN; 2];
    let mut pieces: Vec<[f64; 2]> = Vec::new();
    let is_inside = |[x, y]: [f64; 2]| (across.low..=across.high).contains(&x) && (up.low..=up.high).contains(&y);
    let mut before: Option<[f64; 2]> = None;
    for place in path {
        let line = match before {
            Some(before) if is_inside(before) && is_inside(place) => Some((before, [before, place])),
            Some(before) => crossing(before, place, across, up).map(|ends| (before, ends)),
            None => None,
        };
        match line {
            // An end that is inside has been taken already, or is taken below.
            Some((before, [enters, leaves])) => {
                if !is_inside(before) {
                    pieces.push(GAP);
                    pieces.push(enters);
                }
                if !is_inside(place) {
                    pieces.push(leaves);
                }
            }
            None => pieces.push(GAP),
        }
        if is_inside(place) {
            pieces.push(place);
        }
        before = Some(place);
    }
    pieces
}

/// Where the line between two places enters and leaves a rectangle; nothing if it passes by.
fn crossing(from: [f64; 2], to: [f64; 2], across: ValueRange, up: ValueRange) -> Option<[[f64; 2]; 2]> {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (from, to, range) in [(from[0], to[0], across), (from[1], to[1], up)] {
        let length = to - from;
        if !length.is_finite() {
            return None;
        }
        if length == 0.0 {
            if !(range.low..=range.high).contains(&from) {
                return None;
            }
            continue;
        }
        let (low, high) = ((range.low - from) / length, (range.high - from) / length);
        first = first.max(low.min(high));
        last = last.min(low.max(high));
    }
    let at = |part: f64| [from[0] + (to[0] - from[0]) * part, from[1] + (to[1] - from[1]) * part];
    (first <= last).then(|| [at(first), at(last)])
}

/// The part of a plane, if the path of a run comes there.
///
/// # Errors
/// None does.
pub(super) fn in_plane(
    along: &Panel,
    upwards: &Panel,
    [across, up]: [[f64; 2]; 2],
) -> Result<[ValueRange; 2], NothingThere> {
    let [across, up] = [across, up].map(|[low, high]| ValueRange { low, high });
    let is_there =
        |(x, y): (&Trajectory, &Trajectory)| within(places(x, y), across, up).iter().any(|[x, _]| x.is_finite());
    if across.is_stretch() && up.is_stretch() && along.runs.iter().zip(&upwards.runs).any(is_there) {
        return Ok([across, up]);
    }
    let of = |panel: &Panel| match finite_range(panel) {
        Some(range) => format!("{} is from {} to {}", caption::heading(panel, 0), short(range.low), short(range.high)),
        None => format!("{} has no values", caption::heading(panel, 0)),
    };
    Err(NothingThere { drawn: format!("{}, {}", of(along), of(upwards)) })
}

/// The samples of two signals as places.
pub(super) fn places<'t>(across: &'t Trajectory, up: &'t Trajectory) -> impl Iterator<Item = [f64; 2]> + 't {
    across.values.iter().zip(&up.values).map(|(x, y)| [*x, *y])
}

/// Draws a frame from one corner to the opposite one.
pub(super) fn draw_frame(document: &mut Document, corner: Point, opposite: Point) {
    let (left_cpx, width_cpx) = seen(corner.x_cpx, opposite.x_cpx);
    let (top_cpx, height_cpx) = seen(corner.y_cpx, opposite.y_cpx);
    let [across, down, back, up] = [width_cpx, height_cpx, -width_cpx, -height_cpx].map(Pixels);
    let data = format!("M{} {}h{across}v{down}h{back}v{up}", Pixels(left_cpx), Pixels(top_cpx));
    document.empty("path", &[("d", &data), ("stroke", &FAINT_INK), ("fill", &"none")]);
}

/// Draws the frame around what is enlarged.
pub(super) fn draw_edge(document: &mut Document, area: Area) {
    let corner = |fraction| Point { x_cpx: area.x_cpx(fraction), y_cpx: area.y_cpx(fraction) };
    draw_frame(document, corner(0.0), corner(1.0));
}

/// Where a stretch begins and how long it is, widened around its middle if it is too short to be seen.
fn seen(a_cpx: i64, b_cpx: i64) -> (i64, i64) {
    let missing_cpx = (FRAME_LEAST_CPX - (a_cpx - b_cpx).abs()).max(0);
    (a_cpx.min(b_cpx) - missing_cpx / 2, (a_cpx - b_cpx).abs() + missing_cpx)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_over_time_is_cut_where_it_enters_and_leaves() {
        let times = TimeRange { start_ns: 10, end_ns: 30 };
        let run = Trajectory { t_ns: vec![0, 20, 40], values: vec![0.0, 2.0, 6.0] };
        let line = between(&run, Shape::Line, times);
        assert_eq!((line.t_ns, line.values), (vec![10, 20, 30], vec![1.0, 2.0, 4.0]));
        let step = between(&run, Shape::Step, times);
        assert_eq!((step.t_ns, step.values), (vec![10, 20, 30], vec![0.0, 2.0, 2.0]));
        let over = between(&Trajectory { t_ns: vec![0, 40], values: vec![0.0, 4.0] }, Shape::Line, times);
        assert_eq!((over.t_ns, over.values), (vec![10, 30], vec![1.0, 3.0]), "no sample is within");
        let before = between(&Trajectory { t_ns: vec![0, 5], values: vec![0.0, 4.0] }, Shape::Step, times);
        assert_eq!(before, Trajectory::default());
    }

    #[test]
    fn a_path_is_cut_where_it_enters_and_leaves() {
        let unit = ValueRange { low: 0.0, high: 1.0 };
        let of = |path: &[[f64; 2]]| -> Vec<[f64; 2]> {
            let pieces = within(path.iter().copied(), unit, unit);
            pieces.into_iter().filter(|[x, _]| x.is_finite()).collect()
        };
        assert_eq!(of(&[[-1.0, 0.5], [2.0, 0.5]]), [[0.0, 0.5], [1.0, 0.5]], "straight through");
        assert_eq!(of(&[[0.5, 0.5], [0.5, 2.0], [0.75, 0.5]]).len(), 4, "out and in again");
        assert_eq!(of(&[[-1.0, 0.0], [0.0, 2.0]]), Vec::<[f64; 2]>::new(), "past a corner");
        assert_eq!(of(&[[0.2, 0.2], [0.3, 0.3]]), [[0.2, 0.2], [0.3, 0.3]]);
        assert_eq!(of(&[[f64::NAN, 0.2], [0.3, 0.3], [f64::INFINITY, 0.3]]), [[0.3, 0.3]]);
    }

    #[test]
    fn a_small_frame_is_seen() {
        assert_eq!(seen(1000, 1100), (750, 600));
        assert_eq!(seen(3000, 1000), (1000, 2000));
    }
}
