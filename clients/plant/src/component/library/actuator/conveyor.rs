//! A conveyor belt: a surface that runs with a ramp, and carries what lies on it.
//!
//! # Equations
//! - `dv/dt = ±a` until `v = k v_N`, with k the commanded part of the rated speed;
//! - travel `∫ v dt`, exact over a ramp.
//!
//! Friction between belt and load is the engine's, between the two bodies. A load that is held back
//! slips: the belt goes on below it, and loads accumulate.
//!
//! # Source
//! A ramp in closed form; speed levels: the conveyor of the filling machine (Sivtoft 2002, ch. 5).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::kind::Dependence;
use crate::coupling::{Belt, Run};
use crate::setpoint::{Bounds, Setpoint};

parameters! {
    /// A belt and its drive.
    Parameters {
        /// speed at the full command
        speed_m_s: f64 = 0.5 => 1e-6, 100.0;
        /// of every ramp
        acceleration_m_s2: f64 = 1.0 => 1e-6, 1e5;
    }
}

signals! {
    /// Contactors or inverter.
    Inputs {
        /// runs
        run: bool,
        /// runs the other way
        reverse: bool,
        /// part of the rated speed, from 0 to 1
        fraction: f64 = 1.0,
    }
}

signals! {
    /// Feedback of the drive.
    Outputs {
        /// the belt moves
        running: bool,
        /// velocity of the belt
        velocity_m_s: f64,
        /// way of the belt since the set-up
        travel_m: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the belt stands at once and stays
        Torn = "torn",
        /// the drum slips: half the speed
        Slipping = "slipping",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    belt: Setpoint,
    /// Mean velocity of this period, which the world runs with.
    mean_m_s: f64,
}

/// A conveyor by its parameters.
pub(crate) struct Conveyor {
    p: Parameters,
}

impl Component for Conveyor {
    const NAME: &'static str = "conveyor";
    const SUMMARY: &'static str = "conveyor belt with a ramp, which carries what lies on it";
    const FORMULA: &'static [&'static str] = &["dv/dt = ±a until v = k v_N", "travel = ∫ v dt"];
    const SOURCE: &'static str = "closed form; speed levels: Sivtoft 2002, ch. 5";
    const DEPENDENCES: &'static [Dependence] = &[Dependence { inputs: &["fraction", "reverse"], on: &["run"] }];
    own_types!(moves Belt);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State { belt: Setpoint::default(), mean_m_s: 0.0 }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        if turn.dt_s <= 0.0 {
            return;
        }
        if turn.failed.has(Failure::Torn) {
            state.belt.velocity = 0.0;
            state.mean_m_s = 0.0;
            return;
        }
        let grip = if turn.failed.has(Failure::Slipping) { 0.5 } else { 1.0 };
        let way = if inputs.reverse { -1.0 } else { 1.0 };
        let part = if inputs.run { way * grip * inputs.fraction.clamp(0.0, 1.0) } else { 0.0 };
        let bounds = Bounds::unlimited(self.p.speed_m_s, self.p.acceleration_m_s2);
        let before = state.belt;
        state.belt = before.towards_velocity(part * self.p.speed_m_s, &bounds, turn.dt_s);
        state.mean_m_s = (state.belt.position - before.position) / turn.dt_s;
    }

    fn effect(&self, state: &State) -> Run {
        Run { velocity_m_s: state.mean_m_s }
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn) -> Outputs {
        Outputs {
            running: state.belt.velocity != 0.0,
            velocity_m_s: state.belt.velocity,
            travel_m: state.belt.position,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const RUN: Inputs = Inputs { run: true, reverse: false, fraction: 1.0 };

    fn rig() -> Rig<Conveyor> {
        Rig::new(Conveyor::new(Parameters::default()))
    }

    #[test]
    fn its_travel_is_that_of_a_ramp_at_any_period() {
        for dt_s in [0.001, 0.01, 0.07] {
            let out = rig().run(RUN, dt_s, 100);
            let t = 100.0 * dt_s;
            let exact = if t < 0.5 { 0.5 * t * t } else { 0.125 + 0.5 * (t - 0.5) };
            // a hundred additions of numbers below 4, each rounded to 2^-52
            assert!((out.travel_m - exact).abs() < 1e-13, "{dt_s}");
        }
    }

    #[test]
    fn half_a_command_and_the_other_way() {
        let mut rig = rig();
        assert_eq!(rig.run(Inputs { fraction: 0.5, ..RUN }, 0.01, 100).velocity_m_s, 0.25);
        assert_eq!(rig.run(Inputs { reverse: true, ..RUN }, 0.01, 100).velocity_m_s, -0.5);
        assert!(!rig.run(Inputs { run: false, ..RUN }, 0.01, 60).running);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(rig().failing(Failure::Slipping).run(RUN, 0.01, 100).velocity_m_s, 0.25);
        let torn = rig().failing(Failure::Torn).run(RUN, 0.01, 100);
        assert_eq!((torn.travel_m, torn.running), (0.0, false));
    }
}
