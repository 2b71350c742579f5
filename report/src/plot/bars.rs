//! Parts of a whole as bars, one beneath the other, each with its name and its number.

use super::layout::WIDTH_PX;
use super::lettering::{NAME_PX, TICK_PX, shortened, width_px};
use super::palette::{COLOURS, FAINT_INK, GRID};
use super::svg::{Document, draw_note};

const MARGIN_PX: i64 = 16;
const TOP_PX: i64 = 40;
const ROW_PX: i64 = 28;
const BAR_PX: i64 = 18;
const GAP_PX: i64 = 8;
/// The room of a name at most.
const NAME_MAX_PX: i64 = 260;

/// The fill of bars.
pub(super) const FILL: &str = COLOURS[0];
/// The fill of bars that are beside the point.
const FAINT_FILL: &str = COLOURS[6];

/// Bars, one beneath the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    pub title: String,
    /// From top to bottom.
    pub bars: Vec<Bar>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// What it stands for.
    pub name: String,
    /// How long it is, as a part of the longest; what is not finite or below 0 has no length.
    pub value: f64,
    /// What stands behind it: the value with its unit.
    pub label: String,
    /// True for one that is beside the point; it is grey.
    pub is_faint: bool,
}

impl Bars {
    /// The picture as an SVG document: the same bars, the same bytes.
    pub fn to_svg(&self) -> String {
        let rows = i64::try_from(self.bars.len()).unwrap_or(i64::MAX / ROW_PX / 2).max(1);
        let widest = |texts: &mut dyn Iterator<Item = i64>| texts.max().unwrap_or(0);
        let name_px = widest(&mut self.bars.iter().map(|bar| width_px(&bar.name, NAME_PX))).min(NAME_MAX_PX);
        let label_px = widest(&mut self.bars.iter().map(|bar| width_px(&bar.label, TICK_PX)));
        let left_px = MARGIN_PX + name_px + GAP_PX;
        let room_px = (WIDTH_PX - left_px - GAP_PX - label_px - MARGIN_PX).max(GAP_PX);
        let height_px = TOP_PX + rows * ROW_PX + MARGIN_PX;
        let described: Vec<String> = self.bars.iter().map(|bar| format!("{}: {}", bar.name, bar.label)).collect();
        let mut document = Document::picture(WIDTH_PX, height_px, &self.title, &described.join("; "));
        let heading = [("x", &MARGIN_PX as &dyn std::fmt::Display), ("y", &(TOP_PX - 16)), ("font-size", &NAME_PX)];
        document.text("text", &heading, &self.title);
        if self.bars.is_empty() {
            draw_note(&mut document, WIDTH_PX / 2, TOP_PX + ROW_PX / 2, "nothing");
            return document.finish();
        }
        let axis = format!("M{left_px} {TOP_PX}v{}", rows * ROW_PX);
        document.empty("path", &[("d", &axis), ("stroke", &GRID), ("fill", &"none")]);
        let longest = self.bars.iter().map(Bar::length).fold(0.0, f64::max);
        for (row, bar) in (0..).zip(&self.bars) {
            let middle_px = TOP_PX + row * ROW_PX + ROW_PX / 2;
            let length_px = if longest > 0.0 { (room_px as f64 * bar.length() / longest).round() as i64 } else { 0 };
            bar.draw(&mut document, (left_px, middle_px, length_px));
        }
        document.finish()
    }
}

impl Bar {
    fn length(&self) -> f64 {
        if self.value.is_finite() { self.value.max(0.0) } else { 0.0 }
    }

    fn draw(&self, document: &mut Document, (left_px, middle_px, length_px): (i64, i64, i64)) {
        let baseline_px = middle_px + 4;
        let name = shortened(&self.name, NAME_PX, left_px - MARGIN_PX - GAP_PX);
        document.open("g", &[("font-size", &NAME_PX), ("text-anchor", &"end")]);
        document.text("text", &[("x", &(left_px - GAP_PX)), ("y", &baseline_px)], &name);
        document.close();
        // A short one can still be seen; none is none.
        let length_px = if self.length() > 0.0 { length_px.max(1) } else { 0 };
        let fill = if self.is_faint { FAINT_FILL } else { FILL };
        if length_px > 0 {
            let top_px = middle_px - BAR_PX / 2;
            document.empty(
                "rect",
                &[("x", &left_px), ("y", &top_px), ("width", &length_px), ("height", &BAR_PX), ("fill", &fill)],
            );
        }
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK)]);
        document.text("text", &[("x", &(left_px + length_px + GAP_PX)), ("y", &baseline_px)], &self.label);
        document.close();
    }
}
