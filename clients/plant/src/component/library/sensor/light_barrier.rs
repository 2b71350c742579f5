//! A light barrier: a beam that bodies interrupt.
//!
//! # Equations
//! The beam is a ray of `range_m`; the receiver is dark while a target is within it. The output
//! follows after `on_s` when the beam is interrupted, after `off_s` when it is free again; with
//! `light_on` it is true while the receiver sees light.
//!
//! # Source
//! IEC 60947-5-2 (proximity switches, photoelectric kinds).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::OnDelay;
use crate::coupling::{Hit, Ray};

parameters! {
    /// A sender and its receiver.
    Parameters {
        /// length of the beam
        range_m: f64 = 1.0 => 1e-4, 1000.0;
        /// how long the beam must be interrupted
        on_s: f64 = 0.0 => 0.0, 60.0;
        /// how long the beam must be free
        off_s: f64 = 0.0 => 0.0, 60.0;
        /// true while the receiver sees light, not while it is dark
        light_on: bool = false;
    }
}

signals! {
    /// Nothing.
    Inputs {}
}

signals! {
    /// The switching output.
    Outputs {
        /// switching output
        detected: bool,
        /// interruptions since the set-up
        count: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// no light arrives: the receiver is dark
        Dirty = "dirty",
        /// the receiver sees foreign light and never gets dark
        Dazzled = "dazzled",
        /// the output stays off
        Dead = "dead",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    dark: bool,
    change: OnDelay,
    count: i32,
}

/// A light barrier by its parameters.
pub(crate) struct LightBarrier {
    p: Parameters,
}

impl Component for LightBarrier {
    const NAME: &'static str = "light_barrier";
    const SUMMARY: &'static str = "light barrier: a beam that bodies interrupt";
    const FORMULA: &'static [&'static str] =
        &["dark while a target is within range_m of the beam, after on_s and off_s"];
    const SOURCE: &'static str = "IEC 60947-5-2";
    own_types!(senses Ray);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Hit>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Hit>) -> Outputs {
        let met = turn.seen.hit_m.is_some_and(|distance| distance <= self.p.range_m);
        let dark = (met || turn.failed.has(Failure::Dirty)) && !turn.failed.has(Failure::Dazzled);
        let delay_s = if dark { self.p.on_s } else { self.p.off_s };
        if state.change.holds(dark != state.dark, delay_s, turn.dt_s) {
            state.dark = dark;
            state.count = state.count.saturating_add(i32::from(dark));
            state.change = OnDelay::default();
        }
        let detected = state.dark != self.p.light_on && !turn.failed.has(Failure::Dead);
        Outputs { detected, count: state.count }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn rig(p: Parameters) -> Rig<LightBarrier> {
        Rig::new(LightBarrier::new(p))
    }

    fn at(hit_m: f64) -> Hit {
        Hit { hit_m: Some(hit_m) }
    }

    #[test]
    fn it_is_dark_within_its_range_only() {
        let mut rig = rig(Parameters::default());
        let mut seen = |seen: Hit| {
            rig.seen = seen;
            rig.run(Inputs {}, 0.01, 1)
        };
        assert!(!seen(Hit::default()).detected);
        assert!(seen(at(1.0)).detected && !seen(at(1.001)).detected);
        assert_eq!(seen(at(0.2)).count, 2);
    }

    #[test]
    fn delays_swallow_what_is_shorter() {
        let mut rig = rig(Parameters { on_s: 0.03, off_s: 0.02, ..Parameters::default() });
        rig.seen = at(0.5);
        assert!(!rig.run(Inputs {}, 0.01, 2).detected);
        assert!(rig.run(Inputs {}, 0.01, 1).detected);
        rig.seen = Hit::default();
        assert!(rig.run(Inputs {}, 0.01, 1).detected && !rig.run(Inputs {}, 0.01, 1).detected);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let free = |mode: Failure| rig(Parameters::default()).failing(mode).run(Inputs {}, 0.01, 1).detected;
        assert!(free(Failure::Dirty));
        let met = |mode: Failure| {
            let mut rig = rig(Parameters::default()).failing(mode);
            rig.seen = at(0.1);
            rig.run(Inputs {}, 0.01, 1).detected
        };
        assert!(!met(Failure::Dazzled) && !met(Failure::Dead));
        let light_on = rig(Parameters { light_on: true, ..Parameters::default() });
        assert!({ light_on }.run(Inputs {}, 0.01, 1).detected, "light arrives");
    }
}
