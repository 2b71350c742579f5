//! One panel: heading, grid, labels and the runs on top of each other.

use std::fmt::Write as _;

use super::agreement::Agreement;
use super::caption;
use super::layout::{Height, LABEL_GAP_PX};
use super::lettering::{NAME_PX, TICK_PX, shortened, width_px};
use super::palette::{AXIS, FAINT_INK, GRID, Stroke, stroke};
use super::range::{ValueRange, is_empty, is_two_valued, is_whole};
use super::reduce::{PIXEL_CPX, Point};
use super::svg::{Document, Pixels, draw_line, draw_note, path_data};
use super::ticks::{Numbers, Ticks};
use super::time_axis::TimeAxis;
use super::trace::{Area, Frame, pieces};
use super::{Panel, Shape};

const TICKS: u32 = 6;
/// How much wider a dot is than its run's line.
const DOT_EXTRA_CPX: i64 = 250;

/// A panel with the axis of its values.
#[derive(Debug)]
pub(super) struct Axis<'a> {
    pub(super) panel: &'a Panel,
    pub(super) agreement: Agreement,
    pub(super) values: ValueRange,
    ticks: Ticks,
}

impl<'a> Axis<'a> {
    /// The axis that shows all values.
    pub(super) fn of(panel: &'a Panel) -> Self {
        let values = ValueRange::of(panel);
        let ticks = match panel.shape {
            Shape::Step if is_two_valued(panel) => Ticks::of_bool(),
            _ if is_empty(panel) => Ticks::default(),
            _ if let Some(named) = Ticks::named(values, &panel.names) => named,
            Shape::Step if is_whole(panel) => Ticks::within(values, TICKS, Numbers::Whole),
            _ => Ticks::within(values, TICKS, Numbers::Real),
        };
        Self { panel, agreement: Agreement::of(panel), values, ticks }
    }

    /// How high the panel is.
    pub(super) fn height(&self) -> Height {
        if is_two_valued(self.panel) { Height::Bool } else { Height::Analog }
    }

    /// The width of the widest label.
    pub(super) fn label_px(&self) -> i64 {
        self.ticks.marks.iter().map(|mark| width_px(&mark.label, TICK_PX)).max().unwrap_or(0)
    }

    /// Draws the panel of a picture with `run_count` runs.
    ///
    /// The heading stands `above_px` above the panel.
    pub(super) fn draw(&self, document: &mut Document, area: Area, above_px: i64, time: &TimeAxis, run_count: usize) {
        self.draw_heading(document, area, above_px);
        let frame = Frame { area, times: time.range, values: self.values };
        self.draw_grid(document, &frame, time);
        if is_empty(self.panel) {
            let (middle_px, baseline_px) = (area.left_px + area.width_px / 2, area.top_px + area.height_px / 2 + 4);
            draw_note(document, middle_px, baseline_px, "no samples");
            return;
        }
        document.open("g", &[("fill", &"none"), ("stroke-linejoin", &"round")]);
        for (run, trajectory) in self.panel.runs.iter().enumerate() {
            if self.agreement.is_first(run) {
                draw_pieces(document, &pieces(trajectory, self.panel.shape, &frame), stroke(run, run_count));
            }
        }
        document.close();
    }

    /// The name of the signal to the left, how its runs compare to the right.
    fn draw_heading(&self, document: &mut Document, area: Area, above_px: i64) {
        let baseline_px = area.top_px - 7 - above_px;
        let remark = self.agreement.remark().unwrap_or_default();
        let room_px = area.width_px - width_px(&remark, TICK_PX) - 10;
        let name = shortened(&caption::heading(self.panel, self.ticks.exponent), NAME_PX, room_px);
        document.text("text", &[("x", &area.left_px), ("y", &baseline_px), ("font-size", &NAME_PX)], &name);
        if !remark.is_empty() {
            document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
            document.text("text", &[("x", &area.right_px()), ("y", &baseline_px)], &remark);
            document.close();
        }
    }

    /// The grid in one path, the axes in another, and the labels of the values.
    fn draw_grid(&self, document: &mut Document, frame: &Frame, time: &TimeAxis) {
        let area = frame.area;
        let height = |value| Pixels(area.y_cpx(self.values.fraction(value)));
        let mut grid = String::new();
        for x in time.positions(area) {
            let _ = write!(grid, "M{x} {}v{}", area.top_px, area.height_px);
        }
        for mark in &self.ticks.marks {
            let _ = write!(grid, "M{} {}h{}", area.left_px, height(mark.value), area.width_px);
        }
        document.empty("path", &[("d", &grid), ("stroke", &GRID), ("fill", &"none")]);
        let axes = format!("M{} {}v{}h{}", area.left_px, area.top_px, area.height_px, area.width_px);
        document.empty("path", &[("d", &axes), ("stroke", &AXIS), ("fill", &"none")]);

        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
        for mark in &self.ticks.marks {
            let baseline = Pixels(height(mark.value).0 + 4 * PIXEL_CPX);
            document.text("text", &[("x", &(area.left_px - LABEL_GAP_PX)), ("y", &baseline)], &mark.label);
        }
        document.close();
    }
}

/// The lines of a run, and its lone samples as dots.
pub(super) fn draw_pieces(document: &mut Document, pieces: &[Vec<Point>], stroke: Stroke) {
    let pieces = pieces.iter().map(Vec::as_slice);
    let (lines, dots): (Vec<&[Point]>, Vec<&[Point]>) = pieces.partition(|piece| piece.len() > 1);
    if !lines.is_empty() {
        draw_line(document, &path_data(&lines), stroke);
    }
    if !dots.is_empty() {
        let width = Pixels(stroke.width_cpx + DOT_EXTRA_CPX);
        let data = path_data(&dots);
        document.empty(
            "path",
            &[("d", &data), ("stroke", &stroke.colour), ("stroke-width", &width), ("stroke-linecap", &"round")],
        );
    }
}
