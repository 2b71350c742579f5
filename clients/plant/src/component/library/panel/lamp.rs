//! A signal lamp.
//!
//! # Equations
//! - brightness `τ dy/dt = u - y`, with τ = 0 for a light-emitting diode; `lit` above one half.
//!
//! # Source
//! closed form.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;

parameters! {
    /// Its parameters.
    Parameters {
        /// time constant of the filament; 0: a diode
        warm_s: f64 = 0.0 => 0.0, 10.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// switched on
        on: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// it can be seen to be on
        lit: bool,
        /// brightness, 0 to 1
        brightness: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it is burnt
        Burnt = "burnt",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    brightness: f64,
}

/// A signal lamp, by its parameters.
pub(crate) struct Lamp {
    p: Parameters,
}

impl Component for Lamp {
    const NAME: &'static str = "lamp";
    const SUMMARY: &'static str = "signal lamp";
    const FORMULA: &'static [&'static str] = &["τ dy/dt = u - y"];
    const SOURCE: &'static str = "closed form";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let on = inputs.on && !turn.failed.has(Failure::Burnt);
        state.brightness = lag(state.brightness, f64::from(u8::from(on)), self.p.warm_s, turn.dt_s);
        Outputs { lit: state.brightness > 0.5, brightness: state.brightness }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const ON: Inputs = Inputs { on: true };

    #[test]
    fn a_filament_needs_its_time() {
        let mut rig = Rig::new(Lamp::new(Parameters { warm_s: 0.1 }));
        // one half after τ ln 2 = 69 ms
        assert!(!rig.run(ON, 0.001, 69).lit && rig.run(ON, 0.001, 1).lit);
        assert!(Rig::new(Lamp::new(Parameters::default())).run(ON, 0.01, 1).lit);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let mut rig = Rig::new(Lamp::new(Parameters::default())).failing(Failure::Burnt);
        assert!(!rig.run(ON, 0.01, 5).lit);
    }
}
