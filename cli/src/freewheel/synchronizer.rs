//! The plant that follows a PLC's clock (seed: Vergnano, Pellicciari, Berselli 2012, Fig. 5).
//!
//! At every communication the PLC's clock is compared with the plant's; the plant then steps until it is where the
//! PLC is expected to be at the next. The paper makes steps longer or shorter; a plant of rigid bodies has steps of
//! one length, and makes more or fewer of them.

/// Where a plant stands against a PLC's clock. Times are in ns of either's own clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Synchronizer {
    /// `pre.PLC.time`.
    seen_ns: u64,
    /// `pre.PLC.time + PLC.time.step`.
    expected_ns: u64,
}

impl Synchronizer {
    /// Takes the PLC's clock at a communication, when the plant's is at `plant_ns` (lines 3 to 8).
    pub fn observe(&mut self, plc_ns: u64, plant_ns: u64) {
        if plc_ns <= self.seen_ns {
            return;
        }
        let error = i128::from(plc_ns) - i128::from(plant_ns);
        let step = i128::from(plc_ns - self.seen_ns) + error;
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
