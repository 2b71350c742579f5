//! When it became certain that a formula is false, found by looking at the whole trace.

use onescan_server::time::VirtualTime;

use super::evaluate::evaluate;
use super::trace::Trace;
use crate::expect::bind::Expectation;
use crate::expect::formula::{Formula, Window};
use crate::expect::truth::{Margin, Scale, Truth};
use crate::expect::verdict::{Outcome, Verdict};

impl Expectation {
    /// What the trace says. Without a sample nothing is decided.
    pub(in crate::expect) fn judge_offline(&self, trace: &Trace) -> Outcome {
        let margin = evaluate::<Margin>(self.formula(), trace).first().copied().unwrap_or(Margin::UNKNOWN);
        let verdict = match evaluate::<Truth>(self.formula(), trace).first() {
            Some(Truth::True) => Verdict::Met,
            Some(Truth::False) => self.violated(trace),
            Some(Truth::Unknown) | None => Verdict::Open,
        };
        Outcome { verdict, margin }
    }

    fn violated(&self, trace: &Trace) -> Verdict {
        let Certain { sample, at_ns } = certain(self.formula(), trace, 0);
        let value =
            |(name, column): &(String, usize)| trace.column(*column).get(sample).map(|value| (name.clone(), *value));
        let values = self.signals().iter().filter_map(value).collect();
        Verdict::Violated { at: VirtualTime::from_nanos(at_ns), values }
    }
}

/// When it became certain that a formula is false.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Certain {
    /// The instant, which may lie between two samples: the end of a window does.
    at_ns: u64,
    /// The sample whose values held then.
    sample: usize,
}

impl Certain {
    fn at(trace: &Trace, sample: usize) -> Self {
        Self { at_ns: trace.times_ns().get(sample).copied().unwrap_or(0), sample }
    }

    /// When a window from `sample` has passed; at the end of the run if it reaches further.
    fn after(window: Window, trace: &Trace, sample: usize) -> Self {
        let last = trace.len().saturating_sub(1);
        let now_ns = Self::at(trace, sample).at_ns;
        let to_ns = window.to_ns.map_or(u64::MAX, |to_ns| now_ns.saturating_add(to_ns));
        let at_ns = to_ns.min(trace.end_ns());
        Self { at_ns, sample: trace.samples_until(at_ns).saturating_sub(1).min(last) }
    }
}

/// When it became certain that a formula is false at `sample`, which it is. What follows from an implication is
/// reported at the time of its cause.
fn certain(formula: &Formula<usize>, trace: &Trace, sample: usize) -> Certain {
    let truths = |formula: &Formula<usize>| evaluate::<Truth>(formula, trace);
    let seen = |window: Window| window.ahead(trace).get(sample).map_or(0..0, |span| span.first..span.end);
    let is_false = |truths: &[Truth], index: usize| truths.get(index) == Some(&Truth::False);
    let here = Certain::at(trace, sample);
    match formula {
        Formula::And(left, right) => {
            let false_ones = [left, right].into_iter().filter(|each| is_false(&truths(each), sample));
            false_ones.map(|each| certain(each, trace, sample)).min().unwrap_or(here)
        }
        Formula::Or(left, right) => certain(left, trace, sample).max(certain(right, trace, sample)),
        Formula::Always(window, inner) => {
            let truths = truths(inner);
            let first = seen(*window).find(|index| is_false(&truths, *index));
            first.map_or(here, |first| certain(inner, trace, first))
        }
        Formula::Eventually(window, inner) => {
            let passed = Certain::after(*window, trace, sample);
            let last = seen(*window).last().map(|last| certain(inner, trace, last));
            last.map_or(passed, |last| last.max(passed))
        }
        Formula::Until(window, left, right) => {
            let (held, reached) = (truths(left), truths(right));
            let mut until_then = (sample..seen(*window).end).take_while(|index| is_false(&reached, *index));
            let broken = until_then.find(|index| is_false(&held, *index));
            broken.map_or(Certain::after(*window, trace, sample), |broken| certain(left, trace, broken))
        }
        Formula::Constant(_)
        | Formula::Signal(_)
        | Formula::Compare(..)
        | Formula::Not(_)
        | Formula::Implies(..)
        | Formula::Iff(..)
        | Formula::Historically(..)
        | Formula::Once(..)
        | Formula::Since(..)
        | Formula::Edge(..) => here,
    }
}
