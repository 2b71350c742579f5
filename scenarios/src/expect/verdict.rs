//! What a run says to an expectation.

use onescan_server::time::VirtualTime;

use super::bind::Expectation;
use super::evaluate::evaluate;
use super::formula::Formula;
use super::trace::Trace;
use super::truth::{Margin, Scale, Truth};

/// What came of an expectation.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Whether it was met.
    pub verdict: Verdict,
    /// By how much, as far as the run tells.
    pub margin: Margin,
}

/// Whether an expectation was met.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It holds, whatever would have come next.
    Met,
    /// The run ended before it could be decided.
    Open,
    /// It does not hold.
    Violated {
        /// The first sample at which it failed.
        at: VirtualTime,
        /// What its signals were then, by name.
        values: Vec<(String, f64)>,
    },
}

impl Expectation {
    /// What the trace says. Without a sample nothing is decided.
    pub fn judge(&self, trace: &Trace) -> Outcome {
        let margin = evaluate::<Margin>(self.formula(), trace).first().copied().unwrap_or(Margin::UNKNOWN);
        let verdict = match evaluate::<Truth>(self.formula(), trace).first() {
            Some(Truth::True) => Verdict::Met,
            Some(Truth::False) => self.violated(trace),
            Some(Truth::Unknown) | None => Verdict::Open,
        };
        Outcome { verdict, margin }
    }

    fn violated(&self, trace: &Trace) -> Verdict {
        let sample = culprit(self.formula(), trace, 0);
        let value =
            |(name, column): &(String, usize)| trace.column(*column).get(sample).map(|value| (name.clone(), *value));
        let at = trace.times_ns().get(sample).copied().unwrap_or(0);
        Verdict::Violated { at: VirtualTime::from_nanos(at), values: self.signals().iter().filter_map(value).collect() }
    }
}

/// The sample that makes a formula false which is false at `sample`: the first one that an `always`
/// forbids. What follows from an implication is told at the time of its cause.
fn culprit(formula: &Formula<usize>, trace: &Trace, sample: usize) -> usize {
    let is_false = |formula: &Formula<usize>| evaluate::<Truth>(formula, trace).get(sample) == Some(&Truth::False);
    match formula {
        Formula::And(left, right) => {
            let samples = [left, right].map(|each| is_false(each).then(|| culprit(each, trace, sample)));
            samples.into_iter().flatten().min().unwrap_or(sample)
        }
        Formula::Always(window, inner) => {
            let truths = evaluate::<Truth>(inner, trace);
            let span = window.ahead(trace).get(sample).copied();
            let mut seen = span.map_or(0..0, |span| span.first..span.end);
            let first = seen.find(|index| truths.get(*index) == Some(&Truth::False));
            first.map_or(sample, |first| culprit(inner, trace, first))
        }
        _ => sample,
    }
}
