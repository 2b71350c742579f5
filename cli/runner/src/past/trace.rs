//! What signals did in a span of the past, in few points: of each part of the span the first, the least, the greatest and the
//! last value, so that a pulse of a single step is not lost, and a screen does not get more than it can show.

use onescan_server::signal::SignalId;
use onescan_server::time::{TimeSpan, VirtualTime};

/// The values of one signal, each with its time in ns and valid until the next.
pub(crate) type Points = Vec<[f64; 2]>;

/// A span of the past.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    pub(crate) signals: Vec<SignalId>,
    pub(crate) from: VirtualTime,
    pub(crate) until: VirtualTime,
    /// The step of the session.
    pub(crate) step: TimeSpan,
    /// Into how many parts it is divided.
    pub(crate) parts: u32,
}

/// What is kept of one signal in one part.
#[derive(Clone, Copy, Debug)]
struct Part {
    first: [f64; 2],
    least: [f64; 2],
    greatest: [f64; 2],
    last: [f64; 2],
}

/// Takes the steps of a span in their order.
pub(crate) struct Tracing {
    from_ns: u64,
    width_ns: u64,
    /// The number of the part that is being taken.
    part: u64,
    parts: Vec<Option<Part>>,
    points: Vec<Points>,
}

impl Tracing {
    pub(crate) fn new(span: &Span) -> Self {
        let (from_ns, until_ns) = (span.from.as_nanos(), span.until.as_nanos());
        let width_ns = until_ns.saturating_sub(from_ns).div_ceil(u64::from(span.parts).max(1)).max(1);
        let count = span.signals.len();
        Self { from_ns, width_ns, part: 0, parts: vec![None; count], points: vec![Points::new(); count] }
    }

    /// Takes the values of a step, one for each signal; what is not a number is left out.
    pub(crate) fn take(&mut self, t_v: VirtualTime, values: impl Iterator<Item = f64>) {
        let part = t_v.as_nanos().saturating_sub(self.from_ns) / self.width_ns;
        if part != self.part {
            self.close_part();
            self.part = part;
        }
        let t_ns = t_v.as_nanos() as f64;
        for (part, value) in self.parts.iter_mut().zip(values).filter(|(_, value)| !value.is_nan()) {
            let now = [t_ns, value];
            let part = part.get_or_insert(Part { first: now, least: now, greatest: now, last: now });
            if value < part.least[1] {
                part.least = now;
            }
            if value > part.greatest[1] {
                part.greatest = now;
            }
            // A value that stays is known by when it began.
            if value != part.last[1] {
                part.last = now;
            }
        }
    }

    /// What came of it, a list for each signal.
    pub(crate) fn finish(mut self) -> Vec<Points> {
        self.close_part();
        self.points
    }

    fn close_part(&mut self) {
        for (part, points) in self.parts.iter_mut().zip(&mut self.points) {
            let Some(Part { first, least, greatest, last }) = part.take() else { continue };
            let mut marks = [first, least, greatest, last];
            marks.sort_by(|a, b| a[0].total_cmp(&b[0]));
            for mark in marks {
                // The value before still holds, or is this very one.
                if points.last().is_none_or(|before| before[1] != mark[1] && before[0] < mark[0]) {
                    points.push(mark);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(steps: u64, parts: u32) -> Span {
        let step = TimeSpan::from_millis(1).expect("not zero");
        let until = VirtualTime::from_nanos(steps * 1_000_000);
        Span { signals: Vec::new(), from: VirtualTime::ZERO, until, step, parts }
    }

    fn traced(values: &[f64], parts: u32) -> Points {
        let mut tracing = Tracing {
            parts: vec![None],
            points: vec![Points::new()],
            ..Tracing::new(&span(values.len() as u64, parts))
        };
        for (step, value) in values.iter().enumerate() {
            tracing.take(VirtualTime::from_nanos(step as u64 * 1_000_000), std::iter::once(*value));
        }
        tracing.finish().remove(0)
    }

    #[test]
    fn a_pulse_of_one_step_is_there() {
        let mut values = vec![0.0; 1_000];
        values[503] = 1.0;
        assert_eq!(traced(&values, 10), [[0.0, 0.0], [503e6, 1.0], [504e6, 0.0]]);
        assert_eq!(traced(&values, 1), [[0.0, 0.0], [503e6, 1.0], [504e6, 0.0]]);
    }

    #[test]
    fn a_part_has_four_points_at_most_and_its_extremes() {
        let values: Vec<f64> = (0..10_000).map(|step| libm::sin(f64::from(step) * 0.7)).collect();
        let points = traced(&values, 20);
        assert!(points.len() <= 80, "{}", points.len());
        let most = |of: &mut dyn Iterator<Item = f64>| of.fold(f64::MIN, f64::max);
        assert_eq!(most(&mut points.iter().map(|point| point[1])), most(&mut values.iter().copied()));
        assert!(points.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    }

    #[test]
    fn what_is_not_a_number_is_left_out() {
        assert_eq!(traced(&[f64::NAN, 2.0, f64::NAN, 2.0], 2), [[1e6, 2.0]]);
    }
}
