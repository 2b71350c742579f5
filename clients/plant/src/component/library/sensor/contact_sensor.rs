//! A contact sensor: a body that others touch.
//!
//! # Equations
//! - `CheckPower`: true as long as a target touches the body;
//! - `CheckPulse`: true in the first scan of a touch only.
//!
//! # Source
//! class Sensor of the filling machine (Sivtoft 2002, 4.2.3 and A6).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::{Contact, Targets};

parameters! {
    /// Its parameters.
    Parameters {}
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// something touches it
        power: bool,
        /// in the first scan of a touch
        pulse: bool,
        /// targets that touch it
        touching: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it feels nothing
        Dead = "dead",
        /// it always feels something
        Stuck = "stuck",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    power: bool,
}

/// A contact sensor.
pub(crate) struct ContactSensor;

impl Component for ContactSensor {
    const NAME: &'static str = "contact_sensor";
    const SUMMARY: &'static str = "contact sensor: a body that others touch, as a level and as a pulse";
    const FORMULA: &'static [&'static str] = &["power = touched", "pulse = touched and not touched a scan ago"];
    const SOURCE: &'static str = "class Sensor of the filling machine (Sivtoft 2002, 4.2.3 and A6)";
    own_types!(senses Contact);

    fn new(_: Parameters) -> Self {
        Self
    }

    fn initial(&self, _: &Start<Targets>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Targets>) -> Outputs {
        let touched = turn.seen.count > 0 || turn.failed.has(Failure::Stuck);
        let power = touched && !turn.failed.has(Failure::Dead);
        let before = std::mem::replace(&mut state.power, power);
        let pulse = power && !before;
        Outputs { power, pulse, touching: turn.seen.count as i32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, touched};

    fn rig() -> Rig<ContactSensor> {
        Rig::new(ContactSensor::new(Parameters {}))
    }

    #[test]
    fn a_pulse_lasts_one_scan_of_each_touch() {
        let mut rig = rig();
        let seen: Vec<_> = [0, 1, 2, 1, 0, 0, 1]
            .iter()
            .map(|count| {
                rig.seen = touched(*count);
                let out = rig.run(Inputs {}, 0.01, 1);
                (out.power, out.pulse)
            })
            .collect();
        let (off, first, on) = ((false, false), (true, true), (true, false));
        assert_eq!(seen, [off, first, on, on, off, off, first]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let mut dead = rig().failing(Failure::Dead);
        dead.seen = touched(1);
        assert!(!dead.run(Inputs {}, 0.01, 1).power);
        assert!(rig().failing(Failure::Stuck).run(Inputs {}, 0.01, 1).power);
    }
}
