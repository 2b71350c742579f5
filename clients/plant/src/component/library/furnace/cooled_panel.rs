//! A wall of a furnace that water cools.
//!
//! # Equations
//! - Water takes the heat of the panel: `C dϑ/dt = Q - h (ϑ - ϑ_w)`, exact over a period, where
//!   `ϑ_w = ϑ_in + Q_w/(2 ṁ c)` is its mean and `Q_w = h (ϑ - ϑ_w)`, so `1/h' = 1/h + 1/(2 ṁ c)` against the supply.
//! - At the outlet: `ϑ_out = ϑ_in + Q_w/(ṁ c)`.
//! - Flow and pressure follow the valve: `ṁ = ṁ_N·valve`, `p = p_N·valve²` over the panel.
//!
//! # Source
//! Balance of heat in closed form.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;

/// Heat of water, J/(kg·K); a litre is taken as a kilogram.
const WATER_J_KG_K: f64 = 4186.0;
/// Seconds of a minute.
const MINUTE_S: f64 = 60.0;
/// What is left of the flow behind a leak, and behind a blocked pipe.
const BEHIND_LEAK: f64 = 0.35;
const BEHIND_BLOCKAGE: f64 = 0.1;

parameters! {
    /// Panel and water.
    Parameters {
        /// flow at the full valve
        flow_l_min: f64 = 9000.0 => 1.0, 1e6;
        /// temperature of the supply
        supply_degc: f64 = 30.0 => 0.0, 100.0;
        /// heat that goes from panel to water for each kelvin
        transfer_w_k: f64 = 400_000.0 => 1.0, 1e9;
        /// heat capacity of the panel
        capacity_j_k: f64 = 4_000_000.0 => 1.0, 1e12;
        /// pressure at the full flow
        pressure_bar: f64 = 4.0 => 0.1, 100.0;
        /// the contact of the outlet opens here
        outlet_limit_degc: f64 = 65.0 => 0.0, 200.0;
        /// the panel is too hot here
        limit_degc: f64 = 120.0 => 0.0, 2000.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// heat from the furnace
        heat_w: f64,
        /// valve of the supply, 0 to 1
        valve: f64 = 1.0,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// temperature of the panel
        temperature_degc: f64,
        /// temperature of the water at the outlet
        outlet_degc: f64,
        /// flow of the water
        flow_l_min: f64,
        /// pressure of the supply
        pressure_bar: f64,
        /// heat that the water takes away
        removed_w: f64,
        /// the outlet or the panel is too hot
        overheat: bool,
        /// water runs into the furnace
        leaking: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// water leaks into the furnace: flow and pressure behind it fall
        Leak = "leak",
        /// a pipe is blocked: hardly a flow, at the full pressure
        Blocked = "blocked",
        /// the contact of the temperature does not open
        ContactStuck = "contact_stuck",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    temperature_degc: f64,
    removed_w: f64,
}

/// A panel by its parameters.
pub(crate) struct CooledPanel {
    p: Parameters,
}

impl CooledPanel {
    /// Flow, l/min, and pressure, bar.
    fn water(&self, valve: f64, turn: &Turn) -> (f64, f64) {
        let valve = valve.clamp(0.0, 1.0);
        let (left, held) = match (turn.failed.has(Failure::Blocked), turn.failed.has(Failure::Leak)) {
            (true, _) => (BEHIND_BLOCKAGE, 1.0),
            (false, true) => (BEHIND_LEAK, BEHIND_LEAK * BEHIND_LEAK),
            (false, false) => (1.0, 1.0),
        };
        (self.p.flow_l_min * valve * left, self.p.pressure_bar * valve * valve * held)
    }

    /// What the water takes with it for each kelvin that it is warmer, W/K.
    fn carried_w_k(flow_l_min: f64) -> f64 {
        flow_l_min / MINUTE_S * WATER_J_KG_K
    }
}

impl Component for CooledPanel {
    const NAME: &'static str = "cooled_panel";
    const SUMMARY: &'static str = "wall of a furnace with cooling water";
    const FORMULA: &'static [&'static str] =
        &["C dϑ/dt = Q - h' (ϑ - ϑ_in), 1/h' = 1/h + 1/(2 ṁ c)", "ϑ_out = ϑ_in + Q_w/(ṁ c)"];
    const SOURCE: &'static str = "balance of heat, in closed form";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State { temperature_degc: self.p.supply_degc, removed_w: 0.0 }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let carried_w_k = Self::carried_w_k(self.water(inputs.valve, turn).0);
        if carried_w_k <= 0.0 {
            // standing water is a part of the panel
            state.temperature_degc += inputs.heat_w * turn.dt_s / self.p.capacity_j_k;
            state.removed_w = 0.0;
            return;
        }
        let h_w_k = 1.0 / (1.0 / self.p.transfer_w_k + 0.5 / carried_w_k);
        let final_degc = self.p.supply_degc + inputs.heat_w / h_w_k;
        let before_degc = state.temperature_degc;
        state.temperature_degc = lag(before_degc, final_degc, self.p.capacity_j_k / h_w_k, turn.dt_s);
        // what came and was not kept has gone with the water
        if turn.dt_s > 0.0 {
            let kept_w = self.p.capacity_j_k * (state.temperature_degc - before_degc) / turn.dt_s;
            state.removed_w = inputs.heat_w - kept_w;
        }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let (flow_l_min, pressure_bar) = self.water(inputs.valve, turn);
        let carried_w_k = Self::carried_w_k(flow_l_min);
        let outlet_degc =
            if carried_w_k > 0.0 { self.p.supply_degc + state.removed_w / carried_w_k } else { state.temperature_degc };
        let hot = outlet_degc > self.p.outlet_limit_degc || state.temperature_degc > self.p.limit_degc;
        Outputs {
            temperature_degc: state.temperature_degc,
            outlet_degc,
            flow_l_min,
            pressure_bar,
            removed_w: state.removed_w,
            overheat: hot && !turn.failed.has(Failure::ContactStuck),
            leaking: turn.failed.has(Failure::Leak),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const HEAT: Inputs = Inputs { heat_w: 10e6, valve: 1.0 };
    const WATER_W_K: f64 = 150.0 * 4186.0;

    fn rig() -> Rig<CooledPanel> {
        Rig::new(CooledPanel::new(Parameters::default()))
    }

    #[test]
    fn water_takes_the_heat_away_in_the_steady_state() {
        let out = rig().run(HEAT, 0.1, 10_000);
        assert!((out.removed_w - 10e6).abs() < 1e-3 && (out.outlet_degc - (30.0 + 10e6 / WATER_W_K)).abs() < 1e-9);
        let h_w_k = 1.0 / (1.0 / 400e3 + 0.5 / WATER_W_K);
        assert!((out.temperature_degc - (30.0 + 10e6 / h_w_k)).abs() < 1e-9 && !out.overheat, "{out:?}");
    }

    #[test]
    fn it_warms_up_by_its_closed_form_and_keeps_the_balance_at_any_period() {
        let h_w_k = 1.0 / (1.0 / 400e3 + 0.5 / WATER_W_K);
        for dt_s in [0.01, 1.0] {
            let (mut rig, mut removed_j) = (rig(), 0.0);
            let mut out = Outputs::default();
            for _ in 0..(10.0 / dt_s) as u32 {
                out = rig.run(HEAT, dt_s, 1);
                removed_j += out.removed_w * dt_s;
            }
            let expected_degc = 30.0 + 10e6 / h_w_k * (1.0 - libm::exp(-10.0 * h_w_k / 4e6));
            assert!((out.temperature_degc - expected_degc).abs() < 1e-9, "{dt_s}: {out:?}");
            assert!((removed_j + 4e6 * (out.temperature_degc - 30.0) - 100e6).abs() < 1.0, "{dt_s}: {removed_j}");
        }
    }

    #[test]
    fn a_leak_and_a_blocked_pipe_overheat_it_and_a_stuck_contact_says_nothing() {
        let leak = rig().failing(Failure::Leak).run(HEAT, 0.1, 1000);
        assert!(leak.overheat && leak.leaking && leak.pressure_bar < 0.5, "{leak:?}");
        let blocked = rig().failing(Failure::Blocked).run(HEAT, 0.1, 1000);
        assert!(blocked.overheat && blocked.pressure_bar == 4.0, "{blocked:?}");
        let silent = rig().failing(Failure::Blocked).failing(Failure::ContactStuck).run(HEAT, 0.1, 1000);
        assert!(!silent.overheat && silent.outlet_degc > 65.0);
        let dry = rig().run(Inputs { valve: 0.0, ..HEAT }, 0.1, 100);
        assert!((dry.temperature_degc - 55.0).abs() < 1e-9 && dry.removed_w == 0.0, "{dry:?}");
    }
}
