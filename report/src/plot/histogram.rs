//! How many times of which length: bars over an axis of time.

use std::fmt::Write as _;

use super::bars::FILL;
use super::caption;
use super::layout::{LABEL_GAP_PX, WIDTH_PX};
use super::lettering::{NAME_PX, TICK_PX, shortened, width_px};
use super::palette::{AXIS, FAINT_INK, GRID};
use super::range::ValueRange;
use super::reduce::PIXEL_CPX;
use super::svg::{Document, Pixels};
use super::ticks::{Numbers, Ticks};
use super::trace::Area;

const HEIGHT_PX: i64 = 180;
const TOP_PX: i64 = 40;
const MARGIN_PX: i64 = 16;
/// The room of the axis and its name below.
const BELOW_PX: i64 = 48;
const TICKS: (u32, u32) = (8, 5);
const GAP_CPX: i64 = 100;

/// Times in bins of equal width.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Histogram {
    /// What took these times.
    pub title: String,
    /// What there is to say beside the title, as mean and quantiles.
    pub remark: String,
    /// Where the first bin begins, in nanoseconds.
    pub from_ns: u64,
    /// Width of a bin, in nanoseconds.
    pub bin_ns: u64,
    /// How many in each bin.
    pub counts: Vec<u64>,
}

impl Histogram {
    /// The picture as an SVG document: the same histogram, the same bytes.
    pub fn to_svg(&self) -> String {
        let most = self.counts.iter().copied().max().unwrap_or(0).max(1);
        let y = ValueRange { low: 0.0, high: most as f64 * 1.06 };
        let bins = self.counts.len().max(1) as f64;
        let (from, bin) = (self.from_ns as f64 / 1e9, self.bin_ns.max(1) as f64 / 1e9);
        let x = ValueRange { low: from, high: from + bin * bins };
        let (across, up) = (Ticks::within(x, TICKS.0, Numbers::Real), Ticks::within(y, TICKS.1, Numbers::Whole));
        let label_px = up.marks.iter().map(|mark| width_px(&mark.label, TICK_PX)).max().unwrap_or(0);
        let left_px = MARGIN_PX + label_px + LABEL_GAP_PX;
        let width_px = WIDTH_PX - left_px - 2 * MARGIN_PX;
        let area = Area { left_px, top_px: TOP_PX, width_px, height_px: HEIGHT_PX };
        let description = format!("Histogram of times from {} s to {} s. {}", x.low, x.high, self.remark);
        let mut document = Document::picture(WIDTH_PX, area.bottom_px() + BELOW_PX, &self.title, &description);
        self.draw_heading(&mut document, area);
        draw_grid(&mut document, area, (x, &across), (y, &up));
        document.empty("path", &[("d", &self.bars(area, y)), ("fill", &FILL)]);
        let axes = format!("M{} {}v{}h{}", area.left_px, area.top_px, area.height_px, area.width_px);
        document.empty("path", &[("d", &axes), ("stroke", &AXIS), ("fill", &"none")]);
        document.finish()
    }

    fn draw_heading(&self, document: &mut Document, area: Area) {
        let baseline_px = area.top_px - 12;
        let room_px = area.width_px - width_px(&self.remark, TICK_PX) - 10;
        let title = shortened(&self.title, NAME_PX, room_px);
        document.text("text", &[("x", &area.left_px), ("y", &baseline_px), ("font-size", &NAME_PX)], &title);
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
        document.text("text", &[("x", &area.right_px()), ("y", &baseline_px)], &self.remark);
        document.close();
    }

    fn bars(&self, area: Area, y: ValueRange) -> String {
        let bins = self.counts.len().max(1) as f64;
        let mut data = String::new();
        for (index, count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let edge = |index: usize| area.x_cpx(index as f64 / bins);
            let (left, right) = (edge(index), edge(index + 1) - GAP_CPX);
            let bottom = area.bottom_px() * PIXEL_CPX;
            // One among thousands can still be seen.
            let height = (bottom - area.y_cpx(y.fraction(*count as f64))).max(PIXEL_CPX);
            let width = (right - left).max(PIXEL_CPX);
            let (x, top) = (Pixels(left), Pixels(bottom - height));
            let (width, height) = (Pixels(width), Pixels(height));
            let _ = write!(data, "M{x} {top}h{width}v{height}h-{width}z");
        }
        data
    }
}

fn draw_grid(document: &mut Document, area: Area, x: (ValueRange, &Ticks), y: (ValueRange, &Ticks)) {
    let height = |value| area.y_cpx(y.0.fraction(value));
    let grid =
        y.1.marks.iter().map(|mark| format!("M{} {}h{}", area.left_px, Pixels(height(mark.value)), area.width_px));
    document.empty("path", &[("d", &grid.collect::<String>()), ("stroke", &GRID), ("fill", &"none")]);
    document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
    for mark in &y.1.marks {
        let baseline = Pixels(height(mark.value) + 4 * PIXEL_CPX);
        document.text("text", &[("x", &(area.left_px - LABEL_GAP_PX)), ("y", &baseline)], &mark.label);
    }
    document.close();
    document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"middle")]);
    for mark in &x.1.marks {
        let at = Pixels(area.x_cpx(x.0.fraction(mark.value)));
        document.text("text", &[("x", &at), ("y", &(area.bottom_px() + 16))], &mark.label);
    }
    document.close();
    let (middle_px, baseline_px) = (area.left_px + area.width_px / 2, area.bottom_px() + 36);
    let attributes: [super::svg::Attribute<'_>; 4] =
        [("x", &middle_px), ("y", &baseline_px), ("font-size", &NAME_PX), ("text-anchor", &"middle")];
    document.text("text", &attributes, &caption::time(x.1.exponent));
}
