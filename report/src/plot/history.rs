//! The lowest, mean and highest values of signals in equal windows of time: a band with a line in it, a panel a signal.

use std::fmt::Write as _;

use super::bars::FILL;
use super::caption;
use super::layout::{LABEL_GAP_PX, WIDTH_PX};
use super::lettering::{NAME_PX, TICK_PX, shortened, width_px};
use super::palette::{AXIS, FAINT_INK, GRID};
use super::range::ValueRange;
use super::reduce::PIXEL_CPX;
use super::svg::{Document, Pixels, draw_note};
use super::ticks::{Numbers, Ticks};
use super::trace::Area;

const HEIGHT_PX: i64 = 96;
const TOP_PX: i64 = 28;
/// From the lower edge of a panel to the upper edge of the next one.
const BETWEEN_PX: i64 = 34;
const MARGIN_PX: i64 = 16;
/// The room of the axis and its name below.
const BELOW_PX: i64 = 48;
const TICKS: (u32, u32) = (10, 4);
/// How much of the band is seen: the line and the grid are seen, too.
const OPACITY: &str = "0.35";
const LINE_PX: &str = "1.3";
const SECOND_NS: f64 = 1e9;
/// Units of the axis, in seconds: the largest of which two are in the picture.
const UNITS: [(&str, f64); 3] = [("d", 86_400.0), ("h", 3600.0), ("s", 1.0)];

/// The history of signals.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    pub title: String,
    /// Where the first window begins, and the last one ends, in nanoseconds.
    pub from_ns: u64,
    pub to_ns: u64,
    /// Width of a window, in nanoseconds; the last one may be shorter.
    pub window_ns: u64,
    /// From top to bottom.
    pub signals: Vec<Past>,
}

/// The history of one signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Past {
    pub signal: String,
    /// The unit of its values, if they have one.
    pub unit: Option<String>,
    /// The lowest, mean and highest value in each window; nothing where it had none.
    pub windows: Vec<Option<[f64; 3]>>,
}

impl History {
    /// The picture as an SVG document: the same history, the same bytes.
    pub fn to_svg(&self) -> String {
        let axes: Vec<(ValueRange, Ticks)> = self.signals.iter().map(Past::axis).collect();
        let labels = axes.iter().flat_map(|(_, ticks)| &ticks.marks).map(|mark| width_px(&mark.label, TICK_PX));
        let left_px = MARGIN_PX + labels.max().unwrap_or(0) + LABEL_GAP_PX;
        let area = |panel: i64| Area {
            left_px,
            top_px: TOP_PX + panel * (HEIGHT_PX + BETWEEN_PX),
            width_px: WIDTH_PX - left_px - 2 * MARGIN_PX,
            height_px: HEIGHT_PX,
        };
        let count = i64::try_from(self.signals.len()).unwrap_or(i64::MAX / (HEIGHT_PX + BETWEEN_PX) / 2).max(1);
        let names: Vec<&str> = self.signals.iter().map(|past| past.signal.as_str()).collect();
        let description = format!("Lowest, mean and highest values in windows of time. Signals: {}.", names.join(", "));
        let height_px = area(count - 1).bottom_px() + BELOW_PX;
        let mut document = Document::picture(WIDTH_PX, height_px, &self.title, &description);
        if self.signals.is_empty() {
            draw_note(&mut document, WIDTH_PX / 2, TOP_PX + HEIGHT_PX / 2, "nothing");
            return document.finish();
        }
        let time = self.time();
        for ((panel, past), axis) in (0..).zip(&self.signals).zip(&axes) {
            self.draw(&mut document, area(panel), past, (axis, &time));
        }
        time.draw(&mut document, area(count - 1));
        document.finish()
    }

    fn time(&self) -> TimeAxis {
        let span_s = self.to_ns.saturating_sub(self.from_ns) as f64 / SECOND_NS;
        let (unit, length_s) = UNITS.into_iter().find(|(_, length_s)| span_s >= 2.0 * length_s).unwrap_or(UNITS[2]);
        let at = |t_ns: u64| t_ns as f64 / SECOND_NS / length_s;
        let range = ValueRange { low: at(self.from_ns), high: at(self.to_ns) };
        TimeAxis { unit, ticks: Ticks::within(range, TICKS.0, Numbers::Real), range }
    }

    fn draw(&self, document: &mut Document, area: Area, past: &Past, (axis, time): (&(ValueRange, Ticks), &TimeAxis)) {
        let (y, up) = axis;
        draw_heading(document, area, past, up.exponent);
        let height = |value| area.y_cpx(y.fraction(value));
        let mut grid = String::new();
        for mark in &time.ticks.marks {
            let _ = write!(grid, "M{} {}v{}", time.x(area, mark.value), area.top_px, area.height_px);
        }
        for mark in &up.marks {
            let _ = write!(grid, "M{} {}h{}", area.left_px, Pixels(height(mark.value)), area.width_px);
        }
        document.empty("path", &[("d", &grid), ("stroke", &GRID), ("fill", &"none")]);
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
        for mark in &up.marks {
            let baseline = Pixels(height(mark.value) + 4 * PIXEL_CPX);
            document.text("text", &[("x", &(area.left_px - LABEL_GAP_PX)), ("y", &baseline)], &mark.label);
        }
        document.close();
        let (band, line) = self.curves(area, past, *y);
        if line.is_empty() {
            draw_note(document, area.left_px + area.width_px / 2, area.top_px + area.height_px / 2 + 4, "no values");
        }
        document.empty("path", &[("d", &band), ("fill", &FILL), ("fill-opacity", &OPACITY)]);
        let line: [super::svg::Attribute<'_>; 4] =
            [("d", &line), ("stroke", &FILL), ("stroke-width", &LINE_PX), ("fill", &"none")];
        document.empty("path", &line);
        let axes = format!("M{} {}v{}h{}", area.left_px, area.top_px, area.height_px, area.width_px);
        document.empty("path", &[("d", &axes), ("stroke", &AXIS), ("fill", &"none")]);
    }

    /// From the lowest to the highest value of each window, and from mean to mean, broken where there is none.
    fn curves(&self, area: Area, past: &Past, y: ValueRange) -> (String, String) {
        let span_ns = self.to_ns.saturating_sub(self.from_ns).max(1);
        let edge = |window: u64| {
            let since_ns = window.saturating_mul(self.window_ns).min(span_ns);
            area.x_cpx(since_ns as f64 / span_ns as f64)
        };
        let height = |value| area.y_cpx(y.fraction(value));
        let (mut band, mut line, mut is_broken) = (String::new(), String::new(), true);
        for (window, values) in (0..).zip(&past.windows) {
            let Some([low, mean, high]) = values.filter(|values| values.iter().all(|value| value.is_finite())) else {
                is_broken = true;
                continue;
            };
            let (left, right) = (edge(window), edge(window.saturating_add(1)));
            let (top, width) = (height(high), Pixels(right - left));
            // values that are all the same are seen, too
            let tall = Pixels((height(low) - top).max(PIXEL_CPX));
            let _ = write!(band, "M{} {}h{width}v{tall}h-{width}z", Pixels(left), Pixels(top));
            let to = if is_broken { 'M' } else { 'L' };
            let _ = write!(line, "{to}{} {}H{}", Pixels(left), Pixels(height(mean)), Pixels(right));
            is_broken = false;
        }
        (band, line)
    }
}

impl Past {
    /// From its lowest to its highest value, with some room around them.
    fn axis(&self) -> (ValueRange, Ticks) {
        let values = || self.windows.iter().flatten().flatten().copied().filter(|value| value.is_finite());
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if low > high {
            return (ValueRange { low: 0.0, high: 1.0 }, Ticks::default());
        }
        let range = ValueRange::around(low, high);
        (range, Ticks::within(range, TICKS.1, Numbers::Real))
    }
}

fn draw_heading(document: &mut Document, area: Area, past: &Past, exponent: i32) {
    let baseline_px = area.top_px - 8;
    let name = format!("{}{}", past.signal, caption::in_unit(past.unit.as_deref(), exponent));
    let name = shortened(&name, NAME_PX, area.width_px);
    document.text("text", &[("x", &area.left_px), ("y", &baseline_px), ("font-size", &NAME_PX)], &name);
}

/// The time axis of all panels, in a unit that suits its length.
struct TimeAxis {
    unit: &'static str,
    range: ValueRange,
    ticks: Ticks,
}

impl TimeAxis {
    fn x(&self, area: Area, value: f64) -> Pixels {
        Pixels(area.x_cpx(self.range.fraction(value)))
    }

    /// Draws the labels and the name beneath the last panel.
    fn draw(&self, document: &mut Document, area: Area) {
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"middle")]);
        for mark in &self.ticks.marks {
            document.text("text", &[("x", &self.x(area, mark.value)), ("y", &(area.bottom_px() + 16))], &mark.label);
        }
        document.close();
        let (middle_px, baseline_px) = (area.left_px + area.width_px / 2, area.bottom_px() + 36);
        let attributes: [super::svg::Attribute<'_>; 4] =
            [("x", &middle_px), ("y", &baseline_px), ("font-size", &NAME_PX), ("text-anchor", &"middle")];
        document.text("text", &attributes, &format!("time{}", caption::in_unit(Some(self.unit), self.ticks.exponent)));
    }
}
