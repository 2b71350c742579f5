//! A parallel gripper with a stroke.
//!
//! # Equations
//! - the jaws close and open at a constant speed over `stroke_s`;
//! - what touches the body when the jaws meet it, at `grip_pct` of their way, is held fast until they open.
//!
//! # Source
//! closed form.

use serde::{Deserialize, Serialize};

use crate::plant::component::behaviour::{Component, Start, Turn};
use crate::plant::component::declare::{failures, own_types, parameters, signals};
use crate::plant::component::dynamics::ramp;
use crate::plant::coupling::{Hold, Holds, Targets};

parameters! {
    /// Its parameters.
    Parameters {
        /// from open to closed
        stroke_s: f64 = 0.2 => 0.001, 60.0;
        /// where on their way the jaws meet a part
        grip_pct: f64 = 60.0 => 0.0, 100.0;
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
}

/// A parallel gripper with a stroke, by its parameters.
pub(crate) struct Gripper {
    p: Parameters,
}

impl Component for Gripper {
    const NAME: &'static str = "gripper";
    const SUMMARY: &'static str = "parallel gripper: closes over its stroke and holds what it meets";
    const FORMULA: &'static [&'static str] = &["d way/dt = ±1/stroke_s", "holds from way = grip_pct on"];
    const SOURCE: &'static str = "closed form";
    own_types!(moves Holds);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Targets>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Targets>) {
        let grip = 0.01 * self.p.grip_pct;
        if turn.failed.has(Failure::Worn) {
            state.held = None;
        }
        if turn.failed.has(Failure::Jammed) {
            return;
        }
        let before = state.way;
        let most = if state.held.is_some() { grip } else { 1.0 };
        state.way = ramp(before, if inputs.close { most } else { 0.0 }, 1.0 / self.p.stroke_s, turn.dt_s);
        if !inputs.close {
            state.held = None;
        } else if before < grip && state.way >= grip && !turn.failed.has(Failure::Worn) {
            state.held = turn.seen.first;
            state.way = if state.held.is_some() { grip } else { state.way };
        }
    }

    fn effect(&self, state: &State) -> Hold {
        Hold(state.held)
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn<Targets>) -> Outputs {
        Outputs { opened: state.way <= 0.0, shut: state.way >= 1.0, holding: state.held.is_some() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::component::tests::{Rig, touched};

    const CLOSE: Inputs = Inputs { close: true };
    const OPEN: Inputs = Inputs { close: false };

    fn rig(count: u32) -> Rig<Gripper> {
        let mut rig = Rig::new(Gripper::new(Parameters::default()));
        rig.seen = touched(count);
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
        assert!(rig(1).failing(Failure::Worn).run(CLOSE, 0.01, 50).shut);
    }
}
