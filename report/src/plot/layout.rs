//! Where everything goes, in pixels.
//!
//! From top to bottom: the title, the legend in as many rows as it takes, the texts of marks, then each panel beneath
//! its heading, and the time axis beneath the last one. Where a picture is so tall that this axis is out of reach,
//! its labels are also beneath panels in between. What is enlarged has a column of its own beside the panels.

use super::lettering::{NAME_PX, TICK_PX, shortened, width_px};
use super::mark::{NUMBERS_PX, TEXT_ROW_PX};
use super::trace::Area;

/// The width of every picture: that of a README's column.
pub(super) const WIDTH_PX: i64 = 880;
/// The length of a line in the legend.
pub(super) const LEGEND_LINE_PX: i64 = 26;
/// Between a line in the legend and its label, and between a tick's label and its panel.
pub(super) const LABEL_GAP_PX: i64 = 8;
/// Between the panels and the labels of what is enlarged beside them.
const BESIDE_GAP_PX: i64 = 16;
/// From the edge of the picture to whatever is closest to it.
const MARGIN_PX: i64 = 16;
const LABEL_ROOM_MIN_PX: i64 = 40;
const TITLE_ROOM_PX: i64 = 26;
const LEGEND_ROW_PX: i64 = 20;
const LEGEND_GAP_PX: i64 = 20;
const LEGEND_ROOM_BELOW_PX: i64 = 4;
const HEADING_ROOM_PX: i64 = 22;
const ANALOG_HEIGHT_PX: i64 = 128;
const BOOL_HEIGHT_PX: i64 = 34;
const PANEL_GAP_PX: i64 = 12;
const TIME_AXIS_ROOM_PX: i64 = 40;
const TIME_LABELS_ROOM_PX: i64 = 14;
/// The labels of the time axis come again after this much of panels.
const TIME_LABELS_EVERY_PX: i64 = 520;

/// How high a panel is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Height {
    /// Room to read values off.
    Analog,
    /// Room for two levels.
    Bool,
    Plane(i64),
}

/// One entry of the legend: where it begins, and its label as far as it fits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct LegendEntry {
    pub(super) left_px: i64,
    pub(super) middle_px: i64,
    pub(super) label: String,
}

/// The places of a picture's parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) height_px: i64,
    pub(super) title_baseline_px: i64,
    pub(super) legend: Vec<LegendEntry>,
    /// Where the texts of marks go.
    pub(super) texts: Area,
    pub(super) panels: Vec<Area>,
    /// Where what is enlarged goes, if something is.
    pub(super) beside: Option<Column>,
    /// The panels before the last one that have the labels of the time axis beneath them.
    pub(super) time_labels: Vec<Area>,
}

/// A column of panels beside the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Column {
    left_px: i64,
    width_px: i64,
}

impl Column {
    /// The place in this column beside another one.
    pub(super) fn next_to(self, area: Area) -> Area {
        Area { left_px: self.left_px, width_px: self.width_px, ..area }
    }
}

/// What a layout has to find room for.
#[derive(Debug)]
pub(super) struct Contents<'a> {
    pub(super) title: &'a str,
    /// What the lines of the legend are.
    pub(super) run_labels: &'a [String],
    /// How many texts of marks there are.
    pub(super) texts: usize,
    /// The widest label of a value.
    pub(super) value_label_px: i64,
    /// The widest label of a value in what is enlarged, if something is.
    pub(super) beside_label_px: Option<i64>,
    pub(super) panels: &'a [Height],
}

impl Layout {
    /// Places the contents from top to bottom.
    pub(super) fn of(contents: &Contents<'_>) -> Self {
        let label_room = |label_px: i64| (label_px + LABEL_GAP_PX).clamp(LABEL_ROOM_MIN_PX, WIDTH_PX / 4);
        let left_px = MARGIN_PX + label_room(contents.value_label_px);
        let room_px = WIDTH_PX - MARGIN_PX - width_px("0000", TICK_PX) / 2 - left_px;
        let (width_px, beside) = match contents.beside_label_px {
            None => (room_px, None),
            Some(label_px) => {
                let gap_px = BESIDE_GAP_PX + label_room(label_px);
                let width_px = (room_px - gap_px) / 2;
                (width_px, Some(Column { left_px: left_px + width_px + gap_px, width_px }))
            }
        };

        let mut top_px = MARGIN_PX;
        let title_baseline_px = top_px + 14;
        if !contents.title.is_empty() {
            top_px += TITLE_ROOM_PX;
        }
        let (legend, legend_height_px) = legend(contents.run_labels, left_px, room_px, top_px);
        top_px += legend_height_px + LEGEND_ROOM_BELOW_PX;

        let texts_px = contents.texts as i64 * TEXT_ROW_PX;
        let texts = Area { left_px, top_px, width_px: room_px, height_px: texts_px };
        if texts_px > 0 {
            top_px += texts_px + NUMBERS_PX;
        }

        let (mut panels, mut time_labels) = (Vec::new(), Vec::new());
        let mut labels_at_px = top_px;
        for height in contents.panels {
            let height_px = match height {
                Height::Analog => ANALOG_HEIGHT_PX,
                Height::Bool => BOOL_HEIGHT_PX,
                Height::Plane(height_px) => *height_px,
            };
            panels.push(Area { left_px, top_px: top_px + HEADING_ROOM_PX, width_px, height_px });
            top_px += HEADING_ROOM_PX + height_px + PANEL_GAP_PX;
            if let (Some(area), true) = (panels.last(), top_px - labels_at_px > TIME_LABELS_EVERY_PX) {
                labels_at_px = top_px;
                time_labels.push(*area);
                top_px += TIME_LABELS_ROOM_PX;
            }
        }
        // The last panel has the whole axis.
        if time_labels.last().is_some_and(|area| panels.last() == Some(area)) {
            time_labels.pop();
            top_px -= TIME_LABELS_ROOM_PX;
        }
        let height_px = top_px + TIME_AXIS_ROOM_PX;
        Self { height_px, title_baseline_px, legend, texts, panels, beside, time_labels }
    }

    /// The left edge of all panels.
    pub(super) fn left_px(&self) -> i64 {
        self.panels.first().map_or(MARGIN_PX, |panel| panel.left_px)
    }
}

/// The entries of the legend in columns of equal width, and the height of all rows.
fn legend(labels: &[String], left_px: i64, room_px: i64, top_px: i64) -> (Vec<LegendEntry>, i64) {
    let fixed_px = LEGEND_LINE_PX + LABEL_GAP_PX;
    let labels: Vec<String> = labels.iter().map(|label| shortened(label, NAME_PX, room_px - fixed_px)).collect();
    let widest_px = labels.iter().map(|label| width_px(label, NAME_PX)).max().unwrap_or(0);
    let column_px = fixed_px + widest_px + LEGEND_GAP_PX;
    let columns = ((room_px + LEGEND_GAP_PX) / column_px).max(1);
    let rows = (labels.len() as i64 + columns - 1) / columns;
    let entry = |(place, label): (i64, String)| LegendEntry {
        left_px: left_px + place % columns * column_px,
        middle_px: top_px + place / columns * LEGEND_ROW_PX + LEGEND_ROW_PX / 2,
        label,
    };
    ((0..).zip(labels).map(entry).collect(), rows * LEGEND_ROW_PX)
}
