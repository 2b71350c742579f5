//! The colours of the picture, and one stroke for each run.
//!
//! The colours are those of Okabe and Ito (Color Universal Design, 2008), which stay apart for
//! readers who see fewer colours; their yellow is left out, as it vanishes on
//! white, and their black is a grey, as it would outshine all others.
//!
//! Runs are drawn in order. An earlier one is a little wider than a later one, so that an edge of
//! it remains where they meet. Runs that are equal are one line.
//!
//! Elements carry their colours for a light page as attributes, which every viewer understands. A
//! style replaces each by its partner where the reader prefers dark pages.

use std::fmt::Write as _;

/// The ground, solid, so that the picture reads the same on any page.
pub const GROUND: &str = "#ffffff";
/// Texts that name something.
pub const INK: &str = "#1f2328";
/// Texts beside the point.
pub const FAINT_INK: &str = "#59636e";
/// Lines across a panel.
pub(super) const GRID: &str = "#e4e7eb";
pub const ALARM: &str = "#b3261e";
/// The edges of a panel from which values and times are read.
pub const AXIS: &str = "#a8b0b9";

/// What each colour of a light page is on a dark one.
const DARK: [(&str, &str); 13] = [
    (GROUND, "#0d1117"),
    (INK, "#e6edf3"),
    (FAINT_INK, "#9198a1"),
    (GRID, "#262c36"),
    (ALARM, "#ff7b72"),
    (AXIS, "#545d68"),
    (COLOURS[0], "#4ba3e3"),
    (COLOURS[1], "#f0b429"),
    (COLOURS[2], "#2fbf95"),
    (COLOURS[3], "#f0712c"),
    (COLOURS[4], "#8fd0f7"),
    (COLOURS[5], "#e09cc0"),
    (COLOURS[6], "#a6a6a6"),
];

/// Neighbours differ in lightness, too.
pub(super) const COLOURS: [&str; 7] = ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#6e6e6e"];
/// The width of the last run's line, in hundredths of a pixel.
const WIDTH_CPX: i64 = 130;
/// How much wider a line is for each later run, and how much wider all of them make it.
const PER_RUN_CPX: (i64, i64) = (25, 130);

/// How the line of a run looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stroke {
    pub(super) colour: &'static str,
    pub(super) width_cpx: i64,
    /// The SVG dash pattern of runs for which there is no further colour.
    pub(super) dashes: Option<&'static str>,
}

/// The stroke of one run among `count`.
pub(super) fn stroke(run: usize, count: usize) -> Stroke {
    let (each_cpx, all_cpx) = PER_RUN_CPX;
    let (others, after) = (count.saturating_sub(1).max(1), count.saturating_sub(run.saturating_add(1)));
    let extra_cpx =
        (length(after).saturating_mul(all_cpx) / length(others)).min(length(after).saturating_mul(each_cpx));
    Stroke {
        colour: COLOURS[run % COLOURS.len()],
        width_cpx: WIDTH_CPX + extra_cpx,
        dashes: (run / COLOURS.len() % 2 == 1).then_some("7 4"),
    }
}

/// The style that turns a picture dark where the reader prefers that.
pub(super) fn dark_style() -> String {
    let mut style = "@media (prefers-color-scheme: dark) {".to_owned();
    for (light, dark) in DARK {
        let _ = write!(style, " [fill=\\{light}]{{fill:{dark}}} [stroke=\\{light}]{{stroke:{dark}}}");
    }
    style.push_str(" }");
    style
}

fn length(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_earlier_run_is_wider() {
        assert_eq!([0, 1, 2, 3, 4, 5].map(|run| stroke(run, 6).width_cpx), [255, 230, 205, 180, 155, 130]);
        assert_eq!(stroke(0, 1).width_cpx, 130);
        assert!(stroke(0, 1000).width_cpx <= 260);
    }

    #[test]
    fn every_colour_has_a_dark_partner() {
        let style = dark_style();
        for colour in [GROUND, INK, FAINT_INK, GRID, ALARM, AXIS].into_iter().chain(COLOURS) {
            assert!(style.contains(&format!("[stroke=\\{colour}]")), "{colour}");
        }
    }
}
