//! An input controller: a whole number that sets the speed of a motor.
//!
//! # Equations
//! - `fraction = level / levels`, within 0 and 1: with two levels stop, half and full speed;
//! - `start` sets level 1, `hold` level 0, each while it is true; `hold` wins.
//!
//! # Source
//! class `InputController` of the filling machine (Sivtoft 2002, 4.2.3).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};

parameters! {
    /// Its parameters.
    Parameters {
        /// the level of full speed
        levels: u32 = 2 => 1.0, 1000.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// level, from 0
        level: i32,
        /// level 1, whatever `level` says
        start: bool,
        /// level 0, whatever else is said
        hold: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// part of the full speed
        fraction: f64,
        /// the level is not 0
        run: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it keeps its last level
        Stuck = "stuck",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    level: i32,
}

/// An input controller, by its parameters.
pub(crate) struct InputController {
    p: Parameters,
}

impl Component for InputController {
    const NAME: &'static str = "input_controller";
    const SUMMARY: &'static str = "input controller: levels of a speed, such as stop, half and full";
    const FORMULA: &'static [&'static str] = &["fraction = level / levels"];
    const SOURCE: &'static str = "class InputController of the filling machine (Sivtoft 2002, 4.2.3)";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        if !turn.failed.has(Failure::Stuck) {
            state.level = match (inputs.hold, inputs.start) {
                (true, _) => 0,
                (false, true) => 1,
                (false, false) => inputs.level.clamp(0, self.p.levels as i32),
            };
        }
        Outputs { fraction: f64::from(state.level) / f64::from(self.p.levels), run: state.level != 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn fraction(inputs: Inputs) -> f64 {
        Rig::new(InputController::new(Parameters::default())).run(inputs, 0.01, 1).fraction
    }

    const AT_REST: Inputs = Inputs { level: 0, start: false, hold: false };

    #[test]
    fn levels_are_stop_half_and_full() {
        let seen = [-1, 0, 1, 2, 3].map(|level| fraction(Inputs { level, ..AT_REST }));
        assert_eq!(seen, [0.0, 0.0, 0.5, 1.0, 1.0]);
        assert_eq!(fraction(Inputs { level: 2, start: true, hold: false }), 0.5);
        assert_eq!(fraction(Inputs { level: 2, start: true, hold: true }), 0.0);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let mut rig = Rig::new(InputController::new(Parameters::default())).failing(Failure::Stuck);
        assert!(!rig.run(Inputs { level: 2, ..AT_REST }, 0.01, 1).run);
    }
}
