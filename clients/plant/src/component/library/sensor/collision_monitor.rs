//! A collision monitor: bodies that should never meet.
//!
//! # Equations
//! - `touching`: pairs of targets that are in contact, as the engine's solver has it;
//! - `collisions` counts how often there came to be more of them.
//!
//! # Source
//! closed form; "the package will … crash into the waiting package" (Sivtoft 2002, 5.1).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::Meet;

parameters! {
    /// Its parameters.
    Parameters {}
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// some are in contact
        collided: bool,
        /// pairs that are in contact
        touching: i32,
        /// contacts made since the set-up
        collisions: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it sees nothing
        Blind = "blind",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    touching: u32,
    collisions: i32,
}

/// A collision monitor.
pub(crate) struct CollisionMonitor;

impl Component for CollisionMonitor {
    const NAME: &'static str = "collision_monitor";
    const SUMMARY: &'static str = "collision monitor: counts contacts between bodies that should never meet";
    const FORMULA: &'static [&'static str] = &["collisions += max(0, touching - touching a scan ago)"];
    const SOURCE: &'static str = "closed form; crash of packages in the filling machine (Sivtoft 2002, 5.1)";
    own_types!(senses Meet);

    fn new(_: Parameters) -> Self {
        Self
    }

    fn initial(&self, _: &Start<u32>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<u32>) -> Outputs {
        let touching = if turn.failed.has(Failure::Blind) { 0 } else { turn.seen };
        let made = touching.saturating_sub(state.touching);
        state.touching = touching;
        state.collisions = state.collisions.saturating_add_unsigned(made);
        Outputs { collided: touching > 0, touching: touching as i32, collisions: state.collisions }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    #[test]
    fn it_counts_contacts_that_are_made() {
        let mut rig = Rig::new(CollisionMonitor::new(Parameters {}));
        let counts: Vec<_> = [0, 1, 1, 2, 0, 1]
            .iter()
            .map(|count| {
                rig.seen = *count;
                rig.run(Inputs {}, 0.01, 1).collisions
            })
            .collect();
        assert_eq!(counts, [0, 1, 1, 2, 2, 3]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let mut rig = Rig::new(CollisionMonitor::new(Parameters {})).failing(Failure::Blind);
        rig.seen = 3;
        assert_eq!(rig.run(Inputs {}, 0.01, 2), Outputs::default());
    }
}
