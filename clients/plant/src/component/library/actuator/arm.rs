//! An arm that grips and drops packages, with reversed logic.
//!
//! # Equations
//! - the signal `drop` false is `Grip`, true is `Drop`; `hold` is the same the right way round;
//! - on gripping, the arm holds fast the first target that touches its body, until it drops it;
//! - it loses what asks for more than `force_n`: `m |a - g|` of what it really carries.
//!
//! # Source
//! class Arm of the filling machine (Sivtoft 2002, 4.2.3 and A5).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::{Grasp, Hold, Holds};

parameters! {
    /// Its parameters.
    Parameters {
        /// greatest force that it holds with
        force_n: f64 = 1000.0 => 0.0, 1e9;
        /// over this time what lies between it and the part spreads a blow; 2 kg on 5 N/mm give √(m/k) = 0.02
        yield_s: f64 = 0.02 => 0.0, 10.0;
    }
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
        /// force that the held part asks for
        load_n: f64,
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
    /// It has lost what it held, and grips again only after it has let go.
    lost: bool,
}

/// An arm that grips and drops packages, with reversed logic.
pub(crate) struct Arm {
    p: Parameters,
}

impl Component for Arm {
    const NAME: &'static str = "arm";
    const SUMMARY: &'static str = "arm with reversed logic: false grips, true drops";
    const FORMULA: &'static [&'static str] =
        &["drop = false or hold: holds what touches it, while m |a - g| ≤ force_n", "drop = true: lets go"];
    const SOURCE: &'static str = "class Arm of the filling machine (Sivtoft 2002, 4.2.3 and A5)";
    own_types!(moves Holds);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Grasp>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Grasp>) {
        let drop = inputs.drop && !inputs.hold && !turn.failed.has(Failure::Stuck);
        let wanted = state.held.or(turn.seen.targets.first);
        if drop || wanted.is_none() {
            *state = State { held: None, lost: state.lost && !drop };
            return;
        }
        let holds = turn.seen.load.force_n <= self.p.force_n && !turn.failed.has(Failure::Weak) && !state.lost;
        *state = State { held: wanted.filter(|_| holds), lost: state.lost || (state.held.is_some() && !holds) };
    }

    fn effect(&self, state: &State) -> Hold {
        Hold { target: state.held, yield_s: self.p.yield_s }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Grasp>) -> Outputs {
        let load_n = if state.held.is_some() { turn.seen.load.force_n } else { 0.0 };
        Outputs { holding: state.held.is_some(), load_n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, grasped};

    const GRIP: Inputs = Inputs { drop: false, hold: false };
    const DROP: Inputs = Inputs { drop: true, hold: false };
    const HOLD: Inputs = Inputs { drop: true, hold: true };

    fn rig() -> Rig<Arm> {
        let mut rig = Rig::new(Arm::new(Parameters::default()));
        rig.seen = grasped(1, 20.0);
        rig
    }

    #[test]
    fn false_grips_and_true_drops() {
        let mut rig = rig();
        assert!(!rig.run(DROP, 0.01, 1).holding && rig.run(GRIP, 0.01, 1).holding);
        rig.seen = grasped(0, 20.0);
        assert!(rig.run(GRIP, 0.01, 1).holding, "held, whether it touches or not");
        assert_eq!(rig.component.effect(&rig.state).target, Some(0));
        assert!(!rig.run(DROP, 0.01, 1).holding && !rig.run(GRIP, 0.01, 1).holding, "nothing there");
    }

    #[test]
    fn hold_is_the_right_way_round() {
        let mut rig = rig();
        assert!(rig.run(HOLD, 0.01, 1).holding && !rig.run(DROP, 0.01, 1).holding);
    }

    #[test]
    fn what_asks_for_too_much_is_lost_until_the_next_grip() {
        let mut rig = rig();
        assert!(rig.run(GRIP, 0.01, 1).holding);
        rig.seen = grasped(1, 1000.1);
        assert!(!rig.run(GRIP, 0.01, 1).holding);
        rig.seen = grasped(1, 20.0);
        assert!(!rig.run(GRIP, 0.01, 5).holding, "it does not catch what it has lost");
        assert!(!rig.run(DROP, 0.01, 1).holding && rig.run(GRIP, 0.01, 1).holding);
        rig.seen = grasped(1, 1000.1);
        rig.state = State::default();
        assert!(!rig.run(GRIP, 0.01, 1).holding, "too heavy from the start");
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(!rig().failing(Failure::Weak).run(GRIP, 0.01, 1).holding);
        assert!(rig().failing(Failure::Stuck).run(DROP, 0.01, 1).holding);
    }
}
