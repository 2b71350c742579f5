//! The words of a picture: names, units, and a description for readers who do not see it.

use super::agreement::Agreement;
use super::range::{TimeRange, ValueRange};
use super::ticks::power_of_ten;
use super::{Panel, Plot};

/// The labels of all runs that the legend or a panel has.
pub(super) fn run_labels(plot: &Plot) -> Vec<String> {
    let count = plot.panels.iter().map(|panel| panel.runs.len()).max().unwrap_or(0).max(plot.runs.len());
    (0..count).map(|run| plot.runs.get(run).cloned().unwrap_or_else(|| format!("run {}", run + 1))).collect()
}

/// What a line is that stands for several runs, which are equal.
pub(super) fn together(runs: &[&str]) -> String {
    match runs {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [one, other] => format!("{one} and {other}, equal"),
        [first, .., last] => format!("{first} to {last}, {} equal runs", runs.len()),
    }
}

/// The name of a signal and its unit.
pub(super) fn heading(panel: &Panel, exponent: i32) -> String {
    format!("{}{}", panel.signal, in_unit(panel.unit.as_deref(), exponent))
}

/// What the time axis shows.
pub(super) fn time(exponent: i32) -> String {
    format!("time{}", in_unit(Some("s"), exponent))
}

/// What the picture shows: each panel, and how far its runs agree; and which part of it is enlarged.
pub(super) fn description<'p>(
    times: TimeRange,
    enlarged: Option<TimeRange>,
    panels: impl Iterator<Item = (&'p Panel, &'p Agreement)>,
    run_labels: &[String],
) -> String {
    let signal = |(panel, agreement): (&Panel, &Agreement)| {
        let remark = agreement.remark().map_or_else(String::new, |remark| format!(": {remark}"));
        format!("{}{remark}", heading(panel, 0))
    };
    let signals: Vec<String> = panels.map(signal).collect();
    let over = |times: TimeRange| format!("from {} s to {} s", times.seconds().low, times.seconds().high);
    let beside = enlarged.map_or_else(String::new, |part| format!(" Enlarged beside them: {}.", over(part)));
    let (signals, runs) = (listed(&signals), listed(run_labels));
    format!("Signals over time {}. Signals: {signals}. Runs: {runs}.{beside}", over(times))
}

/// What a picture of paths shows, and which part of it is enlarged: across and up.
pub(super) fn of_plane(up: &str, along: &str, run_labels: &[String], enlarged: Option<[ValueRange; 2]>) -> String {
    let part = |[x, y]: [ValueRange; 2]| {
        format!(" Enlarged beside them: from {} to {} across, from {} to {} up.", x.low, x.high, y.low, y.high)
    };
    format!("{up} over {along}. Runs: {}.{}", listed(run_labels), enlarged.map_or_else(String::new, part))
}

/// A unit and a power of ten in parentheses, if there is one of them.
pub(super) fn in_unit(unit: Option<&str>, exponent: i32) -> String {
    match (unit, exponent) {
        (None, 0) => String::new(),
        (Some(unit), 0) => format!(" ({unit})"),
        (None, exponent) => format!(" (\u{d7}{})", power_of_ten(exponent)),
        (Some(unit), exponent) => format!(" ({} {unit})", power_of_ten(exponent)),
    }
}

/// The words with commas between them, or "none".
fn listed(words: &[String]) -> String {
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_ten_stands_before_the_unit() {
        assert_eq!(in_unit(Some("m"), -3), " (10\u{207b}\u{b3} m)");
        assert_eq!(in_unit(None, 6), " (\u{d7}10\u{2076})");
        assert_eq!(time(0), "time (s)");
    }
}
