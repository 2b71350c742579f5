//! A sink of workpieces: what touches it leaves the world.
//!
//! # Equations
//! - the first target that touches the body is taken out, one in each period;
//! - a target that something holds is taken only when it is let go;
//! - it can appear again at a source that has it among its targets.
//!
//! # Source
//! closed form.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::{Collect, Remove, Targets};

parameters! {
    /// Its parameters.
    Parameters {}
}

signals! {
    /// What it takes.
    Inputs {
        /// takes workpieces out
        enable: bool = true,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// how many have gone
        count: i32,
        /// one went in this scan
        taken: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it takes nothing: workpieces pile up
        Blocked = "blocked",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    taking: Option<u32>,
    count: i32,
}

/// A sink of workpieces.
pub(crate) struct WorkpieceSink;

impl Component for WorkpieceSink {
    const NAME: &'static str = "workpiece_sink";
    const SUMMARY: &'static str = "sink of workpieces: what touches it leaves the world";
    const FORMULA: &'static [&'static str] = &["one target that touches it, each period"];
    const SOURCE: &'static str = "closed form";
    own_types!(moves Collect);

    fn new(_: Parameters) -> Self {
        Self
    }

    fn initial(&self, _: &Start<Targets>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Targets>) {
        let open = inputs.enable && !turn.failed.has(Failure::Blocked);
        state.taking = if open { turn.seen.first } else { None };
        state.count = state.count.saturating_add(i32::from(state.taking.is_some()));
    }

    fn effect(&self, state: &State) -> Remove {
        Remove(state.taking)
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn<Targets>) -> Outputs {
        Outputs { count: state.count, taken: state.taking.is_some() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, touched};

    #[test]
    fn it_takes_one_at_a_time() {
        let mut rig = Rig::new(WorkpieceSink::new(Parameters {}));
        assert_eq!(rig.run(Inputs { enable: true }, 0.01, 3).count, 0);
        rig.seen = touched(2);
        assert_eq!(rig.run(Inputs { enable: true }, 0.01, 1).count, 1);
        assert_eq!(rig.component.effect(&rig.state), Remove(Some(0)));
        assert!(!rig.run(Inputs { enable: false }, 0.01, 1).taken);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let mut rig = Rig::new(WorkpieceSink::new(Parameters {})).failing(Failure::Blocked);
        rig.seen = touched(1);
        assert_eq!(rig.run(Inputs { enable: true }, 0.01, 5).count, 0);
    }
}
