//! Bars over an axis: how many times of which length, how much of the time which values.

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

/// How much of the time a signal had which values, in bins of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueHistogram {
    /// The signal's name, which stands above the bars.
    pub title: String,
    /// What there is to say beside the title, as what is outside of the bins.
    pub remark: String,
    /// The unit of the values, if they have one.
    pub unit: Option<String>,
    /// Where the first bin begins, in that unit.
    pub from: f64,
    /// Where the last bin ends, in that unit.
    pub to: f64,
    /// What part of the time belongs to each bin, 0 to 1.
    pub shares: Vec<f64>,
}

impl Histogram {
    /// The picture as an SVG document: the same histogram, the same bytes.
    pub fn to_svg(&self) -> String {
        let bins = self.counts.len().max(1) as f64;
        let (from, bin) = (self.from_ns as f64 / 1e9, self.bin_ns.max(1) as f64 / 1e9);
        let x = ValueRange { low: from, high: from + bin * bins };
        let drawing = Drawing {
            title: &self.title,
            remark: &self.remark,
            x,
            heights: self.counts.iter().map(|count| *count as f64).collect(),
            least: 1.0,
            numbers: Numbers::Whole,
        };
        let description = format!("Histogram of times from {} s to {} s. {}", x.low, x.high, self.remark);
        drawing.draw(&description, caption::time)
    }
}

impl ValueHistogram {
    /// The picture as an SVG document: the same histogram, the same bytes.
    pub fn to_svg(&self) -> String {
        let known = |share: &f64| if share.is_finite() { 100.0 * share.clamp(0.0, 1.0) } else { 0.0 };
        let title = format!("{}, % of the time", self.title);
        let drawing = Drawing {
            title: &title,
            remark: &self.remark,
            x: ValueRange { low: self.from, high: self.to },
            heights: self.shares.iter().map(known).collect(),
            least: 0.0,
            numbers: Numbers::Real,
        };
        let unit = self.unit.as_deref();
        let of = unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let description = format!("Histogram of values from {}{of} to {}{of}. {}", self.from, self.to, self.remark);
        drawing.draw(&description, |exponent| format!("value{}", caption::in_unit(unit, exponent)))
    }
}

/// Bars of equal width over an axis.
struct Drawing<'a> {
    title: &'a str,
    remark: &'a str,
    /// From the left edge of the first bar to the right edge of the last.
    x: ValueRange,
    heights: Vec<f64>,
    /// The axis is as high as this at least.
    least: f64,
    numbers: Numbers,
}

impl Drawing<'_> {
    fn draw(&self, description: &str, name: impl Fn(i32) -> String) -> String {
        let most = self.heights.iter().copied().fold(self.least, f64::max);
        let y = ValueRange { low: 0.0, high: if most > 0.0 { most * 1.06 } else { 1.0 } };
        let (across, up) = (Ticks::within(self.x, TICKS.0, Numbers::Real), Ticks::within(y, TICKS.1, self.numbers));
        let label_px = up.marks.iter().map(|mark| width_px(&mark.label, TICK_PX)).max().unwrap_or(0);
        let left_px = MARGIN_PX + label_px + LABEL_GAP_PX;
        let width_px = WIDTH_PX - left_px - 2 * MARGIN_PX;
        let area = Area { left_px, top_px: TOP_PX, width_px, height_px: HEIGHT_PX };
        let mut document = Document::picture(WIDTH_PX, area.bottom_px() + BELOW_PX, self.title, description);
        self.draw_heading(&mut document, area);
        draw_grid(&mut document, area, (self.x, &across), (y, &up));
        let (middle_px, baseline_px) = (area.left_px + area.width_px / 2, area.bottom_px() + 36);
        let attributes: [super::svg::Attribute<'_>; 4] =
            [("x", &middle_px), ("y", &baseline_px), ("font-size", &NAME_PX), ("text-anchor", &"middle")];
        document.text("text", &attributes, &name(across.exponent));
        document.empty("path", &[("d", &self.bars(area, y)), ("fill", &FILL)]);
        let axes = format!("M{} {}v{}h{}", area.left_px, area.top_px, area.height_px, area.width_px);
        document.empty("path", &[("d", &axes), ("stroke", &AXIS), ("fill", &"none")]);
        document.finish()
    }

    fn draw_heading(&self, document: &mut Document, area: Area) {
        let baseline_px = area.top_px - 12;
        let room_px = area.width_px - width_px(self.remark, TICK_PX) - 10;
        let title = shortened(self.title, NAME_PX, room_px);
        document.text("text", &[("x", &area.left_px), ("y", &baseline_px), ("font-size", &NAME_PX)], &title);
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
        document.text("text", &[("x", &area.right_px()), ("y", &baseline_px)], self.remark);
        document.close();
    }

    fn bars(&self, area: Area, y: ValueRange) -> String {
        let bins = self.heights.len().max(1) as f64;
        let mut data = String::new();
        for (index, height) in self.heights.iter().enumerate().filter(|(_, height)| **height > 0.0) {
            let edge = |index: usize| area.x_cpx(index as f64 / bins);
            let (left, right) = (edge(index), edge(index + 1) - GAP_CPX);
            let bottom = area.bottom_px() * PIXEL_CPX;
            // One among thousands can still be seen.
            let height = (bottom - area.y_cpx(y.fraction(*height))).max(PIXEL_CPX);
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
}
