//! How long it takes until something first holds, from an instant of the run on.

use super::bind::Expectation;
use super::formula::{Formula, Window};
use super::monitor::Monitor;
use super::sample::{Block, TraceEnd};
use super::truth::Truth;

/// A formula `eventually f`, watched from its first sample on for when `f` first holds.
#[derive(Clone, Debug)]
pub struct Reaction {
    window: Window,
    inner: Monitor,
    /// One sample at a time.
    block: Block,
    samples: u64,
    start_ns: Option<u64>,
    /// Whether it held on the last sample at or before the window's beginning.
    held_before: bool,
    after_ns: Option<u64>,
}

impl Reaction {
    /// Nothing if the formula is none of `eventually f` and `within T f`: it does not say what is waited for.
    pub fn new(expectation: &Expectation) -> Option<Self> {
        let Formula::Eventually(window, inner) = expectation.formula() else { return None };
        let columns = expectation.signals().iter().map(|(_, column)| column + 1).max().unwrap_or(0);
        Some(Self {
            window: *window,
            inner: Monitor::every(inner),
            block: Block::new(columns),
            samples: 0,
            start_ns: None,
            held_before: false,
            after_ns: None,
        })
    }

    /// Takes the next sample: a value for each column of its formula's binding.
    pub fn push(&mut self, t_ns: u64, values: impl IntoIterator<Item = f64>) {
        self.start_ns.get_or_insert(t_ns);
        if self.after_ns.is_some() {
            return;
        }
        self.block.begin(self.samples);
        self.block.push(t_ns, 1, 1, values);
        self.samples += 1;
        self.inner.push(&self.block);
        self.look();
    }

    /// After how many nanoseconds it first held, if it did within the window.
    pub fn finish(mut self, end: TraceEnd) -> Option<u64> {
        self.inner.finish(end);
        self.look();
        self.after_ns
    }

    fn look(&mut self) {
        let (Some(start_ns), Window { from_ns, to_ns }) = (self.start_ns, self.window) else { return };
        for said in self.inner.take_said() {
            let after_ns = said.sample.t_ns.saturating_sub(start_ns);
            let holds = said.worth.truth == Truth::True;
            if after_ns <= from_ns {
                self.held_before = holds;
            }
            let within = after_ns >= from_ns && to_ns.is_none_or(|to_ns| after_ns <= to_ns);
            let found = if after_ns > from_ns && self.held_before { Some(from_ns) } else { None };
            let found = found.or((within && holds).then_some(after_ns));
            if self.after_ns.is_none() {
                self.after_ns = found;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalType;

    use super::super::bind::KnownSignal;
    use super::*;

    fn after(text: &str, values: &[f64]) -> Result<Option<u64>, &'static str> {
        let known = [KnownSignal { name: "x".to_owned(), ty: SignalType::LREAL, unit: None }];
        let expectation = Expectation::parse(text, &known, &mut Vec::new()).expect("a formula");
        let mut reaction = Reaction::new(&expectation).ok_or("waits for nothing")?;
        for (place, value) in values.iter().enumerate() {
            reaction.push(100 + 10 * place as u64, [*value]);
        }
        Ok(reaction.finish(TraceEnd::Complete))
    }

    #[test]
    fn the_first_time_within_the_window_counts() {
        let values = [0.0, 1.0, 0.0, 2.0, 0.0];
        assert_eq!(after("eventually x > 0", &values), Ok(Some(10)));
        assert_eq!(after("within 20ns x > 1", &values), Ok(None), "30 ns are too late");
        assert_eq!(after("eventually[0,30ns] x > 1", &values), Ok(Some(30)));
        assert_eq!(after("eventually[15ns,] x > 0", &values), Ok(Some(15)), "the value that holds there counts");
        assert_eq!(after("eventually[20ns,] x > 0", &values), Ok(Some(30)));
        assert_eq!(after("always x > 0", &values), Err("waits for nothing"));
    }
}
