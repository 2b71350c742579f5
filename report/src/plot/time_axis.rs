//! The time axis that all panels share.

use super::caption;
use super::lettering::{NAME_PX, TICK_PX};
use super::palette::FAINT_INK;
use super::range::TimeRange;
use super::svg::{Document, Pixels};
use super::ticks::{Numbers, Ticks};
use super::trace::Area;

/// About how many ticks an axis has, and one of two beside each other.
const TICKS: [u32; 2] = [10, 4];

/// Times and the marks among them.
#[derive(Debug)]
pub(super) struct TimeAxis {
    pub(super) range: TimeRange,
    ticks: Ticks,
}

impl TimeAxis {
    /// The axis of these times, over the whole width of the picture.
    pub(super) fn of(range: TimeRange) -> Self {
        Self { range, ticks: Ticks::within(range.seconds(), TICKS[0], Numbers::Real) }
    }

    /// The same where two columns share the width.
    pub(super) fn of_column(range: TimeRange) -> Self {
        Self { range, ticks: Ticks::within(range.seconds(), TICKS[1], Numbers::Real) }
    }

    /// Where the marks lie in a panel.
    pub(super) fn positions(&self, area: Area) -> impl Iterator<Item = Pixels> {
        let seconds = self.range.seconds();
        self.ticks.marks.iter().map(move |mark| Pixels(area.x_cpx(seconds.fraction(mark.value))))
    }

    /// Draws the labels and the name beneath the last panel.
    pub(super) fn draw(&self, document: &mut Document, area: Area) {
        self.draw_labels(document, area);
        let (middle_px, baseline_px) = (area.left_px + area.width_px / 2, area.bottom_px() + 36);
        document.text(
            "text",
            &[("x", &middle_px), ("y", &baseline_px), ("font-size", &NAME_PX), ("text-anchor", &"middle")],
            &caption::time(self.ticks.exponent),
        );
    }

    /// Draws the labels beneath a panel.
    pub(super) fn draw_labels(&self, document: &mut Document, area: Area) {
        document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"middle")]);
        for (mark, x) in self.ticks.marks.iter().zip(self.positions(area)) {
            document.text("text", &[("x", &x), ("y", &(area.bottom_px() + 16))], &mark.label);
        }
        document.close();
    }
}
