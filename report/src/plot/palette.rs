//! The colours of the picture, and one stroke for each run.
//!
//! The colours are those of Okabe and Ito (Color Universal Design, 2008), which stay apart for
//! readers who see fewer colours; their yellow is left out, as it vanishes on
//! white, and their black is a grey, as it would outshine all others.
//!
//! Runs are drawn in order. An earlier one is a little wider than a later one, so that an edge of
//! it remains where they meet; and much wider than a later one that is identical with it, so that
//! equal runs are one line with a visible stack of layers.

/// The ground, solid, so that the picture reads the same on any page.
pub const GROUND: &str = "#ffffff";
/// Texts that name something.
pub const INK: &str = "#1f2328";
/// Texts beside the point.
pub const FAINT_INK: &str = "#59636e";
/// Lines across a panel.
pub(super) const GRID: &str = "#e4e7eb";
/// What went wrong.
pub const ALARM: &str = "#b3261e";
/// The edges of a panel from which values and times are read.
pub const AXIS: &str = "#a8b0b9";

/// Neighbours differ in lightness, too.
const COLOURS: [&str; 7] = ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#6e6e6e"];
/// The width of the last run's line, in hundredths of a pixel.
const WIDTH_CPX: i64 = 130;
/// How much wider a line is for each later run, and how much wider all of them make it.
const PER_RUN_CPX: (i64, i64) = (25, 130);
/// How much wider a line is for each later run that is identical, and how much wider all make it.
const PER_EQUAL_CPX: (i64, i64) = (85, 430);

/// How the line of a run looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stroke {
    pub(super) colour: &'static str,
    pub(super) width_cpx: i64,
    /// The SVG dash pattern of runs for which there is no further colour.
    pub(super) dashes: Option<&'static str>,
}

/// The stroke of one run among `count`, of which `equals_after` later ones are identical with it.
pub(super) fn stroke(run: usize, count: usize, equals_after: usize) -> Stroke {
    let extra_cpx = |(each_cpx, all_cpx): (i64, i64), later: usize| {
        let others = length(count.saturating_sub(1)).max(1);
        (length(later).saturating_mul(all_cpx) / others).min(length(later).saturating_mul(each_cpx))
    };
    let runs_after = count.saturating_sub(run.saturating_add(1));
    Stroke {
        colour: COLOURS[run % COLOURS.len()],
        width_cpx: WIDTH_CPX + extra_cpx(PER_RUN_CPX, runs_after) + extra_cpx(PER_EQUAL_CPX, equals_after),
        dashes: (run / COLOURS.len() % 2 == 1).then_some("7 4"),
    }
}

fn length(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_runs_are_a_stack_and_different_ones_are_thin() {
        let width = |run: usize, equals_after| stroke(run, 6, equals_after).width_cpx;
        assert_eq!([0, 1, 2, 3, 4, 5].map(|run| width(run, 5 - run)), [680, 570, 460, 350, 240, 130]);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|run| width(run, 0)), [255, 230, 205, 180, 155, 130]);
        assert_eq!(stroke(0, 1, 0).width_cpx, 130);
        assert!(stroke(0, 12, 11).width_cpx < 700);
    }
}
