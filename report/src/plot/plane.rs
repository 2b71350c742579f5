//! Two signals against each other: the paths of several runs in a plane.
//!
//! Signals of one unit have one scale, so that a circle is one. Samples that lie within 0.05 pixels
//! of the line between their neighbours are left out.

use super::agreement::Agreement;
use super::caption;
use super::figure::{Legend, draw_title};
use super::layout::{Contents, Height, LABEL_GAP_PX, Layout, WIDTH_PX};
use super::lettering::{NAME_PX, TICK_PX, width_px};
use super::palette::{AXIS, FAINT_INK, GRID, stroke};
use super::panel::draw_pieces;
use super::part::{draw_edge, draw_frame, places, within};
use super::range::{ValueRange, is_empty};
use super::reduce::{PIXEL_CPX, Point};
use super::svg::{Document, Pixels, draw_note};
use super::ticks::{Numbers, Ticks};
use super::trace::Area;
use super::{Panel, Plot};

/// How high the plane is.
const HEIGHT_PX: (i64, i64) = (160, 620);
/// About how many ticks each axis has.
const TICKS: u32 = 8;
/// How far a sample that is left out may lie from the line.
const OFF_CPX: i64 = 5;
/// Samples of one straight stretch at most.
const STRETCH: usize = 64;

/// Draws the paths of `along` and `up`, with a part of the plane enlarged beside the whole if one is given; a run's
/// samples of both belong together one by one.
pub(super) fn draw(plot: &Plot, along: &Panel, up: &Panel, part: Option<[ValueRange; 2]>) -> String {
    let runs = caption::run_labels(plot);
    let agreements = [Agreement::of(along), Agreement::of(up)];
    let agreements = [&agreements[0], &agreements[1]];
    let legend = Legend::of(&agreements, &runs);
    let alike = along.unit == up.unit;
    let ranges = [ValueRange::of(along), ValueRange::of(up)];
    let labels_px = |[_, y]: [ValueRange; 2]| {
        let ticks = Ticks::within(y, TICKS, Numbers::Real);
        ticks.marks.iter().map(|mark| width_px(&mark.label, TICK_PX)).max().unwrap_or(0)
    };
    let layout = |height_px| {
        Layout::of(&Contents {
            title: &plot.title,
            run_labels: &legend.labels,
            texts: 0,
            value_label_px: labels_px(ranges),
            beside_label_px: part.map(labels_px),
            panels: &[Height::Plane(height_px)],
        })
    };
    let room_px = layout(0).panels.first().map_or(1, |area| area.width_px);
    let whole = scaled(ranges, room_px, alike);
    let enlarged = part.map(|part| scaled(part, room_px, alike));
    let layout = layout(whole.1.max(enlarged.map_or(0, |(_, height_px)| height_px)));
    let Some(&area) = layout.panels.first() else { return String::new() };

    let title = if plot.title.is_empty() { "Paths" } else { &plot.title };
    let (across, upwards) = (caption::heading(along, 0), caption::heading(up, 0));
    let description = caption::of_plane(&upwards, &across, &runs, part);
    let mut document = Document::picture(WIDTH_PX, layout.height_px, title, &description);
    draw_title(&mut document, &plot.title, &layout);
    legend.draw(&mut document, &layout);
    let paths = Paths { along, up, agreement: Agreement::of_all(&agreements, runs.len()), run_count: runs.len() };
    let ticks_across = if part.is_some() { TICKS / 2 } else { TICKS };
    let whole = Plane::of(area, whole);
    whole.draw(&mut document, &paths, ticks_across);
    if let (Some(enlarged), Some(beside)) = (enlarged, layout.beside) {
        let plane = Plane::of(beside.next_to(area), enlarged);
        plane.draw(&mut document, &paths, ticks_across);
        draw_frame(&mut document, whole.place([plane.x.low, plane.y.low]), whole.place([plane.x.high, plane.y.high]));
        draw_edge(&mut document, plane.area);
    }
    document.finish()
}

/// What is drawn in a plane.
struct Paths<'a> {
    along: &'a Panel,
    up: &'a Panel,
    agreement: Agreement,
    run_count: usize,
}

/// The ranges and the height that show both: one scale if `alike`, widening what is left over.
fn scaled([x, y]: [ValueRange; 2], width_px: i64, alike: bool) -> ([ValueRange; 2], i64) {
    let (width, least, most) = (width_px as f64, HEIGHT_PX.0 as f64, HEIGHT_PX.1 as f64);
    let (across, up) = (x.high / 2.0 - x.low / 2.0, y.high / 2.0 - y.low / 2.0);
    let per_px = (across / width).max(up / most);
    if !alike || !per_px.is_finite() || per_px <= 0.0 {
        return ([x, y], HEIGHT_PX.1 * 2 / 3);
    }
    let height = (up / per_px).clamp(least, most).round();
    let around = |range: ValueRange, half: f64| {
        let middle = range.low / 2.0 + range.high / 2.0;
        ValueRange { low: (middle - half).max(f64::MIN), high: (middle + half).min(f64::MAX) }
    };
    ([around(x, per_px * width), around(y, per_px * height)], height as i64)
}

/// The area of the plane and what its edges mean.
struct Plane {
    area: Area,
    x: ValueRange,
    y: ValueRange,
}

impl Plane {
    /// The plane of these ranges, as high as they need, at the top of an area.
    fn of(area: Area, ([x, y], height_px): ([ValueRange; 2], i64)) -> Self {
        Self { area: Area { height_px, ..area }, x, y }
    }

    /// Draws the axes, and the paths as far as they are within them.
    fn draw(&self, document: &mut Document, paths: &Paths<'_>, ticks_across: u32) {
        let Paths { along, up, agreement, run_count } = paths;
        self.draw_axes(document, ticks_across, along, up);
        if is_empty(along) || is_empty(up) {
            let (middle_px, half_px) = (self.area.left_px + self.area.width_px / 2, self.area.height_px / 2);
            draw_note(document, middle_px, self.area.top_px + half_px + 4, "no samples");
            return;
        }
        document.open("g", &[("fill", &"none"), ("stroke-linejoin", &"round")]);
        for (run, (across, upwards)) in along.runs.iter().zip(&up.runs).enumerate() {
            if agreement.is_first(run) {
                let path = within(places(across, upwards), self.x, self.y);
                draw_pieces(document, &self.pieces(&path), stroke(run, *run_count));
            }
        }
        document.close();
    }

    /// Where the values of both signals meet.
    fn place(&self, [x, y]: [f64; 2]) -> Point {
        Point { x_cpx: self.area.x_cpx(self.x.fraction(x)), y_cpx: self.area.y_cpx(self.y.fraction(y)) }
    }

    /// The path of a run, one list of points for each piece between gaps.
    fn pieces(&self, path: &[[f64; 2]]) -> Vec<Vec<Point>> {
        let mut pieces: Vec<Vec<Point>> = vec![Vec::new()];
        for place in path {
            if !place.iter().all(|value| value.is_finite()) {
                pieces.push(Vec::new());
                continue;
            }
            let point = self.place(*place);
            if let Some(piece) = pieces.last_mut().filter(|piece| piece.last() != Some(&point)) {
                piece.push(point);
            }
        }
        pieces.iter().filter(|piece| !piece.is_empty()).map(|piece| straightened(piece)).collect()
    }

    fn draw_axes(&self, document: &mut Document, ticks_across: u32, along: &Panel, up: &Panel) {
        let x = (&Ticks::within(self.x, ticks_across, Numbers::Real), along);
        let y = (&Ticks::within(self.y, TICKS, Numbers::Real), up);
        let area = self.area;
        let at = |value| Pixels(area.x_cpx(self.x.fraction(value)));
        let height = |value| area.y_cpx(self.y.fraction(value));
        let across = x.0.marks.iter().map(|mark| format!("M{} {}v{}", at(mark.value), area.top_px, area.height_px));
        let up =
            y.0.marks.iter().map(|mark| format!("M{} {}h{}", area.left_px, Pixels(height(mark.value)), area.width_px));
        let grid: String = across.chain(up).collect();
        document.empty("path", &[("d", &grid), ("stroke", &GRID), ("fill", &"none")]);
        let axes = format!("M{} {}v{}h{}", area.left_px, area.top_px, area.height_px, area.width_px);
        document.empty("path", &[("d", &axes), ("stroke", &AXIS), ("fill", &"none")]);
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
        for mark in &y.0.marks {
            let baseline = Pixels(height(mark.value) + 4 * PIXEL_CPX);
            document.text("text", &[("x", &(area.left_px - LABEL_GAP_PX)), ("y", &baseline)], &mark.label);
        }
        document.close();
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"middle")]);
        for mark in &x.0.marks {
            document.text("text", &[("x", &at(mark.value)), ("y", &(area.bottom_px() + 16))], &mark.label);
        }
        document.close();
        let (middle_px, baseline_px) = (area.left_px + area.width_px / 2, area.bottom_px() + 36);
        let named = |(ticks, panel): (&Ticks, &Panel)| caption::heading(panel, ticks.exponent);
        let upwards =
            [("x", &area.left_px as &dyn std::fmt::Display), ("y", &(area.top_px - 7)), ("font-size", &NAME_PX)];
        document.text("text", &upwards, &named(y));
        document.text(
            "text",
            &[("x", &middle_px), ("y", &baseline_px), ("font-size", &NAME_PX), ("text-anchor", &"middle")],
            &named(x),
        );
    }
}

/// A path without the points that lie on the lines between those that are kept.
fn straightened(piece: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = piece.first().copied().into_iter().collect();
    let mut from = 0;
    for to in 1..piece.len() {
        let ends = piece.get(to + 1).is_none_or(|next| {
            to + 1 - from > STRETCH || !piece[from + 1..=to].iter().all(|point| is_near(*point, piece[from], *next))
        });
        if ends {
            kept.push(piece[to]);
            from = to;
        }
    }
    kept
}

/// True if a point lies between two others, and next to the line between them.
fn is_near(point: Point, from: Point, to: Point) -> bool {
    let (dx, dy) = (to.x_cpx - from.x_cpx, to.y_cpx - from.y_cpx);
    let (px, py) = (point.x_cpx - from.x_cpx, point.y_cpx - from.y_cpx);
    let (length, along, across) = (dx * dx + dy * dy, px * dx + py * dy, (px * dy - py * dx).abs());
    // Beside the line by |across| / sqrt(length).
    (0..=length).contains(&along)
        && i128::from(across) * i128::from(across) <= i128::from(OFF_CPX * OFF_CPX) * i128::from(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_and_straight_lines_have_two_points() {
        let at = |x_cpx, y_cpx| Point { x_cpx, y_cpx };
        let mut path: Vec<Point> = (0..20).map(|step| at(step * 100, step * 50)).collect();
        path.extend((0..20).map(|step| at(1900, 950 - step * 30)));
        path.push(at(0, 0));
        assert_eq!(straightened(&path), [at(0, 0), at(1900, 950), at(1900, 380), at(0, 0)]);
        let back = [at(0, 0), at(500, 0), at(100, 0)];
        assert_eq!(straightened(&back), back, "a path that turns back is not shortened");
        assert_eq!(straightened(&[at(1, 1)]), [at(1, 1)]);
        assert_eq!(straightened(&[]), []);
    }

    #[test]
    fn one_unit_is_one_scale() {
        let range = |low, high| ValueRange { low, high };
        let whole = [range(0.0, 8.0), range(0.0, 2.0)];
        assert_eq!(scaled(whole, 800, true), (whole, 200));
        let ([x, y], height_px) = scaled([range(0.0, 1.0), range(0.0, 2.0)], 800, true);
        assert_eq!(height_px, HEIGHT_PX.1);
        assert!(((x.high - x.low) / 800.0 - (y.high - y.low) / HEIGHT_PX.1 as f64).abs() < 1e-12);
        assert_eq!(scaled([range(0.0, 1.0), range(0.0, 9.0)], 800, false).0[1], range(0.0, 9.0));
        assert!(scaled([range(f64::MIN, f64::MAX), range(0.0, 1.0)], 800, true).1 >= HEIGHT_PX.0);
    }
}
