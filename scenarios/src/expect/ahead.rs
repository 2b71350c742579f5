//! Operators on the future: what is said of a sample when its window has been seen.

use std::collections::VecDeque;

use super::formula::Window;
use super::sample::{Certain, Demand, Judged, Sample, TraceEnd};
use super::sliding::{All, Any, Joined, Pursuit, Sliding};
use super::truth::{Scale, Worth};

/// What an operator says of a window.
pub(super) trait Foresight: Joined {
    /// `lead` is what lies between the sample and its window, `passed` when the window has.
    fn say(lead: Self, seen: Self, open: bool, here: Certain, passed: Certain) -> (Worth, Certain);

    /// The last sample of a run that ends before the window begins: its value may be the one that holds there.
    fn at_the_end(self) -> Self {
        self
    }
}

impl Foresight for All {
    fn say(_: Self, seen: Self, open: bool, here: Certain, _: Certain) -> (Worth, Certain) {
        (if open { seen.worth.and(Worth::UNKNOWN) } else { seen.worth }, seen.broken.unwrap_or(here))
    }
}

impl Foresight for Any {
    fn say(_: Self, seen: Self, open: bool, _: Certain, passed: Certain) -> (Worth, Certain) {
        let certain = seen.last.map_or(passed, |last| last.max(passed));
        (if open { seen.worth.or(Worth::UNKNOWN) } else { seen.worth }, certain)
    }
}

impl Foresight for Pursuit {
    /// What comes may still reach it, as long as the left one has held.
    fn say(lead: Self, seen: Self, open: bool, _: Certain, passed: Certain) -> (Worth, Certain) {
        let reached = lead.held.and(seen.reached);
        let hope = if open { lead.held.and(seen.held).and(Worth::UNKNOWN) } else { Worth::BOTTOM };
        (reached.or(hope), lead.then(seen).broken.unwrap_or(passed))
    }

    /// Before the window only the left one counts, in it the right one does, too.
    fn at_the_end(mut self) -> Self {
        self.held = self.held.or(self.reached);
        self
    }
}

/// A window ahead of each sample, or of the first one only. The value that holds where it begins is in it.
#[derive(Clone, Debug)]
pub(super) struct Ahead<J> {
    window: Window,
    demand: Demand,
    /// Samples of which nothing has been said yet.
    waiting: VecDeque<Sample>,
    /// What lies between the first of them and its window.
    lead: Sliding<J>,
    seen: Sliding<J>,
    newest: Option<Sample>,
}

impl<J: Foresight> Ahead<J> {
    pub(super) fn new(window: Window, demand: Demand) -> Self {
        let mut lead = Sliding::new();
        if demand == Demand::First {
            lead.grow_only();
        }
        Self { window, demand, waiting: VecDeque::new(), lead, seen: Sliding::new(), newest: None }
    }

    fn end_ns(&self, sample: Sample) -> u64 {
        self.window.to_ns.map_or(u64::MAX, |to_ns| sample.t_ns.saturating_add(to_ns))
    }

    /// When the window of the one sample that is asked for begins and ends; `next` is the sample that comes next. Equal samples may then be left
    /// out, except the first and the last ones and those at these ends: joining is idempotent, what breaks first comes first,
    /// and what is last is last.
    pub(super) fn ends(&self, next: Option<Sample>) -> Option<[u64; 2]> {
        let first = if self.newest.is_none() { next } else { self.waiting.front().copied() };
        let first = first.filter(|_| self.demand == Demand::First)?;
        Some([first.t_ns.saturating_add(self.window.from_ns), self.end_ns(first)])
    }

    /// Takes what is known of the next sample, and says what follows from it of earlier ones.
    pub(super) fn push(&mut self, sample: Sample, member: J, out: &mut VecDeque<Judged>) {
        // A window that ended before this sample must not see it; one that ends with it must.
        self.say_until(|end_ns| end_ns < sample.t_ns, out);
        if self.demand == Demand::Every || self.newest.is_none() {
            self.waiting.push_back(sample);
        }
        self.newest = Some(sample);
        self.take(sample, member);
        self.say_until(|end_ns| end_ns == sample.t_ns, out);
    }

    /// If only the first sample is asked for, what is in its window need not be kept apart.
    fn take(&mut self, sample: Sample, member: J) {
        if self.demand == Demand::First
            && let Some(first) = self.waiting.front().copied()
        {
            let from_ns = first.t_ns.saturating_add(self.window.from_ns);
            if sample.t_ns > from_ns {
                self.seen.grow_only();
            } else if let Some((passed, before)) = self.seen.pop() {
                self.lead.push(passed, before);
            }
        }
        self.seen.push(sample, member);
    }

    fn say_until(&mut self, has_passed: impl Fn(u64) -> bool, out: &mut VecDeque<Judged>) {
        while let Some(sample) = self.waiting.front().copied().filter(|sample| has_passed(self.end_ns(*sample))) {
            self.slide(sample, false);
            out.push_back(self.say(sample, false, self.end_ns(sample)));
            self.waiting.pop_front();
        }
    }

    /// What is said of all others when the run is over.
    pub(super) fn finish(&mut self, end: TraceEnd, out: &mut VecDeque<Judged>) {
        let open = self.window.to_ns.is_some() || end == TraceEnd::Cut;
        while let Some(sample) = self.waiting.pop_front() {
            let last = self.newest.unwrap_or(sample);
            self.slide(sample, true);
            out.push_back(self.say(sample, open, last.t_ns));
        }
    }

    /// At `at_ns` its window has passed, or the run is over.
    fn say(&self, sample: Sample, open: bool, at_ns: u64) -> Judged {
        let passed = Certain { at_ns, sample: self.newest.unwrap_or(sample).number };
        let (worth, certain) = J::say(self.lead.all(), self.seen.all(), open, Certain::at(sample), passed);
        Judged { sample, worth, certain }
    }

    /// Moves the windows on to those of a sample; `over` when nothing more comes.
    fn slide(&mut self, sample: Sample, over: bool) {
        let from_ns = sample.t_ns.saturating_add(self.window.from_ns);
        // The value that holds where the window begins is in it: the member before its beginning stays.
        while self.seen.at(1).is_some_and(|second| second.t_ns <= from_ns) {
            self.step();
        }
        // Its window begins behind the end of the run: only the last sample is left.
        if over
            && self.newest.is_none_or(|newest| newest.t_ns < from_ns)
            && let Some((last, member)) = self.seen.pop()
        {
            self.lead.push(last, member.at_the_end());
        }
        while self.lead.at(0).is_some_and(|first| first.number < sample.number) {
            self.lead.pop();
        }
    }

    fn step(&mut self) {
        if let Some((sample, member)) = self.seen.pop() {
            self.lead.push(sample, member);
        }
    }

    /// The number of the first sample that it keeps, and which others it may report.
    pub(super) fn keeps(&self, others: &mut Vec<u64>) -> u64 {
        match self.demand {
            Demand::First => {
                let kept = [self.lead.all().certain(), self.seen.all().certain()];
                others.extend(kept.into_iter().flatten().map(|certain| certain.sample));
                u64::MAX
            }
            Demand::Every => {
                let kept = [self.waiting.front().copied(), self.lead.at(0), self.seen.at(0)];
                kept.into_iter().flatten().map(|sample| sample.number).min().unwrap_or(u64::MAX)
            }
        }
    }
}

#[cfg(test)]
impl<J: Foresight> Ahead<J> {
    pub(super) fn held(&self) -> usize {
        self.waiting.len() + self.lead.len() + self.seen.len()
    }
}
