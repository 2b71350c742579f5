//! A table of values as a map: a colour for each, over the places of its columns and rows.
//!
//! The colours go from dark blue over grey to yellow and become lighter all along, so they can be read in order by those
//! who see fewer colours, and on paper. Where cells are smaller than a pixel, the greatest of them is seen: a hot spot of
//! one cell does not vanish.

use std::fmt::Write as _;

use serde::Serialize;

use super::layout::WIDTH_PX;
use super::lettering::{NAME_PX, TICK_PX, TITLE_PX};
use super::palette::{AXIS, FAINT_INK};
use super::range::ValueRange;
use super::svg::{Document, draw_note};
use super::ticks::{Numbers, Ticks};

const LEFT_PX: i64 = 64;
const TOP_PX: i64 = 52;
const MAP_WIDTH_PX: i64 = 700;
const MAP_HEIGHT_PX: i64 = 320;
const SCALE_GAP_PX: i64 = 24;
const SCALE_PX: i64 = 16;
const BOTTOM_PX: i64 = 56;
/// Colours of the scale.
const LEVELS: usize = 24;
/// Of the scale, from the least value to the greatest, as red, green and blue. Each is lighter than the one before.
const ANCHORS: [[f64; 3]; 5] =
    [[10.0, 26.0, 82.0], [64.0, 80.0, 107.0], [123.0, 122.0, 120.0], [189.0, 174.0, 112.0], [254.0, 232.0, 66.0]];
/// Of a cell without a value: none of the scale's.
const NO_VALUE: &str = "#d9d9d9";

/// An axis of a map: where each of its cells begins, and where the last one ends.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapAxis {
    /// What it is, with its unit.
    pub name: String,
    /// One more than there are cells; in rising order.
    pub edges: Vec<f64>,
}

/// A table of values over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueMap {
    pub title: String,
    /// The unit of its values.
    pub unit: String,
    /// From left to right.
    pub across: MapAxis,
    /// From top to bottom.
    pub down: MapAxis,
    /// Row after row; what is not finite is not a value.
    pub values: Vec<f64>,
    /// The values of the scale's ends; from the least to the greatest of the map if absent.
    pub scale: Option<[f64; 2]>,
}

impl ValueMap {
    /// The picture as an SVG document: the same map, the same bytes.
    pub fn to_svg(&self) -> String {
        let height_px = TOP_PX + MAP_HEIGHT_PX + BOTTOM_PX;
        let (columns, rows) = (self.across.cells(), self.down.cells());
        let described = format!("{} by {} values in {}", columns, rows, self.unit);
        let mut document = Document::picture(WIDTH_PX, height_px, &self.title, &described);
        document.text("text", &[("x", &LEFT_PX), ("y", &30), ("font-size", &TITLE_PX)], &self.title);
        let finite = self.values.iter().copied().filter(|value| value.is_finite());
        let found = finite.fold(None, |range: Option<(f64, f64)>, value| {
            let (low, high) = range.unwrap_or((value, value));
            Some((low.min(value), high.max(value)))
        });
        let wanted = self.scale.map(|[low, high]| (low, high)).or(found);
        let is_whole = columns > 0 && rows > 0 && self.values.len() == columns * rows;
        let Some((low, high)) = wanted.filter(|_| is_whole) else {
            draw_note(&mut document, WIDTH_PX / 2, TOP_PX + MAP_HEIGHT_PX / 2, "nothing");
            return document.finish();
        };
        let range = ValueRange { low, high: if high > low { high } else { low + 1.0 } };
        self.draw_cells(&mut document, range);
        self.draw_axes(&mut document);
        draw_scale(&mut document, range, &self.unit);
        document.finish()
    }

    fn draw_cells(&self, document: &mut Document, range: ValueRange) {
        let (across, down) = (self.across.strips(MAP_WIDTH_PX), self.down.strips(MAP_HEIGHT_PX));
        let mut paths: Vec<String> = vec![String::new(); LEVELS + 1];
        for row in &down {
            let mut run: Option<(usize, i64, i64)> = None;
            let mut close = |run: Option<(usize, i64, i64)>| {
                if let Some((level, from, to)) = run {
                    let (x, y, high) = (LEFT_PX + from, TOP_PX + row.from_px, row.to_px - row.from_px);
                    // writing to a text cannot fail
                    let _ = write!(paths[level], "M{x} {y}h{}v{high}h-{}z", to - from, to - from);
                }
            };
            for column in &across {
                let level = self.level(column, row, range);
                run = match run {
                    Some((same, from, _)) if same == level => Some((level, from, column.to_px)),
                    before => {
                        close(before);
                        Some((level, column.from_px, column.to_px))
                    }
                };
            }
            close(run);
        }
        document.open("g", &[("shape-rendering", &"crispEdges")]);
        for (level, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
            let colour = if level == LEVELS { NO_VALUE.to_owned() } else { colour(level) };
            document.empty("path", &[("d", path), ("fill", &colour)]);
        }
        document.close();
    }

    /// The colour of the greatest value in a strip of columns and rows; the one behind the last if there is none.
    fn level(&self, column: &Strip, row: &Strip, range: ValueRange) -> usize {
        let columns = self.across.cells();
        let in_row =
            |row: usize| (column.from..column.to).filter_map(move |column| self.values.get(row * columns + column));
        let values = (row.from..row.to).flat_map(in_row).copied().filter(|value| value.is_finite());
        values.reduce(f64::max).map_or(LEVELS, |value| {
            let part = (value - range.low) / (range.high - range.low);
            ((part * LEVELS as f64) as usize).min(LEVELS - 1)
        })
    }

    fn draw_axes(&self, document: &mut Document) {
        let frame = format!("M{LEFT_PX} {TOP_PX}v{MAP_HEIGHT_PX}h{MAP_WIDTH_PX}");
        document.empty("path", &[("d", &frame), ("stroke", &AXIS), ("fill", &"none")]);
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"middle")]);
        for (at_px, label) in self.across.ticks(MAP_WIDTH_PX, 10) {
            document.text("text", &[("x", &(LEFT_PX + at_px)), ("y", &(TOP_PX + MAP_HEIGHT_PX + 16))], &label);
        }
        document.close();
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"end")]);
        for (at_px, label) in self.down.ticks(MAP_HEIGHT_PX, 6) {
            document.text("text", &[("x", &(LEFT_PX - 6)), ("y", &(TOP_PX + at_px + 4))], &label);
        }
        document.close();
        document.open("g", &[("font-size", &NAME_PX)]);
        document.text("text", &[("x", &LEFT_PX), ("y", &(TOP_PX - 8))], &format!("{} \u{2193}", self.down.name));
        let below = TOP_PX + MAP_HEIGHT_PX + 38;
        document.text("text", &[("x", &LEFT_PX), ("y", &below)], &format!("{} \u{2192}", self.across.name));
        document.close();
    }

    /// The map as text with commas: the middles of the columns, then each row behind its middle.
    pub fn to_csv(&self) -> String {
        let mut text = format!("{}\\{}", self.down.name.replace(',', ";"), self.across.name.replace(',', ";"));
        for column in self.across.middles() {
            let _ = write!(text, ",{column:.4}");
        }
        text.push('\n');
        for (row, values) in self.down.middles().zip(self.values.chunks(self.across.cells().max(1))) {
            let _ = write!(text, "{row:.4}");
            for value in values {
                let _ = write!(text, ",{value:.4}");
            }
            text.push('\n');
        }
        text
    }
}

/// Cells of an axis that share a stretch of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Strip {
    from_px: i64,
    to_px: i64,
    from: usize,
    to: usize,
}

impl MapAxis {
    /// Cells that are evenly wide.
    pub fn even(name: &str, from: f64, to: f64, cells: usize) -> Self {
        let edge = |index: usize| from + (to - from) * index as f64 / cells.max(1) as f64;
        Self { name: name.to_owned(), edges: (0..=cells).map(edge).collect() }
    }

    fn cells(&self) -> usize {
        self.edges.len().saturating_sub(1)
    }

    fn middles(&self) -> impl Iterator<Item = f64> {
        self.edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]))
    }

    fn ends(&self) -> ValueRange {
        let (low, high) = (self.edges.first().copied().unwrap_or(0.0), self.edges.last().copied().unwrap_or(1.0));
        ValueRange { low, high: if high > low { high } else { low + 1.0 } }
    }

    fn at_px(&self, value: f64, length_px: i64) -> i64 {
        let ValueRange { low, high } = self.ends();
        (((value - low) / (high - low)).clamp(0.0, 1.0) * length_px as f64).round() as i64
    }

    /// The cells, or, where they are smaller than a pixel, the pixels.
    fn strips(&self, length_px: i64) -> Vec<Strip> {
        let mut strips: Vec<Strip> = Vec::new();
        for (index, pair) in self.edges.windows(2).enumerate() {
            let [from_px, to_px] = [pair[0], pair[1]].map(|edge| self.at_px(edge, length_px));
            match strips.last_mut() {
                Some(last) if to_px <= last.to_px => last.to = index + 1,
                _ => {
                    let from_px = strips.last().map_or(from_px, |last| last.to_px);
                    if to_px > from_px {
                        strips.push(Strip { from_px, to_px, from: index, to: index + 1 });
                    }
                }
            }
        }
        strips
    }

    fn ticks(&self, length_px: i64, count: u32) -> Vec<(i64, String)> {
        let ticks = Ticks::within(self.ends(), count, Numbers::Real);
        ticks.marks.into_iter().map(|tick| (self.at_px(tick.value, length_px), tick.label)).collect()
    }
}

fn draw_scale(document: &mut Document, range: ValueRange, unit: &str) {
    let left_px = LEFT_PX + MAP_WIDTH_PX + SCALE_GAP_PX;
    let edge_px = |level: usize| TOP_PX + MAP_HEIGHT_PX - MAP_HEIGHT_PX * level as i64 / LEVELS as i64;
    for level in 0..LEVELS {
        let (top, bottom) = (edge_px(level + 1), edge_px(level));
        document.empty(
            "rect",
            &[
                ("x", &left_px),
                ("y", &top),
                ("width", &SCALE_PX),
                ("height", &(bottom - top)),
                ("fill", &colour(level)),
            ],
        );
    }
    document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK)]);
    for tick in Ticks::within(range, 6, Numbers::Real).marks {
        let part = (tick.value - range.low) / (range.high - range.low);
        let at_px = TOP_PX + MAP_HEIGHT_PX - (part * MAP_HEIGHT_PX as f64).round() as i64;
        document.text("text", &[("x", &(left_px + SCALE_PX + 5)), ("y", &(at_px + 4))], &tick.label);
    }
    document.close();
    document.text("text", &[("x", &left_px), ("y", &(TOP_PX - 8)), ("font-size", &NAME_PX)], unit);
}

/// The colours of the scale, from the least value to the greatest.
pub fn colours() -> impl Iterator<Item = String> {
    (0..LEVELS).map(colour)
}

/// The colour of a level of the scale.
fn colour(level: usize) -> String {
    let place = (level as f64 + 0.5) / LEVELS as f64 * (ANCHORS.len() - 1) as f64;
    let left = (place as usize).min(ANCHORS.len() - 2);
    let part = place - left as f64;
    let mixed = |index: usize| (ANCHORS[left][index] * (1.0 - part) + ANCHORS[left + 1][index] * part).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mixed(0), mixed(1), mixed(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> ValueMap {
        let mut values = vec![100.0; 200 * 2000];
        values[1234 * 200 + 77] = 300.0;
        (0..20).for_each(|row| values[row * 200 + 5] = f64::NAN);
        ValueMap {
            title: "Shell".to_owned(),
            unit: "°C".to_owned(),
            across: MapAxis::even("position (m)", 0.0, 60.0, 200),
            down: MapAxis::even("angle (°)", 0.0, 360.0, 2000),
            values,
            scale: None,
        }
    }

    #[test]
    fn a_spot_of_one_cell_in_a_large_map_is_seen() {
        let svg = map().to_svg();
        assert!(svg.contains(&colour(LEVELS - 1)) && svg.contains(&colour(0)) && svg.contains(NO_VALUE), "{svg}");
        assert!(svg.len() < 20_000, "equal cells are one: {}", svg.len());
        assert_eq!(svg, map().to_svg());
    }

    #[test]
    fn each_colour_is_lighter_than_the_one_before() {
        let light = |level| {
            let colour = colour(level);
            let part = |at: usize| f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap());
            0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
        };
        assert!((1..LEVELS).all(|level| light(level) > light(level - 1) + 2.0));
    }

    #[test]
    fn what_is_not_a_map_is_a_picture_of_nothing() {
        let empty = ValueMap { values: Vec::new(), ..map() };
        assert!(empty.to_svg().contains("nothing"));
        let none = MapAxis { name: String::new(), edges: Vec::new() };
        assert!(ValueMap { across: none, ..map() }.to_svg().contains("nothing"));
        let values = vec![f64::NAN; 400_000];
        assert!(ValueMap { values, ..map() }.to_svg().contains("nothing"));
    }

    #[test]
    fn a_map_as_text_has_the_middles_of_its_cells() {
        let map = ValueMap {
            across: MapAxis::even("x", 0.0, 2.0, 2),
            down: MapAxis::even("y", 0.0, 1.0, 1),
            values: vec![1.0, 2.5],
            ..map()
        };
        assert_eq!(map.to_csv(), "y\\x,0.5000,1.5000\n0.5000,1.0000,2.5000\n");
    }
}
