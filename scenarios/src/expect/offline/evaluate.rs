//! A formula over a trace: its worth at every sample.

use super::trace::Trace;
use super::window::{Span, joined};
use crate::expect::formula::{Arithmetic, Edge, Formula, Term, TermKind, Window};
use crate::expect::truth::Scale;

/// What the formula is worth at each sample of the trace.
pub(super) fn evaluate<S: Scale>(formula: &Formula<usize>, trace: &Trace) -> Vec<S> {
    let worth = |formula: &Formula<usize>| evaluate::<S>(formula, trace);
    match formula {
        Formula::Constant(value) => vec![S::of_bool(*value); trace.len()],
        Formula::Signal(column) => trace.column(*column).iter().map(|value| S::of_bool(*value != 0.0)).collect(),
        Formula::Compare(comparison, left, right) => {
            pairwise(&numbers(left, trace), &numbers(right, trace), |a, b| S::of_comparison(*comparison, a, b))
        }
        Formula::Not(inner) => worth(inner).into_iter().map(S::not).collect(),
        Formula::And(left, right) => pairwise(&worth(left), &worth(right), S::and),
        Formula::Or(left, right) => pairwise(&worth(left), &worth(right), S::or),
        Formula::Implies(left, right) => pairwise(&worth(left), &worth(right), |a, b| a.not().or(b)),
        Formula::Iff(left, right) => pairwise(&worth(left), &worth(right), |a, b| a.and(b).or(a.not().and(b.not()))),
        Formula::Always(window, inner) => all(&worth(inner), &window.ahead(trace)),
        Formula::Eventually(window, inner) => any(&worth(inner), &window.ahead(trace)),
        Formula::Historically(window, inner) => all(&worth(inner), &window.back(trace)),
        Formula::Once(window, inner) => any(&worth(inner), &window.back(trace)),
        Formula::Until(window, left, right) => until(*window, &worth(left), &worth(right), trace),
        Formula::Since(window, left, right) => since(*window, &worth(left), &worth(right), trace),
        Formula::Edge(edge, inner) => edges(*edge, &worth(inner)),
    }
}

fn pairwise<T: Copy, S>(left: &[T], right: &[T], join: impl Fn(T, T) -> S) -> Vec<S> {
    left.iter().zip(right).map(|(left, right)| join(*left, *right)).collect()
}

fn all<S: Scale>(values: &[S], spans: &[Span]) -> Vec<S> {
    with_open_ends(joined(values, spans, S::and, S::TOP), spans, S::and)
}

fn any<S: Scale>(values: &[S], spans: &[Span]) -> Vec<S> {
    with_open_ends(joined(values, spans, S::or, S::BOTTOM), spans, S::or)
}

/// What a window would show beyond the end of the run is unknown.
fn with_open_ends<S: Scale>(mut values: Vec<S>, spans: &[Span], join: fn(S, S) -> S) -> Vec<S> {
    for (value, span) in values.iter_mut().zip(spans) {
        if span.open {
            *value = join(*value, S::UNKNOWN);
        }
    }
    values
}

/// The right one somewhere in the window, the left one at every sample before: by way of the until
/// without a window, from where the window begins (Donzé, Ferrère, Maler, CAV 2013, lemma 2).
fn until<S: Scale>(window: Window, left: &[S], right: &[S], trace: &Trace) -> Vec<S> {
    let spans = window.ahead(trace);
    let beyond = if window.to_ns.is_some() || trace.is_cut() { S::UNKNOWN } else { S::BOTTOM };
    let mut whole = vec![beyond; trace.len() + 1];
    for index in (0..trace.len()).rev() {
        whole[index] = right[index].or(left[index].and(whole[index + 1]));
    }
    let last = trace.len().saturating_sub(1);
    let lead: Vec<Span> = spans
        .iter()
        .enumerate()
        .map(|(index, span)| Span { first: index, end: span.first.min(last), open: false })
        .collect();
    let held = joined(left, &lead, S::and, S::TOP);
    let reached = any(right, &spans);
    let at = |(index, span): (usize, &Span)| {
        // Where the run ends before the window begins, its last value may be the one that holds there.
        let held = if span.first > last { held[index].and(left[last].or(right[last])) } else { held[index] };
        held.and(whole[span.first]).and(reached[index])
    };
    spans.iter().enumerate().map(at).collect()
}

/// The mirror image of [`until`]; before the start there is nothing.
fn since<S: Scale>(window: Window, left: &[S], right: &[S], trace: &Trace) -> Vec<S> {
    let spans = window.back(trace);
    let mut whole: Vec<S> = Vec::with_capacity(trace.len());
    for (left, right) in left.iter().zip(right) {
        let before = whole.last().copied().unwrap_or(S::BOTTOM);
        whole.push(right.or(left.and(before)));
    }
    let tail: Vec<Span> =
        spans.iter().enumerate().map(|(index, span)| Span { first: span.end, end: index + 1, open: false }).collect();
    let held = joined(left, &tail, S::and, S::TOP);
    let reached = any(right, &spans);
    let at = |(index, span): (usize, &Span)| match span.end.checked_sub(1) {
        Some(last) => held[index].and(whole[last]).and(reached[index]),
        None => S::BOTTOM,
    };
    spans.iter().enumerate().map(at).collect()
}

fn edges<S: Scale>(edge: Edge, values: &[S]) -> Vec<S> {
    let mut found = Vec::with_capacity(values.len());
    let mut before: Option<S> = None;
    for value in values {
        let worth = before.map_or(S::BOTTOM, |before| {
            let (rose, fell) = (before.not().and(*value), before.and(value.not()));
            match edge {
                Edge::Rose => rose,
                Edge::Fell => fell,
                Edge::Changed => rose.or(fell),
            }
        });
        found.push(worth);
        before = Some(*value);
    }
    found
}

/// The term at each sample.
fn numbers(term: &Term<usize>, trace: &Trace) -> Vec<f64> {
    let each = |inner: &Term<usize>, change: fn(f64) -> f64| numbers(inner, trace).into_iter().map(change).collect();
    match &term.kind {
        TermKind::Number(value, _) => vec![*value; trace.len()],
        TermKind::Signal(column) => trace.column(*column).to_vec(),
        TermKind::Negate(inner) => each(inner, |value| -value),
        TermKind::Abs(inner) => each(inner, f64::abs),
        TermKind::Rate(inner) => rate(&numbers(inner, trace), trace.times_ns()),
        TermKind::Scaled(inner, times, by) => {
            numbers(inner, trace).into_iter().map(|value| value * times / by).collect()
        }
        TermKind::Binary(operator, left, right) => {
            let operation: fn(f64, f64) -> f64 = match operator {
                Arithmetic::Add => |a, b| a + b,
                Arithmetic::Subtract => |a, b| a - b,
                Arithmetic::Multiply => |a, b| a * b,
                Arithmetic::Divide => |a, b| a / b,
                Arithmetic::Min => f64::min,
                Arithmetic::Max => f64::max,
            };
            pairwise(&numbers(left, trace), &numbers(right, trace), operation)
        }
    }
}

/// The change per second since the sample before.
fn rate(values: &[f64], times_ns: &[u64]) -> Vec<f64> {
    let mut found = vec![0.0; values.len().min(1)];
    for (values, times_ns) in values.windows(2).zip(times_ns.windows(2)) {
        if let ([before, now], [before_ns, now_ns]) = (values, times_ns) {
            found.push((now - before) * 1e9 / (now_ns - before_ns) as f64);
        }
    }
    found
}
