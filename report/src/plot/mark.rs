//! Instants that stand out: a line through all panels, with a label at its head.

use super::lettering::{TICK_PX, shortened, width_px};
use super::palette::ALARM;
use super::svg::{Document, Pixels};
use super::time_axis::TimeAxis;
use super::trace::Area;
use super::{Mark, Plot};

/// Between a mark's line and its label.
const GAP_PX: i64 = 4;
/// Between the labels of marks at one place.
const LINE_PX: i64 = 13;

/// Draws the marks of a plot over its panels.
pub(super) fn draw_marks(document: &mut Document, plot: &Plot, panels: &[Area], time: &TimeAxis) {
    let (Some(first), Some(last)) = (panels.first(), panels.last()) else { return };
    let shown = |mark: &&Mark| (time.range.start_ns..=time.range.end_ns).contains(&mark.t_ns);
    for (row, mark) in (0..).zip(plot.marks.iter().filter(shown)) {
        draw_mark(document, mark, row, (*first, *last), time);
    }
}

fn draw_mark(document: &mut Document, mark: &Mark, row: i64, (first, last): (Area, Area), time: &TimeAxis) {
    let x_cpx = first.x_cpx(time.range.fraction(mark.t_ns));
    let line = format!("M{} {}v{}", Pixels(x_cpx), first.top_px, last.bottom_px() - first.top_px);
    document.empty("path", &[("d", &line), ("stroke", &ALARM), ("stroke-width", &1), ("stroke-dasharray", &"4 3")]);

    // To the side on which there is more room.
    let x_px = x_cpx / 100;
    let (left_room_px, right_room_px) = (x_px - first.left_px - GAP_PX, first.right_px() - x_px - GAP_PX);
    let label = shortened(&mark.label, TICK_PX, left_room_px.max(right_room_px));
    let is_right = width_px(&label, TICK_PX) <= right_room_px || right_room_px >= left_room_px;
    let (x_px, anchor) = if is_right { (x_px + GAP_PX, "start") } else { (x_px - GAP_PX, "end") };
    let rows = (first.height_px / LINE_PX).max(1);
    let baseline_px = first.top_px + 10 + row % rows * LINE_PX;
    document.text(
        "text",
        &[("x", &x_px), ("y", &baseline_px), ("font-size", &TICK_PX), ("fill", &ALARM), ("text-anchor", &anchor)],
        &label,
    );
}
