//! Instants that stand out: a line through all panels, with a number above the first of them and a text beneath the
//! legend. So the text of a mark never lies on a curve.

use std::fmt::Write as _;

use super::lettering::{TICK_PX, shortened};
use super::palette::ALARM;
use super::range::TimeRange;
use super::svg::{Document, Pixels};
use super::trace::Area;
use super::{Mark, Plot};

/// From one text to the next.
pub(super) const TEXT_ROW_PX: i64 = 16;
/// The room of the numbers above the first panel.
pub(super) const NUMBERS_PX: i64 = 14;
/// So many marks have a text.
const TEXTS_MAX: usize = 12;
/// Marks that are closer than this part of the time axis share a place for their numbers.
const NEAR: f64 = 0.03;

/// The marks of a plot that lie within its times, in the order of time.
#[derive(Debug)]
pub(super) struct Marks {
    times: TimeRange,
    /// The number and the instant of each.
    numbered: Vec<(usize, u64)>,
    instants_ns: Vec<u64>,
    /// The instant above which a number stands, and the first and the last number there.
    numbers: Vec<(u64, usize, usize)>,
    /// What the numbers stand for.
    pub(super) texts: Vec<String>,
}

impl Marks {
    /// The marks of a plot.
    pub(super) fn of(plot: &Plot, times: TimeRange) -> Self {
        let within = |mark: &&Mark| (times.start_ns..=times.end_ns).contains(&mark.t_ns);
        let mut shown: Vec<&Mark> = plot.marks.iter().filter(within).collect();
        shown.sort_by_key(|mark| mark.t_ns);
        let text =
            |(number, mark): (usize, &&Mark)| format!("({number}) {} at {} s", mark.label, mark.t_ns as f64 / 1e9);
        let mut texts: Vec<String> = (1..).zip(&shown).take(TEXTS_MAX).map(text).collect();
        if let Some(more @ 1..) = shown.len().checked_sub(TEXTS_MAX) {
            texts.push(format!("... and {more} more"));
        }
        Self { texts, ..Self::at(times, (1..).zip(shown.iter().map(|mark| mark.t_ns)).collect()) }
    }

    /// Those of them that lie within a part of the times, with the same numbers and without texts.
    pub(super) fn within(&self, times: TimeRange) -> Self {
        let within = |(_, t_ns): &&(usize, u64)| (times.start_ns..=times.end_ns).contains(t_ns);
        Self::at(times, self.numbered.iter().filter(within).copied().collect())
    }

    /// Marks in the order of time.
    fn at(times: TimeRange, numbered: Vec<(usize, u64)>) -> Self {
        let mut instants_ns: Vec<u64> = numbered.iter().map(|(_, t_ns)| *t_ns).collect();
        instants_ns.dedup();
        let mut numbers: Vec<(u64, usize, usize)> = Vec::new();
        for (number, t_ns) in &numbered {
            match numbers.last_mut() {
                Some((at_ns, _, last)) if times.fraction(*t_ns) - times.fraction(*at_ns) < NEAR => *last = *number,
                _ => numbers.push((*t_ns, *number, *number)),
            }
        }
        Self { times, numbered, instants_ns, numbers, texts: Vec::new() }
    }

    /// Draws the lines through all panels, the numbers above the first, and the texts.
    pub(super) fn draw(&self, document: &mut Document, panels: &[Area], texts: Area) {
        let Some(first) = panels.first().filter(|_| !self.instants_ns.is_empty()) else { return };
        let mut lines = String::new();
        for (t_ns, area) in self.instants_ns.iter().flat_map(|t_ns| panels.iter().map(move |area| (t_ns, area))) {
            let _ = write!(lines, "M{} {}v{}", self.x(*area, *t_ns), area.top_px, area.height_px);
        }
        document.empty("path", &[("d", &lines), ("stroke", &ALARM), ("stroke-dasharray", &"4 3")]);
        document.open("g", &[("font-size", &TICK_PX), ("fill", &ALARM)]);
        for (t_ns, from, to) in &self.numbers {
            let number = if from == to { from.to_string() } else { format!("{from}\u{2013}{to}") };
            let place = (self.x(*first, *t_ns), first.top_px - 3);
            document.text("text", &[("x", &place.0), ("y", &place.1), ("text-anchor", &"middle")], &number);
        }
        for (row, text) in (0..).zip(&self.texts) {
            let baseline_px = texts.top_px + row * TEXT_ROW_PX + 11;
            let text = shortened(text, TICK_PX, texts.width_px);
            document.text("text", &[("x", &texts.left_px), ("y", &baseline_px)], &text);
        }
        document.close();
    }

    fn x(&self, area: Area, t_ns: u64) -> Pixels {
        Pixels(area.x_cpx(self.times.fraction(t_ns)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(t_ns: &[u64]) -> Marks {
        let mark = |&t_ns: &u64| Mark { t_ns, label: "x".to_owned() };
        let marks = t_ns.iter().map(mark).collect();
        let plot = Plot { title: String::new(), runs: Vec::new(), panels: Vec::new(), marks };
        Marks::of(&plot, TimeRange { start_ns: 0, end_ns: 1000 })
    }

    #[test]
    fn close_marks_share_a_place_and_are_all_described() {
        let marks = marks(&[500, 10, 510, 500, 2000]);
        assert_eq!(marks.numbers, [(10, 1, 1), (500, 2, 4)]);
        assert_eq!(marks.instants_ns, [10, 500, 510]);
        assert_eq!(marks.texts.len(), 4);
    }

    #[test]
    fn many_marks_are_counted() {
        let many: Vec<u64> = (0..40).collect();
        assert_eq!(marks(&many).texts.last().map(String::as_str), Some("... and 28 more"));
    }
}
