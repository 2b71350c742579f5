//! Greatest and least values in windows of time.

use super::trace::Trace;
use crate::expect::formula::Window;

/// The samples that a window shows from one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) first: usize,
    /// The one behind the last.
    pub(super) end: usize,
    /// Whether the window reaches beyond the end of the run.
    pub(super) open: bool,
}

impl Window {
    /// From each sample on. The value that holds where the window begins is in it.
    pub(super) fn ahead(self, trace: &Trace) -> Vec<Span> {
        let (count, end_ns) = (trace.len(), trace.end_ns());
        let span = |t_ns: &u64| {
            let from_ns = t_ns.saturating_add(self.from_ns);
            let to_ns = self.to_ns.map(|to_ns| t_ns.saturating_add(to_ns));
            let open = to_ns.map_or(trace.is_cut(), |to_ns| to_ns > end_ns);
            if from_ns > end_ns {
                return Span { first: count, end: count, open };
            }
            let end = to_ns.map_or(count, |to_ns| trace.samples_until(to_ns));
            Span { first: trace.samples_until(from_ns).saturating_sub(1), end, open }
        };
        trace.times_ns().iter().map(span).collect()
    }

    /// Back from each sample, to the start at most.
    pub(super) fn back(self, trace: &Trace) -> Vec<Span> {
        let start_ns = trace.times_ns().first().copied().unwrap_or(0);
        let span = |t_ns: &u64| {
            let end = match t_ns.checked_sub(self.from_ns) {
                Some(last_ns) if last_ns >= start_ns => trace.samples_until(last_ns),
                _ => 0,
            };
            let first_ns = self.to_ns.and_then(|to_ns| t_ns.checked_sub(to_ns)).unwrap_or(0);
            let first = trace.samples_until(first_ns).saturating_sub(1).min(end);
            Span { first, end, open: false }
        };
        trace.times_ns().iter().map(span).collect()
    }
}

/// Joins the values of each span. Spans move forward only, so that a queue made of two stacks joins
/// every value at most three times, whatever the windows' length.
pub(super) fn joined<S: Copy>(values: &[S], spans: &[Span], join: fn(S, S) -> S, nothing: S) -> Vec<S> {
    let mut queue = Queue { join, nothing, leaving: Vec::new(), arrived: Vec::new(), arrived_all: nothing };
    let (mut first, mut end) = (0, 0);
    let mut found = Vec::with_capacity(spans.len());
    for span in spans {
        while end < span.end {
            queue.push(values[end]);
            end += 1;
        }
        while first < span.first.min(end) {
            queue.pop();
            first += 1;
        }
        found.push(if span.first < span.end { queue.all() } else { nothing });
    }
    found
}

struct Queue<S> {
    join: fn(S, S) -> S,
    nothing: S,
    /// Each value joined with those that leave after it; the next to leave at the end.
    leaving: Vec<S>,
    arrived: Vec<S>,
    arrived_all: S,
}

impl<S: Copy> Queue<S> {
    fn push(&mut self, value: S) {
        self.arrived.push(value);
        self.arrived_all = (self.join)(self.arrived_all, value);
    }

    fn pop(&mut self) {
        if self.leaving.is_empty() {
            let mut all = self.nothing;
            while let Some(value) = self.arrived.pop() {
                all = (self.join)(value, all);
                self.leaving.push(all);
            }
            self.arrived_all = self.nothing;
        }
        self.leaving.pop();
    }

    fn all(&self) -> S {
        let leaving = self.leaving.last().copied().unwrap_or(self.nothing);
        (self.join)(leaving, self.arrived_all)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_queue_joins_what_a_loop_does(
            steps in prop::collection::vec((1_u64..5, -9_i64..9), 1..60),
            from_ns in 0_u64..12,
            length_ns in prop::option::of(0_u64..12),
        ) {
            let mut trace = Trace::new(0);
            let mut t_ns = 0;
            for (dt_ns, _) in &steps {
                trace.push(t_ns, []);
                t_ns += dt_ns;
            }
            let values: Vec<i64> = steps.iter().map(|(_, value)| *value).collect();
            let window = Window { from_ns, to_ns: length_ns.map(|length_ns| from_ns + length_ns) };
            for spans in [window.ahead(&trace), window.back(&trace)] {
                let found = joined(&values, &spans, i64::max, i64::MIN);
                let expected: Vec<i64> = spans
                    .iter()
                    .map(|span| values[span.first..span.end.max(span.first)].iter().copied().max().unwrap_or(i64::MIN))
                    .collect();
                prop_assert_eq!(found, expected);
            }
        }
    }
}
