//! Histograms of signals: for how long their values were in which bin.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::held::{Held, Seen};

/// What has a histogram, by name.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    pub(super) name: String,
    /// Where the first bin begins, and the last one ends: finite, and the first less than the last.
    pub(super) from: f64,
    pub(super) to: f64,
    /// How many bins; at least one.
    pub(super) bins: usize,
    pub(super) seen: Vec<Seen>,
}

impl Spread {
    /// Where a value belongs. A bin holds its lower edge, not its upper one, but the last holds both.
    fn place(&self, value: f64) -> Place {
        if !value.is_finite() {
            Place::Nowhere
        } else if value < self.from {
            Place::Below
        } else if value > self.to {
            Place::Above
        } else {
            let part = (value - self.from) / (self.to - self.from);
            // a part of 1, also by rounding, is in the last one
            Place::Bin(((part * self.bins as f64) as usize).min(self.bins - 1))
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Below,
    Bin(usize),
    Above,
    Nowhere,
}

/// The histograms of signals. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpreadReport {
    /// Its name.
    pub name: String,
    /// Where the first bin begins.
    pub from: f64,
    /// Where the last bin ends. All are equally wide; each holds its lower edge, the last one also its upper.
    pub to: f64,
    /// Its signals, in the order of the scenario.
    pub signals: Vec<SignalSpread>,
}

/// For how long a signal was in which bin, in nanoseconds of virtual time.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SignalSpread {
    /// The signal.
    pub signal: String,
    /// The unit of its values and of the edges; absent if it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// How long in each bin.
    pub time_ns: Vec<u64>,
    /// How long below the first bin.
    pub below_ns: u64,
    /// How long above the last bin.
    pub above_ns: u64,
    /// How long it was not a finite number.
    pub not_finite_ns: u64,
}

impl SignalSpread {
    /// All of the time.
    pub fn total_ns(&self) -> u64 {
        self.time_ns.iter().sum::<u64>() + self.below_ns + self.above_ns + self.not_finite_ns
    }

    fn add(&mut self, place: Place, length_ns: u64) {
        let time_ns = match place {
            Place::Below => &mut self.below_ns,
            Place::Above => &mut self.above_ns,
            Place::Nowhere => &mut self.not_finite_ns,
            Place::Bin(bin) => match self.time_ns.get_mut(bin) {
                Some(time_ns) => time_ns,
                None => return,
            },
        };
        *time_ns += length_ns;
    }
}

/// Histograms while the run goes.
#[derive(Clone, Debug)]
pub(super) struct Spreading {
    spread: Spread,
    signals: Vec<(Held, SignalSpread)>,
}

impl Spreading {
    pub(super) fn new(spread: Spread) -> Self {
        let empty = |seen: &Seen| SignalSpread {
            signal: seen.signal.clone(),
            unit: seen.unit.clone(),
            time_ns: vec![0; spread.bins],
            below_ns: 0,
            above_ns: 0,
            not_finite_ns: 0,
        };
        let signals = spread.seen.iter().map(|seen| (Held::default(), empty(seen))).collect();
        Self { spread, signals }
    }

    /// Takes the image of `t_ns`.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64]) {
        for (seen, (held, signal)) in self.spread.seen.iter().zip(&mut self.signals) {
            if let Some((value, from_ns)) = held.push(t_ns, seen.value(values)) {
                signal.add(self.spread.place(value), t_ns.saturating_sub(from_ns));
            }
        }
    }

    /// What there is at the end of a run.
    pub(super) fn until(&self, end_ns: u64) -> SpreadReport {
        let Spread { name, from, to, .. } = &self.spread;
        let signals = self.signals.iter().map(|(held, signal)| {
            let mut all = signal.clone();
            if let Some((value, from_ns)) = held.value() {
                all.add(self.spread.place(value), end_ns.saturating_sub(from_ns));
            }
            all
        });
        SpreadReport { name: name.clone(), from: *from, to: *to, signals: signals.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spreading(from: f64, to: f64, bins: usize) -> Spreading {
        let seen = Seen { signal: "T".to_owned(), unit: None, column: 0, factor: (1.0, 1.0) };
        Spreading::new(Spread { name: "spread".to_owned(), from, to, bins, seen: vec![seen] })
    }

    fn of(spreading: &Spreading, end_ns: u64) -> SignalSpread {
        spreading.until(end_ns).signals.remove(0)
    }

    #[test]
    fn a_ramp_is_as_long_in_each_bin() {
        let mut ramp = spreading(0.0, 100.0, 4);
        for k in 0..120_u32 {
            ramp.push(u64::from(k) * 10, &[f64::from(k)]);
        }
        let signal = of(&ramp, 1200);
        // 0 to 24, 25 to 49, 50 to 74, and 75 to 100, both of them
        assert_eq!((signal.time_ns.clone(), signal.above_ns, signal.below_ns), (vec![250, 250, 250, 260], 190, 0));
        assert_eq!(signal.total_ns(), 1200);
    }

    #[test]
    fn edges_and_what_is_outside_have_their_places() {
        let values = [-1e-9, 0.0, 5.0, 10.0, 10.000_001, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        let mut edges = spreading(0.0, 10.0, 2);
        for (t_ns, value) in (0..).zip(values) {
            edges.push(t_ns, &[value]);
        }
        let signal = of(&edges, 8);
        assert_eq!(
            (signal.below_ns, signal.time_ns.clone(), signal.above_ns, signal.not_finite_ns),
            (1, vec![1, 2], 1, 3)
        );
    }

    #[test]
    fn one_bin_holds_all_and_a_run_without_length_nothing() {
        let mut one = spreading(0.0, 1.0, 1);
        one.push(5, &[0.5]);
        assert_eq!(of(&one, 5).total_ns(), 0);
        assert_eq!(of(&one, 25).time_ns, [20]);
    }
}
