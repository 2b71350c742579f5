//! The samples of a signal as pieces of line on the picture.

use super::range::{TimeRange, ValueRange, samples};
use super::reduce::{PIXEL_CPX, Point, straighten, thin_columns};
use super::{Shape, Trajectory};

/// A gap narrower than this cannot be seen beneath the width of a line.
const GAP_MIN_CPX: i64 = PIXEL_CPX / 4;

/// A rectangle on the picture, in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(clippy::struct_field_names, reason = "the unit goes last in a name")]
pub(super) struct Area {
    pub(super) left_px: i64,
    pub(super) top_px: i64,
    pub(super) width_px: i64,
    pub(super) height_px: i64,
}

impl Area {
    /// The lower edge.
    pub(super) fn bottom_px(self) -> i64 {
        self.top_px + self.height_px
    }

    /// The right edge.
    pub(super) fn right_px(self) -> i64 {
        self.left_px + self.width_px
    }

    /// Where a fraction of the width ends.
    pub(super) fn x_cpx(self, fraction: f64) -> i64 {
        self.left_px * PIXEL_CPX + scaled(self.width_px, fraction)
    }

    /// Where a fraction of the height ends, counted from below.
    pub(super) fn y_cpx(self, fraction: f64) -> i64 {
        self.bottom_px() * PIXEL_CPX - scaled(self.height_px, fraction)
    }
}

fn scaled(length_px: i64, fraction: f64) -> i64 {
    ((length_px * PIXEL_CPX) as f64 * fraction).round() as i64
}

/// The area of a panel and what its edges mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) area: Area,
    pub(super) times: TimeRange,
    pub(super) values: ValueRange,
}

impl Frame {
    /// Where a sample lies.
    pub(super) fn place(&self, t_ns: u64, value: f64) -> Point {
        Point { x_cpx: self.area.x_cpx(self.times.fraction(t_ns)), y_cpx: self.area.y_cpx(self.values.fraction(value)) }
    }
}

/// The corners of the lines that draw a trajectory, one list for each piece between gaps.
///
/// A piece of one point is a lone sample.
pub(super) fn pieces(run: &Trajectory, shape: Shape, frame: &Frame) -> Vec<Vec<Point>> {
    let reduced = |piece: Vec<Point>| match shape {
        Shape::Line => straighten(&thin_columns(&piece)),
        Shape::Step => stairs(&thin_columns(&changes(&piece))),
    };
    unbroken(run, shape, frame).into_iter().map(reduced).collect()
}

/// The samples between gaps. A step holds up to the instant at which its gap begins.
fn unbroken(run: &Trajectory, shape: Shape, frame: &Frame) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    let mut gap_since_cpx: Option<i64> = None;
    let mut last_ns = 0;
    for (t_ns, value) in samples(run) {
        let went_back = t_ns < last_ns;
        last_ns = t_ns;
        if !value.is_finite() {
            gap_since_cpx = gap_since_cpx.or(Some(frame.place(t_ns, 0.0).x_cpx));
            continue;
        }
        let point = frame.place(t_ns, value);
        let gap = gap_since_cpx.take();
        match pieces.last_mut() {
            Some(piece) if !went_back && gap.is_none_or(|since| point.x_cpx - since < GAP_MIN_CPX) => {
                piece.push(point);
            }
            previous => {
                hold(previous, shape, gap);
                pieces.push(vec![point]);
            }
        }
    }
    hold(pieces.last_mut(), shape, gap_since_cpx);
    pieces
}

/// Lets a step keep its last value until `until_cpx`.
fn hold(piece: Option<&mut Vec<Point>>, shape: Shape, until_cpx: Option<i64>) {
    if let (Some(piece), Shape::Step, Some(x_cpx)) = (piece, shape, until_cpx)
        && let Some(&last) = piece.last()
        && last.x_cpx < x_cpx
    {
        piece.push(Point { x_cpx, ..last });
    }
}

/// The points at which a step takes another value, and its first and last.
fn changes(piece: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for &point in piece {
        if kept.last().is_none_or(|last| last.y_cpx != point.y_cpx) {
            kept.push(point);
        }
    }
    if let Some(&end) = piece.last()
        && kept.last() != Some(&end)
    {
        kept.push(end);
    }
    kept
}

/// The corners of a step: along, then up or down.
fn stairs(changes: &[Point]) -> Vec<Point> {
    let mut corners: Vec<Point> = Vec::new();
    for &point in changes {
        if let Some(&last) = corners.last() {
            let corner = Point { x_cpx: point.x_cpx, ..last };
            if corner != last && corner != point {
                corners.push(corner);
            }
        }
        corners.push(point);
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame {
        area: Area { left_px: 0, top_px: 0, width_px: 100, height_px: 10 },
        times: TimeRange { start_ns: 0, end_ns: 100_000 },
        values: ValueRange { low: 0.0, high: 1.0 },
    };

    fn drawn(t_ns: &[u64], values: &[f64], shape: Shape) -> Vec<Vec<(i64, i64)>> {
        let run = Trajectory { t_ns: t_ns.to_vec(), values: values.to_vec() };
        let pairs = |piece: Vec<Point>| piece.into_iter().map(|point| (point.x_cpx, point.y_cpx)).collect();
        pieces(&run, shape, &FRAME).into_iter().map(pairs).collect()
    }

    #[test]
    fn a_step_goes_along_and_then_up() {
        let corners = drawn(&[0, 10_000, 20_000, 30_000], &[0.0, 0.0, 1.0, 1.0], Shape::Step);
        assert_eq!(corners, [[(0, 1000), (2000, 1000), (2000, 0), (3000, 0)]]);
    }

    #[test]
    fn a_gap_interrupts_a_line_and_ends_a_step() {
        let (t_ns, values) = ([0, 10_000, 20_000, 30_000, 40_000], [0.0, 1.0, f64::NAN, 1.0, f64::INFINITY]);
        assert_eq!(drawn(&t_ns, &values, Shape::Line), [vec![(0, 1000), (1000, 0)], vec![(3000, 0)]]);
        let corners = [vec![(0, 1000), (1000, 1000), (1000, 0), (2000, 0)], vec![(3000, 0), (4000, 0)]];
        assert_eq!(drawn(&t_ns, &values, Shape::Step), corners);
    }

    #[test]
    fn time_that_goes_back_interrupts_a_line() {
        assert_eq!(drawn(&[50_000, 10_000], &[0.0, 1.0], Shape::Line), [[(5000, 1000)], [(1000, 0)]]);
    }

    #[test]
    fn a_pulse_of_one_sample_survives_among_100_000() {
        for at in [0, 1, 49_999, 50_050, 99_998, 99_999] {
            for shape in [Shape::Step, Shape::Line] {
                let t_ns: Vec<u64> = (0..100_000).collect();
                let mut values = vec![0.0; t_ns.len()];
                values[at] = 1.0;
                let corners = drawn(&t_ns, &values, shape);
                assert!(corners[0].iter().any(|corner| corner.1 == 0), "sample {at} as {shape:?}");
                assert!(corners[0].len() < 10);
            }
        }
    }
}
