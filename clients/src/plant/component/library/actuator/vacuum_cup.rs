//! A vacuum cup with its ejector.
//!
//! # Equations
//! - on a part `τ_e dp/dt = p_max - p`, and `τ_v dp/dt = -p` when vented: the volume is evacuated exponentially;
//! - without a part the cup draws air: `p_max/20`;
//! - holds while `F = A p ≥ S m g`, with a safety factor S for the heaviest part.
//!
//! # Source
//! closed form; safety factor 2 for horizontal cups is what manufacturers advise.

use std::f64::consts::FRAC_PI_4;

use serde::{Deserialize, Serialize};

use crate::plant::component::behaviour::{Component, Start, Turn};
use crate::plant::component::declare::{failures, own_types, parameters, signals};
use crate::plant::component::dynamics::lag;
use crate::plant::component::fluid::BAR_PA;
use crate::plant::coupling::{Hold, Holds, Targets};

parameters! {
    /// Its parameters.
    Parameters {
        /// diameter of the cup
        diameter_m: f64 = 0.04 => 0.001, 1.0;
        /// vacuum of the ejector, below the atmosphere
        vacuum_bar: f64 = 0.8 => 0.01, 1.0;
        /// time constant of evacuation
        evacuate_s: f64 = 0.05 => 0.0, 100.0;
        /// time constant of venting
        vent_s: f64 = 0.02 => 0.0, 100.0;
        /// the heaviest part
        part_kg: f64 = 1.0 => 0.0, 1e5;
        /// safety factor
        safety_ratio: f64 = 2.0 => 1.0, 100.0;
        /// the vacuum switch closes here
        switch_bar: f64 = 0.4 => 0.0, 1.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// the ejector is on
        on: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// vacuum, below the atmosphere
        vacuum_bar: f64,
        /// vacuum switch
        switch: bool,
        /// it holds a part
        holding: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// a torn lip: half the vacuum
        Torn = "torn",
        /// the ejector is clogged: no vacuum
        Clogged = "clogged",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    held: Option<u32>,
    vacuum_bar: f64,
}

/// A vacuum cup with its ejector, by its parameters.
pub(crate) struct VacuumCup {
    p: Parameters,
}

/// Part of the vacuum that an open cup reaches.
const OPEN_PART: f64 = 0.05;
/// Standard acceleration of free fall.
const GRAVITY_M_S2: f64 = 9.806_65;

impl Component for VacuumCup {
    const NAME: &'static str = "vacuum_cup";
    const SUMMARY: &'static str = "vacuum cup with an ejector: holds a part while the vacuum suffices";
    const FORMULA: &'static [&'static str] = &["τ dp/dt = p_max - p", "F = A p ≥ S m g"];
    const SOURCE: &'static str = "closed form; safety factor 2 for horizontal cups is what manufacturers advise";
    own_types!(moves Holds);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Targets>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Targets>) {
        let p = &self.p;
        let part = state.held.or(turn.seen.first);
        let tight = match (part.is_some(), turn.failed.has(Failure::Torn)) {
            (false, _) => OPEN_PART,
            (true, true) => 0.5,
            (true, false) => 1.0,
        };
        let drawn = if inputs.on && !turn.failed.has(Failure::Clogged) { tight * p.vacuum_bar } else { 0.0 };
        let time_constant_s = if drawn > state.vacuum_bar { p.evacuate_s } else { p.vent_s };
        state.vacuum_bar = lag(state.vacuum_bar, drawn, time_constant_s, turn.dt_s);
        let area_m2 = FRAC_PI_4 * p.diameter_m * p.diameter_m;
        let held = area_m2 * state.vacuum_bar * BAR_PA >= p.safety_ratio * p.part_kg * GRAVITY_M_S2;
        state.held = if held { part } else { None };
    }

    fn effect(&self, state: &State) -> Hold {
        Hold(state.held)
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn<Targets>) -> Outputs {
        Outputs {
            vacuum_bar: state.vacuum_bar,
            switch: state.vacuum_bar >= self.p.switch_bar,
            holding: state.held.is_some(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::component::tests::{Rig, touched};

    const ON: Inputs = Inputs { on: true };
    const OFF: Inputs = Inputs { on: false };

    fn rig(count: u32) -> Rig<VacuumCup> {
        let mut rig = Rig::new(VacuumCup::new(Parameters::default()));
        rig.seen = touched(count);
        rig
    }

    #[test]
    fn the_vacuum_builds_up_by_its_closed_form_and_then_holds() {
        // A p = 2 m g at p = 0.1561 bar, after τ ln(0.8/(0.8 - 0.1561)) = 10.9 ms
        let mut rig = rig(1);
        assert!(!rig.run(ON, 0.001, 10).holding && rig.run(ON, 0.001, 1).holding);
        let out = rig.run(ON, 0.001, 39);
        // fifty factors, each rounded to 2^-53
        assert!((out.vacuum_bar - 0.8 * (1.0 - libm::exp(-1.0))).abs() < 1e-14 && out.switch, "{out:?}");
        let out = rig.run(OFF, 0.001, 100);
        assert!(!out.holding && !out.switch);
    }

    #[test]
    fn without_a_part_there_is_next_to_no_vacuum() {
        let out = rig(0).run(ON, 0.01, 100);
        assert!((out.vacuum_bar - 0.04).abs() < 1e-9 && !out.switch && !out.holding);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(!rig(1).failing(Failure::Clogged).run(ON, 0.01, 100).holding);
        let torn = rig(1).failing(Failure::Torn).run(ON, 0.01, 100);
        assert!((torn.vacuum_bar - 0.4).abs() < 1e-8 && torn.holding, "{torn:?}");
    }
}
