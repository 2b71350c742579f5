//! A tank with a pump that fills it and a valve that empties it.
//!
//! # Equations
//! - `A dh/dt = q_in - q_out`, within the height; what does not fit overflows;
//! - `q_in = Q_P k_P`, with the pump's speed on its way through a lag;
//! - `q_out = μ a k_V √(2 g h)`: Torricelli, with the valve moving at a limited rate.
//!
//! # Method
//! Heun's, sub-steps of at most 10 ms: second order.
//!
//! # Source
//! E. Torricelli, De motu gravium (1643); flow coefficient: any hydraulics table.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{lag, ramp, substeps};
use crate::component::fluid::BAR_PA;

parameters! {
    /// Its parameters.
    Parameters {
        /// cross-section of the tank
        area_m2: f64 = 1.0 => 1e-6, 1e5;
        /// height up to the overflow
        height_m: f64 = 2.0 => 0.001, 1000.0;
        /// level at the set-up
        initial_m: f64 = 0.0 => 0.0, 1000.0;
        /// flow of the pump at its full command
        pump_m3_s: f64 = 0.01 => 0.0, 1000.0;
        /// time constant of the pump
        pump_s: f64 = 0.5 => 0.0, 1000.0;
        /// cross-section of the open valve
        valve_m2: f64 = 0.001 => 0.0, 100.0;
        /// from closed to open
        stroke_s: f64 = 1.0 => 0.0, 1000.0;
        /// flow coefficient of the valve
        flow_ratio: f64 = 0.62 => 0.01, 1.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// command of the pump, 0 to 1
        pump: f64,
        /// command of the valve, 0 to 1
        valve: f64,
        /// what flows in besides
        inflow_m3_s: f64,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// level
        level_m: f64,
        /// pressure at the bottom, of water, above the atmosphere
        bottom_bar: f64,
        /// flow in
        filled_m3_s: f64,
        /// flow out through the valve
        drained_m3_s: f64,
        /// it overflows
        overflow: bool,
        /// it is empty
        empty: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the pump stands
        PumpDead = "pump_dead",
        /// the valve stays where it is
        ValveStuck = "valve_stuck",
        /// a hole: a tenth of the open valve
        Leaking = "leaking",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    level_m: f64,
    pump: f64,
    valve: f64,
    filled_m3_s: f64,
    drained_m3_s: f64,
    overflow: bool,
}

/// A tank with a pump that fills it and a valve that empties it, by its parameters.
pub(crate) struct Tank {
    p: Parameters,
}

/// Longest sub-step.
const LONGEST_S: f64 = 0.01;
/// Standard acceleration of free fall.
const GRAVITY_M_S2: f64 = 9.806_65;
/// Water.
const WATER_KG_M3: f64 = 1000.0;

impl Tank {
    fn outflow(&self, opening: f64, level_m: f64) -> f64 {
        self.p.flow_ratio * self.p.valve_m2 * opening * (2.0 * GRAVITY_M_S2 * level_m).sqrt()
    }
}

impl Component for Tank {
    const NAME: &'static str = "tank";
    const SUMMARY: &'static str = "tank with a filling pump and an outlet valve";
    const FORMULA: &'static [&'static str] = &["A dh/dt = q_in - q_out", "q_in = Q_P k_P", "q_out = μ a k_V √(2 g h)"];
    const SOURCE: &'static str = "E. Torricelli, De motu gravium (1643); flow coefficient: any hydraulics table";
    const INITIAL: &'static [&'static str] = &["initial_m"];
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        (p.initial_m > p.height_m).then_some(Conflict { key: "initial_m", wanted: "a number up to `height_m`" })
    }

    fn initial(&self, _: &Start) -> State {
        State { level_m: self.p.initial_m, ..State::default() }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let p = &self.p;
        let (count, dt_s) = substeps(turn.dt_s, LONGEST_S);
        let alive = f64::from(u8::from(!turn.failed.has(Failure::PumpDead)));
        let hole = if turn.failed.has(Failure::Leaking) { 0.1 } else { 0.0 };
        state.overflow = false;
        for _ in 0..count {
            state.pump = lag(state.pump, alive * inputs.pump.clamp(0.0, 1.0), p.pump_s, dt_s);
            if !turn.failed.has(Failure::ValveStuck) {
                let wanted = inputs.valve.clamp(0.0, 1.0);
                state.valve = if p.stroke_s > 0.0 { ramp(state.valve, wanted, 1.0 / p.stroke_s, dt_s) } else { wanted };
            }
            let filled = p.pump_m3_s * state.pump + inputs.inflow_m3_s.max(0.0);
            let rate = |level: f64| (filled - self.outflow(state.valve + hole, level)) / p.area_m2;
            let first = rate(state.level_m);
            let second = rate((state.level_m + dt_s * first).max(0.0));
            let level = state.level_m + 0.5 * dt_s * (first + second);
            state.overflow |= level > p.height_m;
            state.level_m = level.clamp(0.0, p.height_m);
            state.filled_m3_s = filled;
            state.drained_m3_s = self.outflow(state.valve, state.level_m);
        }
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn) -> Outputs {
        Outputs {
            level_m: state.level_m,
            bottom_bar: WATER_KG_M3 * GRAVITY_M_S2 * state.level_m / BAR_PA,
            filled_m3_s: state.filled_m3_s,
            drained_m3_s: state.drained_m3_s,
            overflow: state.overflow,
            empty: state.level_m <= 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const REST: Inputs = Inputs { pump: 0.0, valve: 0.0, inflow_m3_s: 0.0 };

    fn at_once() -> Parameters {
        Parameters { pump_s: 0.0, stroke_s: 0.0, ..Parameters::default() }
    }

    fn rig(p: Parameters) -> Rig<Tank> {
        Rig::new(Tank::new(p))
    }

    #[test]
    fn it_drains_by_torricelli_at_any_period() {
        // √h = √h0 - μ a/A √(g/2) t
        let exact = 1.0 - 0.62 * 0.001 * (0.5 * GRAVITY_M_S2).sqrt() * 300.0;
        let error = |dt_s: f64| {
            let mut rig = rig(Parameters { initial_m: 1.0, ..at_once() });
            let drive = |rig: &mut Rig<Tank>| rig.run(Inputs { valve: 1.0, ..REST }, dt_s, (300.0 / dt_s) as u32);
            (drive(&mut rig).level_m - exact * exact).abs()
        };
        // sub-steps of 10 ms: second order leaves (μ a/A)³ g^1.5 dt² t, far below the rounding of 3e4 sums
        for dt_s in [0.1, 0.003] {
            assert!(error(dt_s) < 1e-9, "{}", error(dt_s));
        }
    }

    #[test]
    fn halving_the_step_quarters_the_error() {
        // A tank that is empty in 2.9 s, half-way: √h = 1 - μ a/A √(g/2) t
        let exact = 1.0 - 0.62 * 0.25 * (0.5 * GRAVITY_M_S2).sqrt() * 1.5;
        let error = |dt_s: f64| {
            let p = Parameters { initial_m: 1.0, area_m2: 0.04, valve_m2: 0.01, ..at_once() };
            let level_m = rig(p).run(Inputs { valve: 1.0, ..REST }, dt_s, (1.5 / dt_s).round() as u32).level_m;
            (level_m - exact * exact).abs()
        };
        let errors = [0.01, 0.005, 0.0025].map(error);
        assert!(errors[0] < 1e-5, "{errors:?}");
        // second order: the ratio tends to 4
        assert!(errors.windows(2).all(|pair| (pair[0] / pair[1] - 4.0).abs() < 0.1), "{errors:?}");
    }

    #[test]
    fn volume_is_kept_in_balance() {
        let mut rig = rig(at_once());
        let (mut filled, mut drained) = (0.0, 0.0);
        let mut out = Outputs::default();
        for _ in 0..20_000 {
            let before = out.drained_m3_s;
            out = rig.run(Inputs { pump: 0.3, valve: 0.8, ..REST }, 0.01, 1);
            filled += out.filled_m3_s * 0.01;
            drained += 0.5 * (before + out.drained_m3_s) * 0.01;
        }
        // trapezoid rule at the start, where the outflow grows as √t
        assert!((filled - drained - out.level_m).abs() < 1e-5, "{filled} {drained} {out:?}");
    }

    #[test]
    fn it_overflows_and_runs_empty() {
        let mut rig = rig(Parameters { initial_m: 1.99, ..at_once() });
        let full = rig.run(Inputs { pump: 1.0, ..REST }, 0.1, 100);
        assert!(full.overflow && full.level_m == 2.0);
        assert!((full.bottom_bar - 0.196_133).abs() < 1e-15, "ρ g h: {full:?}");
        assert!(rig.run(Inputs { valve: 1.0, ..REST }, 1.0, 2000).empty);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let run = |mode: Failure, inputs: Inputs| {
            rig(Parameters { initial_m: 1.0, ..Parameters::default() }).failing(mode).run(inputs, 0.1, 100).level_m
        };
        assert_eq!(run(Failure::PumpDead, Inputs { pump: 1.0, ..REST }), 1.0);
        assert_eq!(run(Failure::ValveStuck, Inputs { valve: 1.0, ..REST }), 1.0);
        assert!(run(Failure::Leaking, REST) < 0.999);
    }
}
