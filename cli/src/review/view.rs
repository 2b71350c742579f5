//! A pending snapshot on a terminal.

use std::fmt::Write as _;

use onescan_server::time::VirtualTime;

use super::{Waiting, chart};
use crate::snapshot::{Difference, Track};

/// So many signals are drawn; the page has all of them.
const SIGNALS_MAX: usize = 8;
/// A wider terminal shows no more.
const WIDTH_MAX: usize = 120;

/// The snapshot as text: what differs in words, then each of these signals drawn; all of a new one.
pub fn text(waiting: &Waiting, width: usize, colours: bool) -> String {
    let width = width.clamp(40, WIDTH_MAX);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(waiting, width, colours, &mut text);
    text
}

fn write(waiting: &Waiting, width: usize, colours: bool, text: &mut String) -> std::fmt::Result {
    let bold = |words: &str| if colours { format!("\u{1b}[1m{words}\u{1b}[0m") } else { words.to_owned() };
    writeln!(text, "{}", bold(&format!("{} {}", waiting.status(), waiting.name())))?;
    for difference in &waiting.differences {
        writeln!(text, "  {difference}")?;
    }
    let names = differing(waiting);
    for name in names.iter().take(SIGNALS_MAX) {
        let of = |tracks: &'_ [Track]| tracks.iter().find(|track| track.name == *name).cloned();
        let (old, new) = (waiting.old.as_ref().and_then(|old| of(&old.signals)), of(&waiting.new.signals));
        let Some(any) = new.as_ref().or(old.as_ref()) else { continue };
        writeln!(text, "\n{}", bold(&any.heading()))?;
        for line in chart::lines(old.as_ref(), new.as_ref(), end(waiting), width) {
            writeln!(text, "{}", painted(&line, colours))?;
        }
    }
    if names.len() > SIGNALS_MAX {
        writeln!(text, "\n... and {} more signals: see --html", names.len() - SIGNALS_MAX)?;
    }
    writeln!(text, "{}\n", axis(end(waiting), width))
}

/// The later end of the two.
fn end(waiting: &Waiting) -> VirtualTime {
    waiting.old.as_ref().map_or(waiting.new.end, |old| old.end.max(waiting.new.end))
}

/// The signals to draw.
pub(super) fn differing(waiting: &Waiting) -> Vec<String> {
    if waiting.old.is_none() {
        return waiting.new.signals.iter().map(|track| track.name.clone()).collect();
    }
    let names = waiting.differences.iter().map(|difference| match difference {
        Difference::Frame { of, .. } => of.clone(),
        Difference::Gone { signal }
        | Difference::Added { signal }
        | Difference::Values { signal, .. }
        | Difference::Between { signal, .. } => signal.clone(),
    });
    names.collect()
}

fn axis(end: VirtualTime, width: usize) -> String {
    let right = end.to_string();
    let room = width.saturating_sub(18 + 3 + 1);
    format!("{:18}0 s{right:>room$}", "")
}

/// Old lines dim, new ones green, differences red.
fn painted(line: &str, colours: bool) -> String {
    let code = match line.split_whitespace().next() {
        _ if !colours => return line.to_owned(),
        Some("differs") => "31",
        Some("new") if line.starts_with("new - old") => "31",
        Some("new") => "32",
        Some("old") => "2",
        _ => return line.to_owned(),
    };
    format!("\u{1b}[{code}m{line}\u{1b}[0m")
}
