//! Frames that a side pushes by its own clock: `[Nyyssönen]` 4.1, where a PC pushes every 15.6 ms what it wants to push every
//! 10 ms.

use serde::{Deserialize, Serialize};

use super::draws::Onset;
use crate::operation::PushInterval;
use crate::random::{Random, seed_for};
use crate::time::TimeSpan;

/// Shortest interval between two pushes: shorter ones would cost more than the step.
const PUSH_NS_MIN: u64 = 10_000;

/// The pushes of a frame by a clock of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) struct Pushes {
    random: Random,
    interval: PushInterval,
    step: TimeSpan,
    /// From the beginning of the step under way to the next push, ns.
    due_ns: u64,
}

impl Pushes {
    /// The pushes as they begin; none if the interval is not in order.
    pub(super) fn new(interval: PushInterval, seed: u64, onset: &Onset<'_>) -> Option<Self> {
        // Before the first draw: `clamp` panics where the least is above the most, and an operator may send that.
        if !interval.is_in_order() {
            return None;
        }
        let random = Random::new(seed_for(seed, "onset", &onset.steps.to_string()));
        let mut pushes = Self { random, interval, step: onset.step, due_ns: 0 };
        pushes.due_ns = pushes.draw_ns();
        Some(pushes)
    }

    fn draw_ns(&mut self) -> u64 {
        let PushInterval { mean, sigma, least, most } = self.interval;
        let sigma_ns = sigma.map_or(0.0, |sigma| sigma.as_nanos() as f64);
        let drawn_ns = mean.as_nanos() as f64 + sigma_ns * self.random.normal();
        // a conversion to an integer saturates
        (drawn_ns as u64).clamp(least.as_nanos().max(PUSH_NS_MIN), most.as_nanos().max(PUSH_NS_MIN))
    }

    /// Whether there is a push in the step under way.
    pub(super) fn is_due(&self) -> bool {
        self.due_ns < self.step.as_nanos()
    }

    /// Goes on to the next step.
    pub(super) fn next_step(&mut self) {
        while self.is_due() {
            self.due_ns = self.due_ns.saturating_add(self.draw_ns());
        }
        self.due_ns -= self.step.as_nanos();
    }

    /// Whether they could be: what a checkpoint says is not believed.
    pub(super) fn fits(&self) -> bool {
        self.interval.is_in_order()
    }
}

#[cfg(test)]
mod tests {
    use super::super::disturbance::Disturbance;
    use super::*;
    use crate::operation::SignalFault;
    use crate::signal::SignalType;
    use crate::time::StepCount;

    #[test]
    fn pushes_come_at_their_intervals_and_the_frame_between_them_is_the_last_one() {
        // `[Nyyssönen]` Table 4, from the PC to the charger, seen in steps of 1 ms
        let ms = |us: u64| TimeSpan::from_nanos(us * 1000).expect("not zero");
        let interval = PushInterval { mean: ms(15_610), sigma: Some(ms(4170)), least: ms(1390), most: ms(35_340) };
        let onset =
            Onset { ty: SignalType::LINT, committed: &0_i64.to_le_bytes(), step: ms(1000), steps: StepCount(0) };
        let fault = SignalFault::Pushed { interval, seed: 7 };
        let mut pushed = Disturbance::begin(&fault, &onset).expect("any signal");
        let (count, mut ages, mut oldest, mut pushes, mut before) = (200_000_i64, 0, 0, 0, 0);
        for step in 1..=count {
            let mut bytes = step.to_le_bytes();
            pushed.pass(SignalType::LINT, &mut bytes, true);
            let seen = i64::from_le_bytes(bytes);
            (ages, oldest) = (ages + step - seen, oldest.max(step - seen));
            pushes += i64::from(seen != before);
            before = seen;
        }
        let per_push = count as f64 / pushes as f64;
        assert!((per_push - 15.61).abs() < 0.1, "{per_push}");
        // of an interval T the age is E(T²)/2E(T) on average, 8.36 ms; the time to look at it comes on top
        let age = ages as f64 / count as f64;
        assert!((age - 7.9).abs() < 0.3 && oldest <= 36, "{age} {oldest}");
        for least in [16_000, 36_000] {
            let wrong = PushInterval { least: ms(least), ..interval };
            assert_eq!(Disturbance::begin(&SignalFault::Pushed { interval: wrong, seed: 7 }, &onset), None);
        }
    }
}
