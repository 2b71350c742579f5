//! A hydraulic unit: a pump, its relief valve, a check valve and an accumulator.
//!
//! # Equations
//! - `T dQ_P/dt = Q_N - Q_P`: the pump comes up to its flow, or runs down;
//! - `q_R = k_R (p - p_R)` above the setting `p_R` of the relief valve, nothing below it;
//! - `dp/dt = (Q_P - q_R - q) / C`, with the flow `q` that cylinders draw; nothing flows back into the pump;
//! - `C = V/E` of the line, and above the charge of the gas `V_0 p_0^(1/n) / (n p^(1/n + 1))` of the accumulator, with
//!   absolute pressures: a gas that is compressed polytropically.
//!
//! # Source
//! D. Findeisen, *Ölhydraulik*, Springer 2015, ch. 4 and 5 (relief valves, gas-loaded accumulators).
//!
//! # Method
//! Sub-steps of at most 50 µs, the pressure linearly implicit: first order. Cylinders see the pressure a period later.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{lag, substeps};
use crate::component::fluid::{ATMOSPHERE_PA, BAR_PA, L_MIN_M3_S, implicit_pa};

/// Longest sub-step.
const LONGEST_S: f64 = 50e-6;

parameters! {
    /// The unit.
    Parameters {
        /// flow of the pump
        pump_l_min: f64 = 40.0 => 0.0, 100_000.0;
        /// time constant of the pump's start and stop
        pump_s: f64 = 0.2 => 0.0, 60.0;
        /// setting of the relief valve
        relief_bar: f64 = 160.0 => 1.0, 700.0;
        /// flow of the relief valve for each bar above its setting
        relief_l_s_bar: f64 = 0.1 => 1e-4, 1000.0;
        /// volume of the line
        line_l: f64 = 2.0 => 0.01, 10_000.0;
        /// bulk modulus of the oil with its air
        bulk_bar: f64 = 12_000.0 => 500.0, 30_000.0;
        /// volume of the accumulator's gas when it is empty; 0 for none
        accumulator_l: f64 = 10.0 => 0.0, 10_000.0;
        /// pressure of that gas when it is empty
        charge_bar: f64 = 100.0 => 1.0, 700.0;
        /// polytropic exponent of the gas: 1 slow, 1.4 fast
        polytropic: f64 = 1.2 => 1.0, 1.67;
        /// pressure at the set-up
        initial_bar: f64 = 0.0 => 0.0, 700.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// the pump is on
        pump: bool,
        /// flow that a cylinder draws
        drawn_l_min: f64,
        /// flow that a second one draws
        second_l_min: f64,
        /// flow that a third one draws
        third_l_min: f64,
        /// flow that a fourth one draws
        fourth_l_min: f64,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// pressure in the line
        pressure_bar: f64,
        /// flow of the pump
        delivered_l_min: f64,
        /// flow through the relief valve
        relieved_l_min: f64,
        /// oil in the accumulator
        stored_l: f64,
        /// the accumulator is empty
        empty: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the pump gives nothing
        PumpDead = "pump_dead",
        /// the relief valve stays open: it opens at a tenth of its setting
        ReliefOpen = "relief_open",
        /// the relief valve does not open
        ReliefStuck = "relief_stuck",
        /// the accumulator has lost its gas
        GasLost = "gas_lost",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    pump_m3_s: f64,
    pressure_pa: f64,
    relieved_m3_s: f64,
}

/// A unit by its parameters.
pub(crate) struct HydraulicUnit {
    p: Parameters,
}

impl HydraulicUnit {
    /// The volume that goes in for a pressure that rises, m³/Pa.
    fn capacity(&self, pressure_pa: f64, has_gas: bool) -> f64 {
        let p = &self.p;
        let line = p.line_l * 1e-3 / (p.bulk_bar * BAR_PA);
        if !has_gas || pressure_pa <= p.charge_bar * BAR_PA {
            return line;
        }
        let absolute = pressure_pa + ATMOSPHERE_PA;
        line + self.gas_m3(pressure_pa) / (p.polytropic * absolute)
    }

    /// The volume of the accumulator's gas at a pressure above its charge.
    fn gas_m3(&self, pressure_pa: f64) -> f64 {
        let p = &self.p;
        let ratio = (p.charge_bar * BAR_PA + ATMOSPHERE_PA) / (pressure_pa + ATMOSPHERE_PA);
        p.accumulator_l * 1e-3 * libm::pow(ratio.min(1.0), 1.0 / p.polytropic)
    }

    fn relieved(&self, pressure_pa: f64, turn: &Turn) -> f64 {
        let setting = if turn.failed.has(Failure::ReliefOpen) { 0.1 } else { 1.0 } * self.p.relief_bar * BAR_PA;
        if turn.failed.has(Failure::ReliefStuck) {
            return 0.0;
        }
        self.p.relief_l_s_bar * 1e-3 / BAR_PA * (pressure_pa - setting).max(0.0)
    }
}

impl Component for HydraulicUnit {
    const NAME: &'static str = "hydraulic_unit";
    const SUMMARY: &'static str = "hydraulic unit: pump, relief valve, check valve and accumulator";
    const FORMULA: &'static [&'static str] = &[
        "T dQ_P/dt = Q_N - Q_P",
        "q_R = k_R (p - p_R), above p_R",
        "dp/dt = (Q_P - q_R - q)/C, C = V/E + V_0 (p_0/p)^(1/n)/(n p)",
    ];
    const SOURCE: &'static str = "D. Findeisen, Ölhydraulik, 2015, ch. 4 and 5";
    const INITIAL: &'static [&'static str] = &["initial_bar"];
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State { pressure_pa: self.p.initial_bar * BAR_PA, ..State::default() }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let p = &self.p;
        let runs = inputs.pump && !turn.failed.has(Failure::PumpDead);
        let wanted = if runs { p.pump_l_min * L_MIN_M3_S } else { 0.0 };
        let drawn = inputs.drawn_l_min + inputs.second_l_min + inputs.third_l_min + inputs.fourth_l_min;
        let drawn = if drawn.is_finite() { drawn * L_MIN_M3_S } else { 0.0 };
        let has_gas = !turn.failed.has(Failure::GasLost);
        let (count, dt_s) = substeps(turn.dt_s, LONGEST_S);
        for _ in 0..count {
            state.pump_m3_s = lag(state.pump_m3_s, wanted, p.pump_s, dt_s);
            let pump = state.pump_m3_s;
            let capacity = self.capacity(state.pressure_pa, has_gas);
            let rate = |pa: f64| (pump - drawn - self.relieved(pa, turn)) / capacity;
            // a line that is drawn empty has no pressure
            state.pressure_pa = implicit_pa(state.pressure_pa, dt_s, rate).max(0.0);
        }
        state.relieved_m3_s = self.relieved(state.pressure_pa, turn);
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn) -> Outputs {
        let stored_l = if turn.failed.has(Failure::GasLost) {
            0.0
        } else {
            self.p.accumulator_l - 1e3 * self.gas_m3(state.pressure_pa)
        };
        Outputs {
            pressure_bar: state.pressure_pa / BAR_PA,
            delivered_l_min: state.pump_m3_s / L_MIN_M3_S,
            relieved_l_min: state.relieved_m3_s / L_MIN_M3_S,
            stored_l,
            empty: stored_l <= 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const STEPS: [(f64, u32); 3] = [(1e-4, 100), (1e-3, 10), (1e-2, 1)];

    fn rig(p: Parameters) -> Rig<HydraulicUnit> {
        Rig::new(HydraulicUnit::new(p))
    }

    fn on(drawn_l_min: f64) -> Inputs {
        Inputs { pump: true, drawn_l_min, ..Inputs::default() }
    }

    #[test]
    fn a_pump_without_a_consumer_goes_over_its_relief_valve() {
        for (dt_s, each) in STEPS {
            let out = rig(Parameters::default()).run(on(0.0), dt_s, 3000 * each);
            // 40 l/min over 0.1 l/(s bar): 6.67 bar above the setting
            assert!((out.pressure_bar - (160.0 + 40.0 / 6.0)).abs() < 1e-3, "{out:?}");
            assert!((out.relieved_l_min - 40.0).abs() < 1e-3, "{out:?}");
        }
    }

    #[test]
    fn an_accumulator_gives_what_its_gas_expands_by() {
        for (dt_s, each) in STEPS {
            let p = Parameters { initial_bar: 150.0, pump_l_min: 0.0, line_l: 0.01, ..Parameters::default() };
            // 2 l in 2 s
            let before = rig(p).run(on(0.0), dt_s, 1).stored_l;
            let p = Parameters { initial_bar: 150.0, pump_l_min: 0.0, line_l: 0.01, ..Parameters::default() };
            let out = rig(p).run(on(60.0), dt_s, 200 * each);
            assert!((before - out.stored_l - 2.0).abs() < 2e-3, "{before} {out:?}");
            let gas = |bar: f64| 10.0 * libm::pow((100.0 + 1.01325) / (bar + 1.01325), 1.0 / 1.2);
            let exact = (100.0 + 1.01325) * libm::pow(10.0 / (gas(150.0) + 2.0), 1.2) - 1.01325;
            assert!((out.pressure_bar - exact).abs() < 0.05, "{dt_s}: {out:?} {exact}");
        }
    }

    #[test]
    fn each_failure_has_its_effect() {
        let fails = |mode| rig(Parameters::default()).failing(mode).run(on(0.0), 0.01, 3000);
        assert_eq!(fails(Failure::PumpDead).pressure_bar, 0.0);
        assert!(fails(Failure::ReliefOpen).pressure_bar < 25.0);
        assert!(fails(Failure::ReliefStuck).pressure_bar > 200.0);
        let lost = fails(Failure::GasLost);
        assert!(lost.empty && (lost.pressure_bar - 166.67).abs() < 0.1, "{lost:?}");
    }
}
