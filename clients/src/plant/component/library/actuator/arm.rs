//! An arm that grips and drops packages, with reversed logic.
//!
//! # Equations
//! - the signal `drop` false is `Grip`, true is `Drop`; `hold` is the same the right way round;
//! - on gripping, the arm holds fast the first target that touches its body, until it drops it.
//!
//! # Source
//! class Arm of the filling machine (Sivtoft 2002, 4.2.3 and A5).

use serde::{Deserialize, Serialize};

use crate::plant::component::behaviour::{Component, Start, Turn};
use crate::plant::component::declare::{failures, own_types, parameters, signals};
use crate::plant::coupling::{Hold, Holds, Targets};

parameters! {
    /// Its parameters.
    Parameters {}
}

signals! {
    /// What it takes.
    Inputs {
        /// true lets go, false grips
        drop: bool = true,
        /// true grips, whatever `drop` says
        hold: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// it holds something
        holding: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it never lets go
        Stuck = "stuck",
        /// it grips nothing, and loses what it has
        Weak = "weak",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    held: Option<u32>,
}

/// An arm that grips and drops packages, with reversed logic.
pub(crate) struct Arm;

impl Component for Arm {
    const NAME: &'static str = "arm";
    const SUMMARY: &'static str = "arm with reversed logic: false grips, true drops";
    const FORMULA: &'static [&'static str] = &["drop = false or hold: holds what touches it", "drop = true: lets go"];
    const SOURCE: &'static str = "class Arm of the filling machine (Sivtoft 2002, 4.2.3 and A5)";
    own_types!(moves Holds);

    fn new(_: Parameters) -> Self {
        Self
    }

    fn initial(&self, _: &Start<Targets>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Targets>) {
        let drop = inputs.drop && !inputs.hold;
        state.held = match (drop && !turn.failed.has(Failure::Stuck), turn.failed.has(Failure::Weak)) {
            (true, _) | (_, true) => None,
            (false, false) => state.held.or(turn.seen.first),
        };
    }

    fn effect(&self, state: &State) -> Hold {
        Hold(state.held)
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn<Targets>) -> Outputs {
        Outputs { holding: state.held.is_some() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::component::tests::{Rig, touched};

    const GRIP: Inputs = Inputs { drop: false, hold: false };
    const DROP: Inputs = Inputs { drop: true, hold: false };
    const HOLD: Inputs = Inputs { drop: true, hold: true };

    fn rig() -> Rig<Arm> {
        let mut rig = Rig::new(Arm::new(Parameters {}));
        rig.seen = touched(1);
        rig
    }

    #[test]
    fn false_grips_and_true_drops() {
        let mut rig = rig();
        assert!(!rig.run(DROP, 0.01, 1).holding && rig.run(GRIP, 0.01, 1).holding);
        rig.seen = touched(0);
        assert!(rig.run(GRIP, 0.01, 1).holding, "held, whether it touches or not");
        assert_eq!(rig.component.effect(&rig.state), Hold(Some(0)));
        assert!(!rig.run(DROP, 0.01, 1).holding && !rig.run(GRIP, 0.01, 1).holding, "nothing there");
    }

    #[test]
    fn hold_is_the_right_way_round() {
        let mut rig = rig();
        assert!(rig.run(HOLD, 0.01, 1).holding && !rig.run(DROP, 0.01, 1).holding);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(!rig().failing(Failure::Weak).run(GRIP, 0.01, 1).holding);
        assert!(rig().failing(Failure::Stuck).run(DROP, 0.01, 1).holding);
    }
}
