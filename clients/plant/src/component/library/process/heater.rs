//! A heater on a thermal mass that loses heat to its surroundings.
//!
//! # Equations
//! - `C dϑ/dt = P k - G (ϑ - ϑ_a)`, exact over a period for a constant command:
//!   `ϑ → ϑ_∞ = ϑ_a + P k/G` with time constant `C/G`.
//!
//! # Source
//! Newton's law of cooling, in closed form.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use crate::component::kind::Dependence;

parameters! {
    /// Its parameters.
    Parameters {
        /// power at the full command
        power_w: f64 = 2000.0 => 0.0, 1e9;
        /// heat capacity of what is heated
        capacity_j_k: f64 = 5000.0 => 1e-3, 1e12;
        /// loss to the surroundings
        loss_w_k: f64 = 10.0 => 1e-6, 1e9;
        /// temperature of the surroundings
        ambient_degc: f64 = 20.0 => -100.0, 1000.0;
        /// temperature at the set-up
        initial_degc: f64 = 20.0 => -100.0, 3000.0;
        /// the overheat contact opens here
        overheat_degc: f64 = 300.0 => -100.0, 3000.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// contactor
        on: bool,
        /// part of the power, 0 to 1
        fraction: f64 = 1.0,
        /// heat from elsewhere
        heat_w: f64,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// temperature
        temperature_degc: f64,
        /// electric power
        power_w: f64,
        /// overheat contact
        overheat: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the element is burnt: no power
        Burnt = "burnt",
        /// the contactor is welded: full power
        Welded = "welded",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    temperature_degc: f64,
    power_w: f64,
}

/// A heater on a thermal mass that loses heat to its surroundings, by its parameters.
pub(crate) struct Heater {
    p: Parameters,
}

impl Component for Heater {
    const NAME: &'static str = "heater";
    const SUMMARY: &'static str = "heater with a thermal mass";
    const FORMULA: &'static [&'static str] = &["C dϑ/dt = P k - G (ϑ - ϑ_a)"];
    const SOURCE: &'static str = "Newton's law of cooling, in closed form";
    const DEPENDENCES: &'static [Dependence] = &[Dependence { inputs: &["fraction"], on: &["on"] }];
    const INITIAL: &'static [&'static str] = &["initial_degc"];
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State { temperature_degc: self.p.initial_degc, power_w: 0.0 }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let p = &self.p;
        let commanded = if inputs.on { inputs.fraction.clamp(0.0, 1.0) } else { 0.0 };
        let part = match (turn.failed.has(Failure::Burnt), turn.failed.has(Failure::Welded)) {
            (true, _) => 0.0,
            (false, true) => 1.0,
            (false, false) => commanded,
        };
        state.power_w = part * p.power_w;
        let final_degc = p.ambient_degc + (state.power_w + inputs.heat_w) / p.loss_w_k;
        state.temperature_degc = lag(state.temperature_degc, final_degc, p.capacity_j_k / p.loss_w_k, turn.dt_s);
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn) -> Outputs {
        Outputs {
            temperature_degc: state.temperature_degc,
            power_w: state.power_w,
            overheat: state.temperature_degc >= self.p.overheat_degc,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const ON: Inputs = Inputs { on: true, fraction: 1.0, heat_w: 0.0 };

    fn rig() -> Rig<Heater> {
        Rig::new(Heater::new(Parameters::default()))
    }

    #[test]
    fn it_warms_up_by_its_closed_form_at_any_period() {
        for dt_s in [0.1, 10.0] {
            let out = rig().run(ON, dt_s, (500.0 / dt_s) as u32);
            // 220 °C at the end, time constant 500 s; five thousand factors are rounded
            assert!((out.temperature_degc - (220.0 - 200.0 * libm::exp(-1.0))).abs() < 1e-9, "{out:?}");
        }
    }

    #[test]
    fn energy_is_kept_in_balance() {
        let (mut rig, mut lost_j) = (rig(), 0.0);
        let mut before = 20.0;
        for _ in 0..10_000 {
            let now = rig.run(ON, 0.1, 1).temperature_degc;
            lost_j += 10.0 * (0.5 * (before + now) - 20.0) * 0.1;
            before = now;
        }
        // trapezoid rule: dt²/12 of the slope's change, 4e-4 J
        assert!((2000.0 * 1000.0 - lost_j - 5000.0 * (before - 20.0)).abs() < 1e-2);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(rig().failing(Failure::Burnt).run(ON, 1.0, 100).temperature_degc, 20.0);
        assert_eq!(rig().failing(Failure::Welded).run(Inputs { on: false, ..ON }, 1.0, 1).power_w, 2000.0);
        let mut hot = rig();
        assert!(!hot.run(ON, 1.0, 100).overheat && hot.run(Inputs { heat_w: 2000.0, ..ON }, 10.0, 1000).overheat);
    }
}
