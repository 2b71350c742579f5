//! A parallel gripper with a stroke.
//!
//! # Equations
//! - the jaws close and open at a constant speed over `stroke_s`;
//! - what touches the body when the jaws meet it, at `grip_pct` of their way, is held until they open;
//! - it is held by friction on both jaws: `|F⊥| (1 + e/r) ≤ 2 µ F_jaw / S` across the closing direction, `|F∥| ≤ F_jaw / S`
//!   along it, for the force `F = m (a - g)` of what it really carries, whose centre of mass is e beside the
//!   pads of radius r. Otherwise it slips out.
//!
//! # Source
//! Coulomb's friction, as makers size grippers: SCHUNK, Gripping Hand in Hand, 2015 (F = m (g + a) S / (2 µ) a jaw;
//! µ 0.1 to 0.2 for steel on steel, 0.3 to 0.5 for rubber pads; S 2 to 4 in design, 1 where parts really slip).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::ramp;
use crate::coupling::{Grasp, Hold, Holds, Load};

parameters! {
    /// Its parameters.
    Parameters {
        /// from open to closed
        stroke_s: f64 = 0.2 => 0.001, 60.0;
        /// where on their way the jaws meet a part
        grip_pct: f64 = 60.0 => 0.0, 100.0;
        /// force of each jaw
        jaw_n: f64 = 500.0 => 0.0, 1e7;
        /// coefficient of friction between pads and part
        friction: f64 = 0.3 => 0.0, 10.0;
        /// radius of the pads that resists a moment
        pad_m: f64 = 0.02 => 1e-4, 10.0;
        /// reserve: a part is lost at this part of the force; 1 is where it really slips
        safety_ratio: f64 = 1.0 => 1.0, 100.0;
        /// over this time the pads spread a blow; 2 kg on 5 N/mm give √(m/k) = 0.02
        yield_s: f64 = 0.02 => 0.0, 10.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// closes; opens while false
        close: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// the jaws are open
        opened: bool,
        /// the jaws met nothing and are shut
        shut: bool,
        /// it holds a part
        holding: bool,
        /// force that the held part asks for
        load_n: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the jaws do not move
        Jammed = "jammed",
        /// the pads are worn: parts slip out
        Worn = "worn",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    held: Option<u32>,
    way: f64,
    /// The jaws have met a part and stand at it, whether it is held or has slipped.
    met: bool,
}

/// A parallel gripper with a stroke, by its parameters.
pub(crate) struct Gripper {
    p: Parameters,
}

impl Gripper {
    /// Whether the friction of the pads and the force of the jaws suffice.
    fn suffices(&self, load: Load) -> bool {
        let p = &self.p;
        let jaw_n = p.jaw_n / p.safety_ratio;
        let slipping_n = load.aside_n() * (1.0 + load.beside_m / p.pad_m);
        slipping_n <= 2.0 * p.friction * jaw_n && load.pull_n.map_or(0.0, f64::abs) <= jaw_n
    }
}

impl Component for Gripper {
    const NAME: &'static str = "gripper";
    const SUMMARY: &'static str = "parallel gripper: closes over its stroke and holds what it meets";
    const FORMULA: &'static [&'static str] = &[
        "d way/dt = ±1/stroke_s",
        "holds from way = grip_pct on, while |F⊥| (1 + e/r) ≤ 2 µ F_jaw/S and |F∥| ≤ F_jaw/S, F = m (a - g)",
    ];
    const SOURCE: &'static str = "Coulomb's friction; SCHUNK, Gripping Hand in Hand, 2015 (sizing by S and µ)";
    own_types!(moves Holds);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Grasp>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Grasp>) {
        let grip = 0.01 * self.p.grip_pct;
        if turn.failed.has(Failure::Worn) || !self.suffices(turn.seen.load) {
            state.held = None;
        }
        if turn.failed.has(Failure::Jammed) {
            return;
        }
        let before = state.way;
        state.met &= inputs.close && (state.held.is_some() || turn.seen.targets.count > 0);
        let most = if state.met { grip } else { 1.0 };
        state.way = ramp(before, if inputs.close { most } else { 0.0 }, 1.0 / self.p.stroke_s, turn.dt_s);
        if !inputs.close {
            state.held = None;
        } else if before < grip && state.way >= grip && turn.seen.targets.count > 0 {
            let holds = self.suffices(turn.seen.load) && !turn.failed.has(Failure::Worn);
            *state = State { held: turn.seen.targets.first.filter(|_| holds), way: grip, met: true };
        }
    }

    fn effect(&self, state: &State) -> Hold {
        Hold { target: state.held, yield_s: self.p.yield_s }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Grasp>) -> Outputs {
        let holding = state.held.is_some();
        let load_n = if holding { turn.seen.load.force_n } else { 0.0 };
        Outputs { opened: state.way <= 0.0, shut: state.way >= 1.0, holding, load_n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, grasped};

    const CLOSE: Inputs = Inputs { close: true };
    const OPEN: Inputs = Inputs { close: false };

    fn rig(count: u32) -> Rig<Gripper> {
        let mut rig = Rig::new(Gripper::new(Parameters::default()));
        rig.seen = grasped(count, 50.0);
        rig
    }

    #[test]
    fn it_holds_a_part_at_its_place_on_the_way() {
        let mut rig = rig(1);
        assert!(!rig.run(CLOSE, 0.01, 11).holding && rig.run(CLOSE, 0.01, 2).holding);
        let out = rig.run(CLOSE, 0.01, 50);
        assert!(out.holding && !out.shut && rig.state.way == 0.6);
        assert!(!rig.run(OPEN, 0.01, 1).holding && rig.run(OPEN, 0.01, 13).opened);
    }

    #[test]
    fn without_a_part_it_shuts() {
        assert!(rig(0).run(CLOSE, 0.01, 21).shut);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(rig(1).failing(Failure::Jammed).run(CLOSE, 0.01, 50).opened);
        let worn = rig(1).failing(Failure::Worn).run(CLOSE, 0.01, 50);
        assert!(!worn.holding && !worn.shut, "the jaws stand at a part that slips: {worn:?}");
    }

    #[test]
    fn friction_holds_across_the_jaws_and_force_along_them() {
        // 2 · 0.3 · 500 N = 300 N across, 500 N along; half of it 20 mm beside pads of 20 mm
        let load = |aside_n: f64, pull_n: f64, beside_m: f64| Load {
            force_n: (aside_n * aside_n + pull_n * pull_n).sqrt(),
            pull_n: Some(pull_n),
            beside_m,
        };
        let holds = |load: Load| {
            let mut rig = rig(1);
            rig.run(CLOSE, 0.01, 20);
            rig.seen.load = load;
            let out = rig.run(CLOSE, 0.01, 1);
            assert!(!out.shut && (!out.holding || out.load_n == load.force_n));
            rig.seen.load = Load::default();
            assert_eq!(rig.run(CLOSE, 0.01, 50).holding, out.holding, "it does not catch what has slipped");
            out.holding
        };
        assert!(holds(load(299.0, 0.0, 0.0)) && !holds(load(301.0, 0.0, 0.0)));
        assert!(holds(load(0.0, -499.0, 0.0)) && !holds(load(0.0, 501.0, 0.0)));
        assert!(holds(load(149.0, 0.0, 0.02)) && !holds(load(151.0, 0.0, 0.02)));
        let all_alike = |force_n: f64| Load { force_n, pull_n: None, beside_m: 0.0 };
        assert!(holds(all_alike(299.0)) && !holds(all_alike(301.0)));
    }
}
