//! An inductive proximity switch: sees metal, each sort from its own distance.
//!
//! # Equations
//! - switching distance `s = s_n k`, with the reduction factor k of the target's metal;
//! - on at `s`, off again at `s (1 + h)`: hysteresis.
//!
//! # Source
//! IEC 60947-5-2, 7.2.1.3 (rated distance on steel) and 7.2.1.6 (hysteresis); reduction factors as manufacturers give
//! them for unshielded kinds.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::dynamics::in_reach;
use crate::component::declare::{choice, failures, own_types, parameters, signals};
use crate::coupling::{Hit, Ray};

choice! {
    /// What the targets are made of.
    Metal {
        /// Mild steel, for which the distance is rated.
        Steel = "steel",
        /// Stainless steel.
        Stainless = "stainless",
        /// Brass.
        Brass = "brass",
        /// Aluminium.
        Aluminium = "aluminium",
        /// Copper.
        Copper = "copper",
    }
}

impl Metal {
    fn reduction(self) -> f64 {
        match self {
            Self::Steel => 1.0,
            Self::Stainless => 0.7,
            Self::Brass => 0.45,
            Self::Aluminium => 0.4,
            Self::Copper => 0.3,
        }
    }
}

parameters! {
    /// A switch and its targets.
    Parameters {
        /// rated switching distance, on steel
        rated_m: f64 = 0.008 => 1e-4, 0.2;
        /// what the targets are made of
        metal: Metal = Metal::Steel;
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
        /// chips on its face: it always sees something
        Chips = "chips",
        /// the wire is broken: the output stays off
        BrokenWire = "broken_wire",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    near: bool,
}

/// A switch by its parameters.
pub(crate) struct InductiveSensor {
    p: Parameters,
}

impl Component for InductiveSensor {
    const NAME: &'static str = "inductive_sensor";
    const SUMMARY: &'static str = "inductive proximity switch, which sees metal";
    const FORMULA: &'static [&'static str] = &["s = s_n k(metal)", "on at s, off at s (1 + h)"];
    const SOURCE: &'static str = "IEC 60947-5-2";
    own_types!(senses Ray);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Hit>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Hit>) -> Outputs {
        let on_m = self.p.rated_m * self.p.metal.reduction();
        let met = in_reach(turn.seen.hit_m, state.near, on_m, self.p.hysteresis_pct);
        state.near = (met || turn.failed.has(Failure::Chips)) && !turn.failed.has(Failure::Blind);
        Outputs { detected: state.near != self.p.normally_closed && !turn.failed.has(Failure::BrokenWire) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn seen(rig: &mut Rig<InductiveSensor>, hit_m: f64) -> bool {
        rig.seen = Hit { hit_m: Some(hit_m) };
        rig.run(Inputs {}, 0.001, 1).detected
    }

    #[test]
    fn each_metal_has_its_distance_and_its_hysteresis() {
        for (metal, on_m) in [(Metal::Steel, 8e-3), (Metal::Aluminium, 3.2e-3), (Metal::Copper, 2.4e-3)] {
            let mut rig = Rig::new(InductiveSensor::new(Parameters { metal, ..Parameters::default() }));
            assert!(!seen(&mut rig, on_m * 1.001), "{metal:?}");
            assert!(seen(&mut rig, on_m * 0.999) && seen(&mut rig, on_m * 1.099));
            assert!(!seen(&mut rig, on_m * 1.101) && !seen(&mut rig, on_m * 1.001));
        }
    }

    #[test]
    fn each_failure_has_its_effect() {
        let new = || Rig::new(InductiveSensor::new(Parameters::default()));
        assert!(!seen(&mut new().failing(Failure::Blind), 0.001));
        assert!(!seen(&mut new().failing(Failure::BrokenWire), 0.001));
        assert!(new().failing(Failure::Chips).run(Inputs {}, 0.001, 1).detected);
        let closed = Parameters { normally_closed: true, ..Parameters::default() };
        assert!(Rig::new(InductiveSensor::new(closed)).run(Inputs {}, 0.001, 1).detected);
    }
}
