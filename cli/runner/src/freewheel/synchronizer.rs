//! The plant that follows a PLC's clock (`[Vergnano]` Fig. 5).
//!
//! At every communication the PLC's clock is compared with the plant's; the plant then steps until it is where the
//! PLC is expected to be at the next. `[Vergnano]` makes steps longer or shorter; a plant of rigid bodies has steps of
//! one length, and makes more or fewer of them.

//!
//! # The law
//! A plant that goes to `PLC + Δ + g·Error`, Δ after the last communication, has `-g·Error` at the next. The paper's law
//! has `g = 1`: an offset never dies, and changes its sign at each communication. With half of it the offset halves.

/// Where a plant stands against a PLC's clock. Times are in ns of either's own clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Synchronizer {
    /// How much of the error is corrected, %.
    gain_pct: u8,
    seen_ns: u64,
    expected_ns: u64,
}

impl Default for Synchronizer {
    /// That of the paper.
    fn default() -> Self {
        Self::new(100)
    }
}

impl Synchronizer {
    /// One that corrects so much of its error at each communication, %.
    pub fn new(gain_pct: u8) -> Self {
        Self { gain_pct, seen_ns: 0, expected_ns: 0 }
    }

    /// Takes the PLC's clock at a communication, when the plant's is at `plant_ns` (lines 3 to 8).
    pub fn observe(&mut self, plc_ns: u64, plant_ns: u64) {
        if plc_ns <= self.seen_ns {
            return;
        }
        let error = i128::from(plc_ns) - i128::from(plant_ns);
        let step = i128::from(plc_ns - self.seen_ns) + error * i128::from(self.gain_pct) / 100;
        self.seen_ns = plc_ns;
        self.expected_ns = u64::try_from(i128::from(plc_ns) + step.max(0)).unwrap_or(u64::MAX);
    }

    /// True if the plant, at `plant_ns`, may step (line 9).
    pub fn may_step(&self, plant_ns: u64) -> bool {
        plant_ns < self.expected_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error in ns at each of some communications, of a plant that begins 30 ms behind and goes where it may.
    fn errors_ns(gain_pct: u8) -> Vec<i64> {
        const CYCLE_NS: u64 = 100_000_000;
        let mut synchronizer = Synchronizer::new(gain_pct);
        let mut plant_ns = CYCLE_NS - 30_000_000;
        (1..=5)
            .map(|cycle| {
                let plc_ns = cycle * CYCLE_NS;
                synchronizer.observe(plc_ns, plant_ns);
                let error_ns = plc_ns.cast_signed() - plant_ns.cast_signed();
                plant_ns = synchronizer.expected_ns;
                error_ns
            })
            .collect()
    }

    #[test]
    fn the_law_of_the_paper_turns_an_offset_over_for_ever_and_half_of_it_ends_it() {
        let millis = |gain_pct| errors_ns(gain_pct).into_iter().map(|ns| ns / 1_000_000).collect::<Vec<i64>>();
        assert_eq!(millis(100), [30, -30, 30, -30, 30]);
        assert_eq!(errors_ns(50), [30_000_000, -15_000_000, 7_500_000, -3_750_000, 1_875_000]);
        assert_eq!(millis(0), [30, 0, 0, 0, 0]);
    }

    #[test]
    fn the_plant_goes_where_the_plc_is_expected() {
        let mut synchronizer = Synchronizer::default();
        assert!(!synchronizer.may_step(0), "nothing is known of the PLC yet");
        synchronizer.observe(10, 0);
        // 10 since the last time, and 10 behind.
        assert!(synchronizer.may_step(29) && !synchronizer.may_step(30));
        synchronizer.observe(10, 30);
        assert!(!synchronizer.may_step(30), "no news");
        synchronizer.observe(20, 30);
        assert!(!synchronizer.may_step(30), "10 ahead: it waits for the PLC");
        synchronizer.observe(30, 30);
        assert!(synchronizer.may_step(39) && !synchronizer.may_step(40));
    }
}
