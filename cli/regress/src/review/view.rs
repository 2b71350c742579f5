//! A pending snapshot on a terminal.

use std::fmt::Write as _;

use onescan_server::time::VirtualTime;

use super::chart::Window;
use super::{Waiting, chart};
use crate::snapshot::Track;
use crate::snapshot::overlay::differing;

/// So many signals are drawn; the page has all of them.
const SIGNALS_MAX: usize = 8;
/// A wider terminal shows no more.
const WIDTH_MAX: usize = 120;
/// A narrower one is not drawn for.
const WIDTH_MIN: usize = 40;

/// The snapshot as text: what differs in words, then each of these signals drawn; all of a new one.
pub fn text(waiting: &Waiting, width: usize, colours: bool) -> String {
    let width = width.clamp(WIDTH_MIN, WIDTH_MAX);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(waiting, width, colours, &mut text);
    text
}

fn write(waiting: &Waiting, width: usize, colours: bool, text: &mut String) -> std::fmt::Result {
    writeln!(text, "{}", bold(&format!("{} {}", waiting.status(), waiting.name()), colours))?;
    if let Some(note) = &waiting.note {
        writeln!(text, "  {note}")?;
    }
    for difference in &waiting.differences {
        writeln!(text, "  {difference}")?;
    }
    let names = differing(waiting.old.as_ref(), &waiting.new, &waiting.differences);
    for name in names.iter().take(SIGNALS_MAX) {
        for line in block(waiting, name, Window::whole(end(waiting)), width, colours) {
            writeln!(text, "{line}")?;
        }
    }
    if names.len() > SIGNALS_MAX {
        writeln!(text, "\n... and {} more signals: see --html", names.len() - SIGNALS_MAX)?;
    }
    writeln!(text, "{}\n", axis(Window::whole(end(waiting)), width))
}

pub(super) fn bold(words: &str, colours: bool) -> String {
    if colours { format!("\u{1b}[1m{words}\u{1b}[0m") } else { words.to_owned() }
}

/// A signal as it was and as it is: an empty line, its name, and the rows in which it is drawn.
pub(super) fn block(waiting: &Waiting, name: &str, window: Window, width: usize, colours: bool) -> Vec<String> {
    let of = |tracks: &'_ [Track]| tracks.iter().find(|track| track.name == name).cloned();
    let (old, new) = (waiting.old.as_ref().and_then(|old| of(&old.signals)), of(&waiting.new.signals));
    let Some(any) = new.as_ref().or(old.as_ref()) else { return Vec::new() };
    let width = width.clamp(WIDTH_MIN, WIDTH_MAX);
    let drawn = chart::lines(old.as_ref(), new.as_ref(), window, width);
    let mut lines = vec![String::new(), bold(&any.heading(), colours)];
    lines.extend(drawn.iter().map(|line| painted(line, colours)));
    lines
}

/// The later end of the two.
pub(super) fn end(waiting: &Waiting) -> VirtualTime {
    waiting.old.as_ref().map_or(waiting.new.end, |old| old.end.max(waiting.new.end))
}

pub(super) fn axis(window: Window, width: usize) -> String {
    let left = if window.from == VirtualTime::ZERO { "0 s".to_owned() } else { window.from.to_string() };
    let right = window.to.to_string();
    let room = width.clamp(WIDTH_MIN, WIDTH_MAX).saturating_sub(18 + left.chars().count() + 1);
    format!("{:18}{left}{right:>room$}", "")
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
