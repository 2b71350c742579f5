//! An emergency stop with two channels that latches.
//!
//! # Equations
//! - both channels open when it is hit, and stay open until it is turned back;
//! - channel B follows channel A by `discrepancy_s`.
//!
//! # Source
//! ISO 13850:2015, 4.1; IEC 60947-5-5.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::OnDelay;

parameters! {
    /// Its parameters.
    Parameters {
        /// from channel A to channel B
        discrepancy_s: f64 = 0.0 => 0.0, 10.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// it is hit
        hit: bool,
        /// it is turned back
        release: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// channel A is closed
        channel_a: bool = true,
        /// channel B is closed
        channel_b: bool = true,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// channel A is welded
        AWelded = "a_welded",
        /// channel B is welded
        BWelded = "b_welded",
        /// the wire of channel A is broken
        AOpen = "a_open",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    latched: bool,
    b_open: bool,
    change: OnDelay,
}

/// An emergency stop with two channels that latches, by its parameters.
pub(crate) struct EmergencyStop {
    p: Parameters,
}

impl Component for EmergencyStop {
    const NAME: &'static str = "emergency_stop";
    const SUMMARY: &'static str = "emergency stop: latching, two break contacts";
    const FORMULA: &'static [&'static str] = &["open from a hit until it is reset"];
    const SOURCE: &'static str = "ISO 13850:2015, 4.1; IEC 60947-5-5";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        state.latched = inputs.hit || (state.latched && !inputs.release);
        if state.change.holds(state.latched != state.b_open, self.p.discrepancy_s, turn.dt_s) {
            state.b_open = state.latched;
            state.change = OnDelay::default();
        }
        let channel_a = !state.latched || turn.failed.has(Failure::AWelded);
        Outputs {
            channel_a: channel_a && !turn.failed.has(Failure::AOpen),
            channel_b: !state.b_open || turn.failed.has(Failure::BWelded),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const HIT: Inputs = Inputs { hit: true, release: false };
    const LEFT: Inputs = Inputs { hit: false, release: false };
    const BACK: Inputs = Inputs { hit: false, release: true };

    fn rig(discrepancy_s: f64) -> Rig<EmergencyStop> {
        Rig::new(EmergencyStop::new(Parameters { discrepancy_s }))
    }

    fn channels(out: Outputs) -> (bool, bool) {
        (out.channel_a, out.channel_b)
    }

    #[test]
    fn it_latches_until_it_is_turned_back() {
        let mut rig = rig(0.0);
        let seen: Vec<_> =
            [LEFT, HIT, LEFT, BACK, LEFT].iter().map(|inputs| channels(rig.run(*inputs, 0.01, 1)).0).collect();
        assert_eq!(seen, [true, false, false, true, true]);
        assert_eq!(channels(rig.run(Inputs { hit: true, release: true }, 0.01, 1)), (false, false), "the hit wins");
    }

    #[test]
    fn the_second_channel_is_late() {
        let mut rig = rig(0.03);
        let seen: Vec<_> = (0..4).map(|_| channels(rig.run(HIT, 0.01, 1))).collect();
        assert_eq!(seen, [(false, true), (false, true), (false, false), (false, false)]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let hit = |mode: Failure| channels(rig(0.0).failing(mode).run(HIT, 0.01, 1));
        assert_eq!(hit(Failure::AWelded), (true, false));
        assert_eq!(hit(Failure::BWelded), (false, true));
        assert_eq!(channels(rig(0.0).failing(Failure::AOpen).run(LEFT, 0.01, 1)), (false, true));
    }
}
