//! A review on a terminal, without the terminal: which snapshot is shown, which part of it, and what has been decided.

use console::Key;
use onescan_server::time::VirtualTime;

use super::chart::Window;
use super::view::{axis, block, bold, end};
use super::{Decision, Waiting};
use crate::snapshot::Difference;
use crate::snapshot::overlay::differing;

/// At most so many differences are listed in words; all of them are drawn.
const DIFFERENCES_MAX: usize = 4;
/// A window is not made shorter than so many steps.
const STEPS_MIN: u64 = 10;

const HELP: &[&str] = &[
    "a  accept it          n, s  next           space, PgDn  signals after these",
    "r  reject it          b     the one before PgUp         signals before these",
    "u  undecided again    q     done: do what was decided",
    "                      Esc   leave and change nothing",
    "+  zoom in, on the first difference        left, right  earlier, later",
    "-  zoom out                                0            the whole run",
];

/// Whether a review goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Go {
    /// The next key is awaited.
    On,
    /// It ends, and the decisions are carried out.
    Over,
    /// It ends, and nothing changes.
    Away,
}

/// The state of a review.
#[derive(Debug)]
pub(super) struct ReviewQueue<'w> {
    waiting: &'w [Waiting],
    decisions: Vec<Decision>,
    at: usize,
    /// The first signal that is shown, and the one after the last.
    signals: (usize, usize),
    window: Window,
    helps: bool,
}

impl<'w> ReviewQueue<'w> {
    /// A review in which nothing is decided.
    pub(super) fn new(waiting: &'w [Waiting]) -> Self {
        let window = Window::whole(waiting.first().map_or(VirtualTime::ZERO, end));
        let decisions = vec![Decision::Skip; waiting.len()];
        Self { waiting, decisions, at: 0, signals: (0, 0), window, helps: false }
    }

    /// What was decided, in the order of the snapshots.
    pub(super) fn decisions(&self) -> &[Decision] {
        &self.decisions
    }

    /// What a key does.
    pub(super) fn press(&mut self, key: &Key) -> Go {
        if std::mem::take(&mut self.helps) {
            return Go::On;
        }
        match key {
            Key::Char('a' | 'A' | 'y') => return self.decide(Decision::Accept),
            Key::Char('r' | 'R') => return self.decide(Decision::Reject),
            Key::Char('u') => self.decisions[self.at] = Decision::Skip,
            Key::Char('s' | 'S' | 'n') | Key::Enter if self.at + 1 == self.waiting.len() => {}
            Key::Char('s' | 'S' | 'n') | Key::Enter => self.show(self.at + 1),
            Key::Char('b' | 'B') => self.show(self.at.saturating_sub(1)),
            Key::Char(' ') | Key::PageDown => self.signals.0 = self.signals.1,
            Key::PageUp => self.signals.0 = self.signals.0.saturating_sub(self.signals.1 - self.signals.0),
            Key::Char('+' | '=') => self.zoom_in(),
            Key::Char('-') => self.zoom_out(),
            Key::Char('0') => self.window = Window::whole(self.end()),
            Key::ArrowLeft => self.shift(false),
            Key::ArrowRight => self.shift(true),
            Key::Char('?' | 'h') => self.helps = true,
            Key::Char('q' | 'Q') => return Go::Over,
            Key::Escape | Key::CtrlC => return Go::Away,
            // A key without a meaning changes nothing, so that a slip of the finger does no harm.
            _ => {}
        }
        Go::On
    }

    /// Decides on what is shown, and goes on to what is not decided; over if that was the last.
    fn decide(&mut self, decision: Decision) -> Go {
        self.decisions[self.at] = decision;
        let count = self.waiting.len();
        let later = (self.at + 1..count).chain(0..self.at);
        match later.into_iter().find(|index| self.decisions[*index] == Decision::Skip) {
            Some(next) => self.show(next),
            None => return Go::Over,
        }
        Go::On
    }

    fn show(&mut self, at: usize) {
        self.at = at;
        self.signals = (0, 0);
        self.window = Window::whole(self.end());
    }

    fn end(&self) -> VirtualTime {
        end(&self.waiting[self.at])
    }

    fn zoom_in(&mut self) {
        let (from, to) = (self.window.from.as_nanos(), self.window.to.as_nanos());
        let first = self.waiting[self.at].differences.iter().filter(|one| matches!(one, Difference::Values { .. }));
        let first = first.map(Difference::at_ns).min().filter(|at_ns| (from..=to).contains(at_ns));
        let middle = first.unwrap_or(from + (to - from) / 2);
        let least = self.waiting[self.at].new.step.as_nanos().saturating_mul(STEPS_MIN);
        self.look(middle, ((to - from) / 2).max(least));
    }

    fn zoom_out(&mut self) {
        let (from, to) = (self.window.from.as_nanos(), self.window.to.as_nanos());
        self.look(from + (to - from) / 2, (to - from).saturating_mul(2));
    }

    fn shift(&mut self, later: bool) {
        let (from, to) = (self.window.from.as_nanos(), self.window.to.as_nanos());
        let (middle, quarter) = (from + (to - from) / 2, (to - from) / 4);
        self.look(if later { middle + quarter } else { middle.saturating_sub(quarter) }, to - from);
    }

    /// A window of this length around `middle`, as far as the run reaches.
    fn look(&mut self, middle_ns: u64, length_ns: u64) {
        let end_ns = self.end().as_nanos();
        let length_ns = length_ns.min(end_ns);
        let from_ns = middle_ns.saturating_sub(length_ns / 2).min(end_ns - length_ns);
        let at = VirtualTime::from_nanos;
        self.window = Window { from: at(from_ns), to: at(from_ns + length_ns) };
    }

    /// What a terminal of this size shows.
    pub(super) fn screen(&mut self, width: usize, rows: usize, colours: bool) -> Vec<String> {
        let one = &self.waiting[self.at];
        let mut lines = vec![bold(&format!("{} {}", one.status(), one.name()), colours)];
        if self.helps {
            lines.extend(HELP.iter().map(|line| (*line).to_owned()));
            lines.push("any key goes back".to_owned());
            return lines;
        }
        lines.extend(one.note.iter().map(|note| format!("  {note}")));
        lines.extend(one.differences.iter().take(DIFFERENCES_MAX).map(|difference| format!("  {difference}")));
        if let Some(more @ 1..) = one.differences.len().checked_sub(DIFFERENCES_MAX) {
            lines.push(format!("  ... and {more} more"));
        }
        let lines = lines.into_iter().map(|line| console::truncate_str(&line, width, "…").into_owned());
        let mut lines: Vec<String> = lines.collect();
        let names = differing(one.old.as_ref(), &one.new, &one.differences);
        // A page holds whole signals, and one at least.
        let first = self.signals.0.min(names.len().saturating_sub(1));
        let (mut shown, room) = (first, rows.saturating_sub(3));
        for name in &names[first..] {
            let block = block(one, name, self.window, width, colours);
            if shown > first && lines.len() + block.len() > room {
                break;
            }
            lines.extend(block);
            shown += 1;
        }
        self.signals = (first, shown);
        lines.push(axis(self.window, width));
        lines.push(console::truncate_str(&self.status(names.len()), width, "…").into_owned());
        lines
    }

    fn status(&self, signals: usize) -> String {
        let decided = match self.decisions[self.at] {
            Decision::Accept => ", accepted",
            Decision::Reject => ", rejected",
            Decision::Skip => "",
        };
        let (first, shown) = (self.signals.0 + 1, self.signals.1);
        format!(
            "[{}/{}{decided}] signals {first}-{shown} of {signals}  a accept  r reject  n next  b back  ? help  q done",
            self.at + 1,
            self.waiting.len()
        )
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use onescan_server::signal::SignalType;
    use onescan_server::time::TimeSpan;

    use super::*;
    use crate::snapshot::store::Place;
    use crate::snapshot::{Snapshot, Track, compare};

    /// A run of a second in which `count` signals rise at `rise_ms`.
    fn snapshot(count: usize, rise_ms: u64) -> Snapshot {
        let at = |ms: u64| VirtualTime::from_nanos(ms * 1_000_000);
        let track = |index: usize| Track {
            name: format!("S{index}"),
            ty: SignalType::BOOL,
            unit: None,
            sampled: None,
            changes: vec![(at(0), vec![0]), (at(rise_ms), vec![1])],
        };
        Snapshot {
            scenario: "cell".to_owned(),
            case: "default".to_owned(),
            step: TimeSpan::from_nanos(1_000_000).expect("a step"),
            end: at(1000),
            signals: (0..count).map(track).collect(),
        }
    }

    fn waiting(cases: &[&str]) -> Vec<Waiting> {
        let (old, new) = (snapshot(9, 700), snapshot(9, 710));
        let differences = compare(&old, &new, &BTreeMap::new());
        let one = |case: &&str| Waiting {
            place: Place { scenario: "cell".into(), case: (*case).to_owned() },
            old: Some(old.clone()),
            new: new.clone(),
            note: None,
            differences: differences.clone(),
        };
        cases.iter().map(one).collect()
    }

    fn typed(queue: &mut ReviewQueue<'_>, keys: &str) -> Go {
        keys.chars().map(|key| queue.press(&Key::Char(key))).last().unwrap_or(Go::On)
    }

    #[test]
    fn one_goes_back_and_decides_otherwise() {
        let all = waiting(&["a", "b", "c"]);
        let mut queue = ReviewQueue::new(&all);
        assert_eq!(typed(&mut queue, "arb"), Go::On);
        assert_eq!(typed(&mut queue, "ba"), Go::On);
        assert_eq!(queue.decisions(), [Decision::Accept, Decision::Reject, Decision::Skip]);
        assert_eq!(typed(&mut queue, "r"), Go::Over);
        assert_eq!(queue.decisions(), [Decision::Accept, Decision::Reject, Decision::Reject]);
        assert_eq!(ReviewQueue::new(&all).press(&Key::Escape), Go::Away);
    }

    #[test]
    fn signals_come_in_pages_that_fit() {
        let all = waiting(&["a"]);
        let mut queue = ReviewQueue::new(&all);
        let mut pages = Vec::new();
        loop {
            let screen = queue.screen(80, 24, false);
            assert!(screen.len() <= 24 && screen.iter().all(|line| line.chars().count() <= 80), "{screen:#?}");
            let shown = queue.signals;
            if pages.last() == Some(&shown) {
                break;
            }
            pages.push(shown);
            queue.press(&Key::PageDown);
        }
        assert!(pages.len() > 2 && pages.last().is_some_and(|(_, last)| *last == 9), "{pages:?}");
        queue.press(&Key::PageUp);
        assert!(queue.screen(80, 24, false).len() <= 24);
    }

    #[test]
    fn zooming_in_stays_at_the_first_difference() {
        let all = waiting(&["a"]);
        let mut queue = ReviewQueue::new(&all);
        for _ in 0..12 {
            queue.press(&Key::Char('+'));
        }
        let (from, to) = (queue.window.from.as_nanos(), queue.window.to.as_nanos());
        assert!((from..=to).contains(&700_000_000) && to - from == 10_000_000, "{from} to {to}");
        for key in [Key::ArrowRight, Key::ArrowRight, Key::ArrowLeft] {
            queue.press(&key);
        }
        for _ in 0..12 {
            queue.press(&Key::Char('-'));
        }
        assert_eq!(queue.window, Window::whole(all[0].new.end));
        insta::assert_snapshot!(queue.screen(80, 40, false).join("\n"));
    }

    #[test]
    fn help_goes_with_any_key() {
        let all = waiting(&["a"]);
        let mut queue = ReviewQueue::new(&all);
        typed(&mut queue, "?");
        assert!(queue.screen(80, 24, false).join("\n").contains("zoom in"));
        assert_eq!(typed(&mut queue, "a"), Go::On);
        assert_eq!(queue.decisions(), [Decision::Skip]);
    }
}
