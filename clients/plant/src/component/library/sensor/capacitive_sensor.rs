//! A capacitive proximity switch: sees any material, better the greater its permittivity.
//!
//! # Equations
//! - switching distance `s = s_n (ε_r - 1)/(ε_r + 1)`: the factor by which a half space of permittivity
//!   `ε_r` mirrors a charge before it, 1 for a conductor;
//! - on at `s`, off again at `s (1 + h)`: hysteresis.
//!
//! # Source
//! IEC 60947-5-2; J. D. Jackson, *Classical Electrodynamics*, 4.4 (image charge before a dielectric).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::dynamics::in_reach;
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::{Hit, Ray};

parameters! {
    /// A switch and its targets.
    Parameters {
        /// rated switching distance, on a conductor
        rated_m: f64 = 0.01 => 1e-4, 0.2;
        /// relative permittivity of the targets: wood 4, glass 7, water 80, metal 1e6
        permittivity_ratio: f64 = 80.0 => 1.0, 1e6;
        /// how much farther away it switches off
        hysteresis_pct: f64 = 10.0 => 0.0, 20.0;
        /// off where a target is
        normally_closed: bool = false;
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
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it sees nothing
        Blind = "blind",
        /// wet: it always sees something
        Wet = "wet",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    near: bool,
}

/// A switch by its parameters.
pub(crate) struct CapacitiveSensor {
    p: Parameters,
}

impl Component for CapacitiveSensor {
    const NAME: &'static str = "capacitive_sensor";
    const SUMMARY: &'static str = "capacitive proximity switch, which sees any material";
    const FORMULA: &'static [&'static str] = &["s = s_n (ε - 1)/(ε + 1)", "on at s, off at s (1 + h)"];
    const SOURCE: &'static str = "IEC 60947-5-2; J. D. Jackson, Classical Electrodynamics, 4.4";
    own_types!(senses Ray);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Hit>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Hit>) -> Outputs {
        let permittivity = self.p.permittivity_ratio;
        let on_m = self.p.rated_m * (permittivity - 1.0) / (permittivity + 1.0);
        let met = in_reach(turn.seen.hit_m, state.near, on_m, self.p.hysteresis_pct);
        state.near = (met || turn.failed.has(Failure::Wet)) && !turn.failed.has(Failure::Blind);
        Outputs { detected: state.near != self.p.normally_closed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn seen(rig: &mut Rig<CapacitiveSensor>, hit_m: f64) -> bool {
        rig.seen = Hit { hit_m: Some(hit_m) };
        rig.run(Inputs {}, 0.001, 1).detected
    }

    #[test]
    fn the_distance_follows_the_permittivity() {
        // wood 3/5 of the rated distance, water 79/81, a conductor all of it
        for (permittivity_ratio, on_m) in [(4.0, 0.006), (80.0, 0.01 * 79.0 / 81.0), (1e6, 0.009_999_98)] {
            let p = Parameters { permittivity_ratio, ..Parameters::default() };
            let mut rig = Rig::new(CapacitiveSensor::new(p));
            assert!(!seen(&mut rig, on_m * 1.000_1), "{permittivity_ratio}");
            assert!(seen(&mut rig, on_m * 0.999_9) && seen(&mut rig, on_m * 1.09) && !seen(&mut rig, on_m * 1.11));
        }
    }

    #[test]
    fn each_failure_has_its_effect() {
        let new = || Rig::new(CapacitiveSensor::new(Parameters::default()));
        assert!(!seen(&mut new().failing(Failure::Blind), 0.001));
        assert!(new().failing(Failure::Wet).run(Inputs {}, 0.001, 1).detected);
    }
}
