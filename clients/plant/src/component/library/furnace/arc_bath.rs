//! Scrap and bath of an arc furnace: two lumps, what covers the arcs, and where their power goes.
//!
//! # Equations
//! Heights over the floor `A`: `h = m/(ρ A)` of scrap, bath and foaming slag. Electrodes bore a pit into the scrap; its
//! floor sinks by what melts, and never below the bath.
//! - Cover of the arcs: `c_s = min(1, h_scrap/h_c)` by scrap, `c_f = min(1, h_slag/L)` by slag; exposure
//!   `e = (1 - c_s)(1 - c_f)`.
//! - Of the arcs' power `P`: `g P` leaves with the gas, `(b + w e) P` goes to the walls, the rest to scrap and bath.
//! - What reaches the scrap melts a part of it on the spot: `dm/dt = μ P_s/(c (ϑ_m - ϑ_s) + L_f)`, and warms the rest.
//! - The bath melts the scrap in it at its surface, `k (ϑ_l - ϑ_m)`, and loses `G (ϑ_l - ϑ_a)` to the walls.
//! - Enthalpies are the states, so that nothing changes them but what comes and goes.
//!
//! # Source
//! Zones of the furnace made two lumps with exposure; 100 t, 90 MW, 1600 °C: `[Vergnano]` sec. 4; 385 kWh/t.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use crate::component::melt::{Lump, REFERENCE_DEGC, Steel};

/// Liquid steel and slag, kg/m³.
const BATH_KG_M3: f64 = 7000.0;
const SLAG_KG_M3: f64 = 2500.0;
/// A bath of less than this takes a part of the heat only, as it does not cover the floor, kg.
const WHOLE_BATH_KG: f64 = 1000.0;
/// A bath of less than this wets a part of the lining only, kg.
const WHOLE_LINING_KG: f64 = 40_000.0;
/// Scrap of less than this touches the bath with a part of its surface only, kg.
const WHOLE_SCRAP_KG: f64 = 5000.0;
/// The part of the power that goes to scrap which covers the arcs.
const TO_SCRAP: f64 = 0.85;
/// Heat of slag former on its way to the bath's temperature, J/kg.
const SLAG_J_KG: f64 = 2.0e6;
/// How long foam takes to rise and to fall, s.
const FOAM_S: f64 = 20.0;
/// Carbon that burns to CO with a kilogram of oxygen, kg; heat of that, J for each kg of oxygen.
const CARBON_KG_KG: f64 = 0.75;
const OXYGEN_J_KG: f64 = 6.9e6;
/// How far a cave-in fills the pit, of the scrap's height.
const CAVED_IN: f64 = 0.7;
/// How far scrap that slides presses against the tips, m.
const PRESSED_M: f64 = 0.02;
const PERCENT: f64 = 100.0;

parameters! {
    /// Vessel, steel, and shares of the power.
    Parameters {
        /// floor of the vessel
        floor_m2: f64 = 38.5 => 0.1, 500.0;
        /// bulk density of scrap
        scrap_kg_m3: f64 = 800.0 => 50.0, 7800.0;
        /// section of the pit that the electrodes bore
        pit_m2: f64 = 6.0 => 0.1, 100.0;
        /// heat capacity of steel
        heat_j_kg_k: f64 = 720.0 => 1.0, 1e4;
        /// heat of fusion
        fusion_j_kg: f64 = 252_000.0 => 1.0, 1e6;
        /// where steel melts
        melting_degc: f64 = 1520.0 => 100.0, 3000.0;
        /// scrap of this height covers the arcs
        cover_m: f64 = 0.8 => 0.01, 10.0;
        /// part of the power that leaves with the gas
        gas_fraction: f64 = 0.18 => 0.0, 1.0;
        /// part that the walls take with covered arcs
        wall_fraction: f64 = 0.08 => 0.0, 1.0;
        /// part that the walls take besides with bare arcs
        bare_fraction: f64 = 0.4 => 0.0, 1.0;
        /// part of the heat of scrap that melts it on the spot
        melting_fraction: f64 = 0.6 => 0.0, 1.0;
        /// heat from bath to scrap for each kelvin above the melting point
        exchange_w_k: f64 = 1_000_000.0 => 0.0, 1e7;
        /// heat that the bath loses to the walls for each kelvin
        loss_w_k: f64 = 2500.0 => 0.0, 1e6;
        /// how high slag foams with a kilogram of carbon a second, times its height
        foaming_s_kg: f64 = 20.0 => 0.0, 1e4;
        /// carbon of scrap
        carbon_pct: f64 = 0.5 => 0.0, 4.0;
        /// bath at the start, at its melting point
        heel_kg: f64 = 10000.0 => 0.0, 1e6;
        /// gas that the suction takes at its full opening
        suction_m3_s: f64 = 40.0 => 0.1, 1000.0;
    }
}

signals! {
    /// What comes to it.
    Inputs {
        /// power of the arcs
        arc_w: f64,
        /// mean length of the arcs
        arc_m: f64,
        /// scrap that falls in
        charge_kg_s: f64,
        /// slag former that is fed
        slag_kg_s: f64,
        /// carbon that is blown in: slag foams
        carbon_kg_s: f64,
        /// oxygen that is blown in
        oxygen_kg_s: f64,
        /// slag that runs off
        slag_off_kg_s: f64,
        /// steel that runs off
        tap_kg_s: f64,
        /// suction of the gas, 0 to 1
        suction: f64 = 1.0,
        /// water that leaks into the vessel
        leaking: bool,
    }
}

signals! {
    /// What is seen of it.
    Outputs {
        /// scrap that is not melted
        scrap_kg: f64,
        /// temperature of the scrap
        scrap_degc: f64,
        /// liquid steel
        bath_kg: f64,
        /// temperature of the bath
        bath_degc: f64,
        /// slag
        slag_kg: f64,
        /// carbon of the bath
        carbon_pct: f64,
        /// height of the scrap over the floor
        scrap_m: f64,
        /// height of the bath over the floor
        bath_m: f64,
        /// height of the slag over the bath
        slag_m: f64,
        /// what an electrode meets: the floor of the pit, or the bath
        surface_m: f64,
        /// part of the arcs that is bare, 0 to 1
        exposure: f64,
        /// heat to the walls
        wall_w: f64,
        /// heat of the gas
        gas_w: f64,
        /// gas that comes off
        gas_m3_s: f64,
        /// pressure in the vessel over the atmosphere; the suction holds it below 0
        pressure_pa: f64,
        /// rate at which scrap melts
        melting_kg_s: f64,
        /// steel that has run off
        tapped_kg: f64,
        /// energy from arcs and oxygen since the start
        in_j: f64,
        /// energy to walls and gas since the start
        lost_j: f64,
        /// energy of slag and steel that ran off since the start
        out_j: f64,
        /// energy of scrap, bath and slag
        held_j: f64,
    }
}

failures! {
    /// What is wrong with it.
    Failure {
        /// scrap caves in on the electrodes
        CaveIn = "cave_in",
        /// the lining is worn: three times the loss
        LiningWorn = "lining_worn",
        /// the suction stands
        SuctionLost = "suction_lost",
        /// scrap is wet: gas comes off as steam
        WetScrap = "wet_scrap",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    scrap: Lump,
    bath: Lump,
    slag_kg: f64,
    slag_j: f64,
    /// Slag is so many times as high as without foam.
    foam: f64,
    carbon_kg: f64,
    /// Floor of the pit over the floor of the vessel.
    pit_m: f64,
    caved_in: bool,
    flows: Flows,
    tapped_kg: f64,
    in_j: f64,
    lost_j: f64,
    out_j: f64,
}

/// What flowed in the last period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Flows {
    exposure: f64,
    wall_w: f64,
    gas_w: f64,
    gas_m3_s: f64,
    pressure_pa: f64,
    melting_kg_s: f64,
}

/// A vessel by its parameters.
pub(crate) struct ArcBath {
    p: Parameters,
}

impl ArcBath {
    const fn steel(&self) -> Steel {
        Steel { heat_j_kg_k: self.p.heat_j_kg_k, fusion_j_kg: self.p.fusion_j_kg, melting_degc: self.p.melting_degc }
    }

    fn scrap_m(&self, state: &State) -> f64 {
        state.scrap.mass_kg / (self.p.scrap_kg_m3 * self.p.floor_m2)
    }

    fn bath_m(&self, state: &State) -> f64 {
        state.bath.mass_kg / (BATH_KG_M3 * self.p.floor_m2)
    }

    fn slag_m(&self, state: &State) -> f64 {
        state.slag_kg / (SLAG_KG_M3 * self.p.floor_m2) * (1.0 + state.foam)
    }

    fn scrap_cover(&self, state: &State) -> f64 {
        (self.scrap_m(state) / self.p.cover_m).min(1.0)
    }

    fn exposure(&self, state: &State, arc_m: f64) -> f64 {
        let slag_m = self.slag_m(state);
        let by_slag = if slag_m >= arc_m { 1.0 } else { slag_m / arc_m };
        (1.0 - self.scrap_cover(state)) * (1.0 - by_slag)
    }

    /// What falls in: scrap on the scrap, slag former into the bath, and with scrap a pit that is full again.
    fn charge(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let scrap_kg = inputs.charge_kg_s.max(0.0) * turn.dt_s;
        if scrap_kg > 0.0 {
            state.scrap.add(Lump { mass_kg: scrap_kg, enthalpy_j: 0.0 });
            state.carbon_kg += scrap_kg * self.p.carbon_pct / PERCENT;
            state.pit_m = self.scrap_m(state) + self.bath_m(state);
        }
        let slag_kg = inputs.slag_kg_s.max(0.0) * turn.dt_s;
        state.slag_kg += slag_kg;
        let slag_j = (slag_kg * SLAG_J_KG).min(state.bath.enthalpy_j.max(0.0));
        state.slag_j += slag_j;
        state.bath.enthalpy_j -= slag_j;
        let foam = if inputs.carbon_kg_s > 0.0 { self.p.foaming_s_kg * inputs.carbon_kg_s } else { 0.0 };
        state.foam = lag(state.foam, foam, FOAM_S, turn.dt_s);
        let caves_in = turn.failed.has(Failure::CaveIn);
        if caves_in && !state.caved_in {
            // scrap slides against the electrodes, not under them: it fills the pit as far as their tips at most
            let filled_m = self.bath_m(state) + CAVED_IN * self.scrap_m(state);
            let tips_m = state.pit_m + inputs.arc_m.max(0.0) + PRESSED_M;
            state.pit_m = state.pit_m.max(filled_m.min(tips_m));
        }
        state.caved_in = caves_in;
    }

    /// Heat of oxygen: it burns carbon of the bath, as long as there is some.
    fn blow(state: &mut State, inputs: &Inputs, dt_s: f64) -> f64 {
        let wanted_kg = inputs.oxygen_kg_s.max(0.0) * dt_s * CARBON_KG_KG;
        let burnt_kg = if state.bath.mass_kg > WHOLE_BATH_KG { wanted_kg.min(state.carbon_kg) } else { 0.0 };
        state.carbon_kg -= burnt_kg;
        burnt_kg / CARBON_KG_KG * OXYGEN_J_KG
    }

    fn heat(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let (steel, dt_s) = (self.steel(), turn.dt_s);
        let arc_j = inputs.arc_w.max(0.0) * dt_s;
        let oxygen_j = Self::blow(state, inputs, dt_s);
        let exposure = self.exposure(state, inputs.arc_m.max(0.0));
        let empty = state.scrap.mass_kg <= 0.0 && state.bath.mass_kg <= 0.0;
        let gas_j = self.p.gas_fraction * arc_j;
        let wall_part = (self.p.wall_fraction + self.p.bare_fraction * exposure).min(1.0 - self.p.gas_fraction);
        let wall_j = if empty { arc_j - gas_j } else { wall_part * arc_j };
        let charge_j = arc_j - gas_j - wall_j;
        let whole_bath = (state.bath.mass_kg / WHOLE_BATH_KG).min(1.0);
        let to_bath =
            if state.scrap.mass_kg > 0.0 { (1.0 - TO_SCRAP * self.scrap_cover(state)) * whole_bath } else { 1.0 };
        // the root leaves no crumb that melts for ever
        let touching = whole_bath * (state.scrap.mass_kg / WHOLE_SCRAP_KG).min(1.0).sqrt();
        // scrap melts at its surface, so the bath holds its melting point against it
        let warmer_k = state.bath.temperature_degc(&steel) - self.p.melting_degc;
        let exchanged_j = self.p.exchange_w_k * touching * warmer_k.max(0.0) * dt_s;
        let worn = if turn.failed.has(Failure::LiningWorn) { 3.0 } else { 1.0 };
        let bath_k = (state.bath.temperature_degc(&steel) - REFERENCE_DEGC).max(0.0);
        let wetted = (state.bath.mass_kg / WHOLE_LINING_KG).min(1.0);
        let lining_j = self.p.loss_w_k * worn * wetted * bath_k * dt_s;

        let melted = state.scrap.melt((1.0 - to_bath) * charge_j, self.p.melting_fraction, &steel);
        let dissolved = state.scrap.melt(exchanged_j, 1.0, &steel);
        let melted_kg = melted.mass_kg + dissolved.mass_kg;
        state.bath.enthalpy_j += to_bath * charge_j + oxygen_j - exchanged_j - lining_j;
        state.bath.add(melted);
        state.bath.add(dissolved);
        state.pit_m = (state.pit_m - melted_kg / (self.p.scrap_kg_m3 * self.p.pit_m2))
            .min(self.bath_m(state) + self.scrap_m(state))
            .max(self.bath_m(state));
        state.in_j += arc_j + oxygen_j;
        state.lost_j += gas_j + wall_j + lining_j;
        if dt_s > 0.0 {
            state.flows.wall_w = (wall_j + lining_j) / dt_s;
            state.flows.gas_w = gas_j / dt_s;
            state.flows.melting_kg_s = melted_kg / dt_s;
        }
        state.flows.exposure = exposure;
    }

    /// Steel with its carbon, and slag.
    fn run_off(state: &mut State, inputs: &Inputs, dt_s: f64) {
        let before_kg = state.bath.mass_kg;
        let tapped = state.bath.take(inputs.tap_kg_s.max(0.0) * dt_s);
        if tapped.mass_kg > 0.0 {
            state.carbon_kg *= 1.0 - tapped.mass_kg / before_kg;
            state.tapped_kg += tapped.mass_kg;
            state.out_j += tapped.enthalpy_j;
        }
        let slag_kg = (inputs.slag_off_kg_s.max(0.0) * dt_s).min(state.slag_kg);
        if slag_kg > 0.0 {
            let slag_j = state.slag_j * slag_kg / state.slag_kg;
            state.slag_kg -= slag_kg;
            state.slag_j -= slag_j;
            state.out_j += slag_j;
        }
    }

    /// Gas of the arcs, of carbon and of water, against the suction: 2 Pa for each m³/s too much.
    fn draught(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        const GAS_M3_J: f64 = 1.2e-6;
        const CARBON_M3_KG: f64 = 11.0;
        const STEAM_M3_S: f64 = 15.0;
        const RESISTANCE_PA: f64 = 2.0;
        let steam = |comes: bool| if comes { STEAM_M3_S } else { 0.0 };
        let wet = turn.failed.has(Failure::WetScrap) && state.flows.melting_kg_s > 0.0;
        state.flows.gas_m3_s = GAS_M3_J * state.flows.gas_w
            + CARBON_M3_KG * inputs.carbon_kg_s.max(0.0)
            + steam(inputs.leaking)
            + steam(wet);
        let lost = turn.failed.has(Failure::SuctionLost);
        let taken_m3_s = if lost { 0.0 } else { self.p.suction_m3_s * inputs.suction.clamp(0.0, 1.0) };
        state.flows.pressure_pa = RESISTANCE_PA * (state.flows.gas_m3_s - taken_m3_s);
    }
}

impl Component for ArcBath {
    const NAME: &'static str = "arc_bath";
    const SUMMARY: &'static str = "scrap and bath of an arc furnace: melting, cover of the arcs, losses, gas";
    const FORMULA: &'static [&'static str] = &[
        "e = (1 - h_scrap/h_c)(1 - h_slag/L)",
        "P = g P + (b + w e) P + rest to scrap and bath",
        "dm/dt = μ P_s/(c (ϑ_m - ϑ_s) + L_f)",
        "bath to scrap k (ϑ_l - ϑ_m), bath to walls G (ϑ_l - ϑ_a)",
    ];
    const SOURCE: &'static str = "balances of mass and energy; sizes: Vergnano et al., 2012, sec. 4";
    const INITIAL: &'static [&'static str] = &["heel_kg"];
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        let bath = Lump { mass_kg: self.p.heel_kg, enthalpy_j: self.p.heel_kg * self.steel().liquidus_j_kg() };
        let carbon_kg = self.p.heel_kg * self.p.carbon_pct / PERCENT;
        let mut state = State { bath, carbon_kg, ..State::default() };
        state.pit_m = self.bath_m(&state);
        state
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        self.charge(state, inputs, turn);
        self.heat(state, inputs, turn);
        Self::run_off(state, inputs, turn.dt_s);
        self.draught(state, inputs, turn);
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn) -> Outputs {
        let steel = self.steel();
        let steel_kg = state.bath.mass_kg + state.scrap.mass_kg;
        Outputs {
            scrap_kg: state.scrap.mass_kg,
            scrap_degc: state.scrap.temperature_degc(&steel),
            bath_kg: state.bath.mass_kg,
            bath_degc: state.bath.temperature_degc(&steel),
            slag_kg: state.slag_kg,
            carbon_pct: if steel_kg > 0.0 { PERCENT * state.carbon_kg / steel_kg } else { 0.0 },
            scrap_m: self.scrap_m(state),
            bath_m: self.bath_m(state),
            slag_m: self.slag_m(state),
            surface_m: state.pit_m,
            exposure: state.flows.exposure,
            wall_w: state.flows.wall_w,
            gas_w: state.flows.gas_w,
            gas_m3_s: state.flows.gas_m3_s,
            pressure_pa: state.flows.pressure_pa,
            melting_kg_s: state.flows.melting_kg_s,
            tapped_kg: state.tapped_kg,
            in_j: state.in_j,
            lost_j: state.lost_j,
            out_j: state.out_j,
            held_j: state.scrap.enthalpy_j + state.bath.enthalpy_j + state.slag_j,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const IDLE: Inputs = Inputs {
        arc_w: 0.0,
        arc_m: 0.3,
        charge_kg_s: 0.0,
        slag_kg_s: 0.0,
        carbon_kg_s: 0.0,
        oxygen_kg_s: 0.0,
        slag_off_kg_s: 0.0,
        tap_kg_s: 0.0,
        suction: 1.0,
        leaking: false,
    };

    fn rig(p: Parameters) -> Rig<ArcBath> {
        Rig::new(ArcBath::new(p))
    }

    /// Without any loss, and without a heel.
    fn tight() -> Parameters {
        Parameters {
            gas_fraction: 0.0,
            wall_fraction: 0.0,
            bare_fraction: 0.0,
            loss_w_k: 0.0,
            heel_kg: 0.0,
            ..Parameters::default()
        }
    }

    #[test]
    fn a_hundred_tonnes_take_385_kwh_each_to_1600_degrees() {
        let mut rig = rig(tight());
        rig.run(Inputs { charge_kg_s: 1000.0, ..IDLE }, 0.1, 1000);
        // 38.5 MWh at 90 MW: 1540 s
        rig.run(Inputs { arc_w: 90e6, ..IDLE }, 0.1, 15_400);
        // the bath dissolves what is left
        let out = rig.run(IDLE, 1.0, 3600);
        assert!(out.scrap_kg == 0.0 && (out.bath_kg - 100e3).abs() < 1e-3, "{out:?}");
        assert!((out.bath_degc - 1600.0).abs() < 1e-3, "{out:?}");
    }

    #[test]
    fn energy_and_mass_balance_over_a_whole_heat() {
        let mut rig = rig(Parameters::default());
        let held_j = rig.run(IDLE, 0.0, 1).held_j;
        rig.run(Inputs { charge_kg_s: 800.0, ..IDLE }, 0.1, 700);
        rig.run(Inputs { arc_w: 80e6, slag_kg_s: 2.0, ..IDLE }, 0.1, 12_000);
        rig.run(Inputs { charge_kg_s: 800.0, ..IDLE }, 0.1, 600);
        rig.run(Inputs { arc_w: 80e6, carbon_kg_s: 0.5, oxygen_kg_s: 0.4, ..IDLE }, 0.1, 14_000);
        let out = rig.run(Inputs { slag_off_kg_s: 20.0, tap_kg_s: 500.0, ..IDLE }, 0.1, 2000);
        let (came_j, went_j) = (out.in_j + held_j, out.lost_j + out.out_j + out.held_j);
        assert!((came_j / went_j - 1.0).abs() < 1e-9, "{out:?}");
        assert!((out.tapped_kg - 100e3).abs() < 1.0 && (out.bath_kg + out.scrap_kg - 14e3).abs() < 1.0, "{out:?}");
    }

    #[test]
    fn bare_arcs_heat_the_walls_and_foam_covers_them() {
        let mut rig = rig(Parameters { heel_kg: 100e3, ..Parameters::default() });
        let flat = Inputs { arc_w: 60e6, ..IDLE };
        let bare = rig.run(flat, 0.1, 10);
        assert!(bare.exposure == 1.0 && (bare.wall_w - 0.48 * 60e6) < 5e6, "{bare:?}");
        rig.run(Inputs { slag_kg_s: 20.0, ..flat }, 0.1, 2000);
        let foam = rig.run(Inputs { carbon_kg_s: 0.6, ..flat }, 0.1, 1000);
        assert!(foam.exposure < 0.1 && foam.wall_w < 0.4 * bare.wall_w, "{foam:?}");
    }

    #[test]
    fn electrodes_bore_down_to_the_bath_and_a_cave_in_covers_them() {
        let charge = |mut rig: Rig<ArcBath>| {
            rig.run(Inputs { charge_kg_s: 1000.0, ..IDLE }, 0.1, 600);
            rig
        };
        let mut good = charge(rig(Parameters::default()));
        let full = good.run(IDLE, 0.1, 1);
        assert!((full.surface_m - full.scrap_m - full.bath_m).abs() < 0.01 && full.surface_m > 1.8, "{full:?}");
        let bored = good.run(Inputs { arc_w: 60e6, ..IDLE }, 0.1, 6000);
        assert!(bored.scrap_kg > 10e3 && bored.surface_m == bored.bath_m, "{bored:?}");
        good = good.failing(Failure::CaveIn);
        let caved_m = good.run(IDLE, 0.0, 1).surface_m - bored.bath_m;
        assert!((caved_m - (0.7 * bored.scrap_m).min(0.32)).abs() < 1e-9, "{caved_m}");
    }

    #[test]
    fn oxygen_burns_carbon_and_gas_without_suction_is_pressure() {
        let mut rig = rig(Parameters { heel_kg: 100e3, ..Parameters::default() });
        let out = rig.run(Inputs { oxygen_kg_s: 1.0, ..IDLE }, 0.1, 4000);
        assert!((out.carbon_pct - (0.5 - 0.3)).abs() < 1e-9 && (out.in_j - 400.0 * 6.9e6).abs() < 1.0, "{out:?}");
        assert!(out.pressure_pa < 0.0);
        let blocked = rig.failing(Failure::SuctionLost).run(Inputs { arc_w: 90e6, ..IDLE }, 0.1, 1);
        assert!(blocked.pressure_pa > 10.0, "{blocked:?}");
    }
}
