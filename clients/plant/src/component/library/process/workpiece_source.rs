//! A source of workpieces: bodies that come into the world.
//!
//! # Equations
//! - its targets are out of the world at the set-up;
//! - while `enable` is true one appears each `interval_s` at the place of its body, at rest; the first at once; on a rising `release` one appears as well;
//! - when none is left outside it waits for a sink to take one out;
//! - where its body has a shape it waits until none of its targets is in it.
//!
//! # Source
//! closed form.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::is_over;
use crate::coupling::{Place, Put, Targets};

parameters! {
    /// Its parameters.
    Parameters {
        /// from one to the next
        interval_s: f64 = 1.0 => 0.001, 1e6;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// one after the other
        enable: bool,
        /// rising: one more
        release: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// how many have come
        count: i32,
        /// how many wait outside
        waiting: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// nothing comes
        Empty = "empty",
        /// two come in one interval
        Doubled = "doubled",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    since_s: Option<f64>,
    released: bool,
    placing: Option<u32>,
    count: i32,
}

/// A source of workpieces, by its parameters.
pub(crate) struct WorkpieceSource {
    p: Parameters,
}

impl Component for WorkpieceSource {
    const NAME: &'static str = "workpiece_source";
    const SUMMARY: &'static str = "source of workpieces, in intervals or on demand";
    const FORMULA: &'static [&'static str] = &["one each interval_s, or on a rising release"];
    const SOURCE: &'static str = "closed form";
    own_types!(moves Place);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Targets>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Targets>) {
        let before = std::mem::replace(&mut state.released, inputs.release);
        let asked = inputs.release && !before;
        // time runs while it is enabled
        let since_s = state.since_s.map(|since_s| since_s + turn.dt_s);
        let half = turn.failed.has(Failure::Doubled);
        let interval_s = if half { 0.5 * self.p.interval_s } else { self.p.interval_s };
        let due = inputs.enable && since_s.is_none_or(|since_s| is_over(since_s, interval_s));
        state.since_s = if inputs.enable { since_s.or(Some(0.0)) } else { None };
        state.placing = None;
        if (due || asked) && !turn.failed.has(Failure::Empty) && turn.seen.first.is_some() {
            state.placing = turn.seen.first;
            state.count = state.count.saturating_add(1);
            state.since_s = if due { Some(0.0) } else { state.since_s };
        }
    }

    fn effect(&self, state: &State) -> Put {
        Put(state.placing)
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Targets>) -> Outputs {
        Outputs { count: state.count, waiting: turn.seen.count as i32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, touched};

    const ON: Inputs = Inputs { enable: true, release: false };
    const ASK: Inputs = Inputs { enable: false, release: true };

    fn rig() -> Rig<WorkpieceSource> {
        let mut rig = Rig::new(WorkpieceSource::new(Parameters::default()));
        rig.seen = touched(2);
        rig
    }

    #[test]
    fn one_comes_each_interval_and_the_first_at_once() {
        let mut rig = rig();
        let counts: Vec<_> = (0..4).map(|_| rig.run(ON, 0.1, 10).count).collect();
        assert_eq!((counts, rig.run(ON, 0.1, 1).count), (vec![1, 2, 3, 4], 5));
        rig.seen = touched(0);
        assert_eq!(rig.run(ON, 0.1, 50).count, 5, "none is left");
    }

    #[test]
    fn one_comes_for_each_request() {
        let mut rig = rig();
        assert_eq!(rig.run(ASK, 0.1, 5).count, 1);
        rig.run(Inputs { release: false, ..ASK }, 0.1, 1);
        assert_eq!(rig.run(ASK, 0.1, 5).count, 2);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(rig().failing(Failure::Empty).run(ON, 0.1, 50).count, 0);
        assert_eq!(rig().failing(Failure::Doubled).run(ON, 0.1, 10).count, 2);
    }
}
