//! A vacuum cup with its ejector.
//!
//! # Equations
//! - on a part `τ_e dp/dt = p_max - p`, and `τ_v dp/dt = -p` when vented: the volume is evacuated exponentially;
//! - without a part the cup draws air: `p_max/20`;
//! - holds while `A p ≥ S (F∥ + F⊥/µ + 2 e F∥/d)`: the force `F = m (a - g)` of what it really carries, which pulls
//!   along the cup's axis, shears across it, and tilts the lip by its distance e from the axis. Then air
//!   rushes in, and the vacuum has to build up again. Without `direction` all of F pulls.
//!
//! # Source
//! J. Schmalz GmbH, Vacuum Knowledge, theoretical holding force: horizontal cup `m (g + a/µ) S`, vertical cup
//! `m (g + a) S/µ`; µ 0.5 for wood, metal, glass, 0.1 to 0.4 for wet or oily ones, 0.6 for rough ones; S at least
//! 1.5 in design, 1 where parts really fall.

use std::f64::consts::FRAC_PI_4;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use crate::component::fluid::BAR_PA;
use crate::coupling::{Grasp, Hold, Holds, Load};

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
        /// coefficient of friction between lip and part
        friction: f64 = 0.5 => 0.01, 10.0;
        /// reserve: a part is lost at this part of the force; 1 is where it really falls
        safety_ratio: f64 = 1.0 => 1.0, 100.0;
        /// over this time the lip spreads a blow; 2 kg on 5 N/mm give √(m/k) = 0.02
        yield_s: f64 = 0.02 => 0.0, 10.0;
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
        /// force that the held part asks for
        load_n: f64,
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

impl VacuumCup {
    /// The force along the cup's axis that holds a load.
    fn needed_n(&self, load: Load) -> f64 {
        let p = &self.p;
        let Some(pull_n) = load.pull_n else { return p.safety_ratio * load.force_n };
        let tilt_n = 2.0 * load.beside_m * pull_n.abs() / p.diameter_m;
        p.safety_ratio * (pull_n.max(0.0) + load.aside_n() / p.friction + tilt_n)
    }
}

impl Component for VacuumCup {
    const NAME: &'static str = "vacuum_cup";
    const SUMMARY: &'static str = "vacuum cup with an ejector: holds a part while the vacuum suffices";
    const FORMULA: &'static [&'static str] = &["τ dp/dt = p_max - p", "A p ≥ S (F∥ + F⊥/µ + 2 e F∥/d), F = m (a - g)"];
    const SOURCE: &'static str = "J. Schmalz GmbH, Vacuum Knowledge (theoretical holding force, µ, S)";
    own_types!(moves Holds);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Grasp>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Grasp>) {
        let p = &self.p;
        let part = state.held.or(turn.seen.targets.first);
        let tight = match (part.is_some(), turn.failed.has(Failure::Torn)) {
            (false, _) => OPEN_PART,
            (true, true) => 0.5,
            (true, false) => 1.0,
        };
        let drawn = if inputs.on && !turn.failed.has(Failure::Clogged) { tight * p.vacuum_bar } else { 0.0 };
        let time_constant_s = if drawn > state.vacuum_bar { p.evacuate_s } else { p.vent_s };
        state.vacuum_bar = lag(state.vacuum_bar, drawn, time_constant_s, turn.dt_s);
        let area_m2 = FRAC_PI_4 * p.diameter_m * p.diameter_m;
        let suffices = area_m2 * state.vacuum_bar * BAR_PA >= self.needed_n(turn.seen.load);
        if state.held.is_some() && !suffices {
            state.vacuum_bar = 0.0;
        }
        state.held = part.filter(|_| suffices);
    }

    fn effect(&self, state: &State) -> Hold {
        Hold { target: state.held, yield_s: self.p.yield_s }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Grasp>) -> Outputs {
        Outputs {
            vacuum_bar: state.vacuum_bar,
            switch: state.vacuum_bar >= self.p.switch_bar,
            holding: state.held.is_some(),
            load_n: if state.held.is_some() { turn.seen.load.force_n } else { 0.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, grasped};

    const ON: Inputs = Inputs { on: true };
    const OFF: Inputs = Inputs { on: false };

    fn rig(count: u32) -> Rig<VacuumCup> {
        let mut rig = Rig::new(VacuumCup::new(Parameters::default()));
        rig.seen = grasped(count, 2.0 * 9.806_65);
        rig
    }

    #[test]
    fn the_vacuum_builds_up_by_its_closed_form_and_then_holds() {
        // A p = m g of 2 kg at p = 0.1561 bar, after τ ln(0.8/(0.8 - 0.1561)) = 10.9 ms
        let mut rig = rig(1);
        assert!(!rig.run(ON, 0.001, 10).holding && rig.run(ON, 0.001, 1).holding);
        let out = rig.run(ON, 0.001, 39);
        // fifty factors, each rounded to 2^-53
        assert!((out.vacuum_bar - 0.8 * (1.0 - libm::exp(-1.0))).abs() < 1e-14 && out.switch, "{out:?}");
        let out = rig.run(OFF, 0.001, 100);
        assert!(!out.holding && !out.switch);
    }

    #[test]
    fn what_it_holds_is_what_makers_say() {
        // A p = π/4 · 0.04² · 0.8 bar = 100.53 N
        let holds = |load: Load| {
            let mut rig = rig(1);
            rig.run(ON, 0.01, 100);
            rig.seen.load = load;
            let out = rig.run(ON, 0.01, 1);
            assert!(out.holding || out.vacuum_bar == 0.0, "air rushes in: {out:?}");
            out.holding
        };
        let all_alike = |force_n: f64| Load { force_n, pull_n: None, beside_m: 0.0 };
        assert!(holds(all_alike(100.5)) && !holds(all_alike(100.6)));
        // horizontal cup: m (g + a/µ)
        let horizontal =
            |kg: f64, a: f64| Load { force_n: kg * 9.81_f64.hypot(a), pull_n: Some(kg * 9.81), beside_m: 0.0 };
        assert!(holds(horizontal(5.0, 5.1)) && !holds(horizontal(5.0, 5.2)), "5 (9.81 + 5.15/0.5) = 100.5 N");
        // vertical cup: m (g + a)/µ
        let vertical = |kg: f64| Load { force_n: kg * 9.81, pull_n: Some(0.0), beside_m: 0.0 };
        assert!(holds(vertical(5.1)) && !holds(vertical(5.2)));
        // 20 mm beside a cup of 40 mm doubles what pulls
        let beside = |kg: f64| Load { force_n: kg * 9.81, pull_n: Some(kg * 9.81), beside_m: 0.02 };
        assert!(holds(beside(5.1)) && !holds(beside(5.2)));
        // what presses asks for nothing
        assert!(holds(Load { force_n: 1e4, pull_n: Some(-1e4), beside_m: 0.0 }));
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
