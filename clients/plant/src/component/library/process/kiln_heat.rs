//! The heat of a rotary kiln: through coating and brick to the shell, and from there to the air, zone by zone along it.
//!
//! # Equations
//! For each of 24 zones, per m² of shell:
//! - the gas is hottest at the flame, and its heat passes a film, the coating and the brick:
//!   `q_in = (T_gas − T)/(1/h_in + d_c/k_c + d_b/k_b)`, with `T_gas(x) = T_e + b·(T_f − T_e)·exp(−(x−x_f)²/2w²)` where `T_e` is
//!   at the ends and `b` what the burner gives; gas goes from 0 m, where the hood is, to the fan behind the other end;
//! - the shell loses it by convection and radiation: `q_out = h_out·(T − T_a) + ε·σ·(T⁴ − T_a⁴)`, temperatures in K there;
//! - `C·dT/dt = q_in − q_out`. A step is `T + f·(e^{Jh} − 1)/J` with `f` the right-hand side and `J` its slope, which is exact
//!   where that is a straight line, and for long steps becomes Newton's on the steady state: stable however long;
//! - coating grows to its thickness by a lag, brick wears evenly, a ring grows evenly at its place: exact for any step.
//!
//! A brick that is lost leaves a spot, which comes and goes by a lag. All of that is on the shell and turns with it.
//!
//! A blockage closes a part `β` of the cross section. What then flows, draws and where the heat is: [`Draught`].
//!
//! # Source
//! Closed form: heat balance of a wall in layers, law of Stefan and Boltzmann. Faults of the process: the thesis on the
//! shell scanner *Jacket*, 2009, ch. 2.2.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::bend::Bend;
use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{Failed, failures, own_types, parameters, signals};
use crate::component::draught::Draught;
use crate::component::dynamics::lag;
use crate::coupling::Heats;
use crate::temperature_field::{SPOTS, Spot, TemperatureField, ZONES};

/// Law of Stefan and Boltzmann, W/(m²·K⁴).
const SIGMA: f64 = 5.670_374_419e-8;
/// 0 °C in K.
const ZERO_K: f64 = 273.15;
/// Parts of the shell that a monitoring system has an alarm for, and zones in each.
const PARTS: usize = 8;
const ZONES_PER_PART: usize = ZONES / PARTS;

parameters! {
    /// Kiln, lining and surroundings.
    Parameters {
        /// length of the shell
        length_m: f64 = 60.0 => 1.0, 300.0;
        /// outer diameter of the shell
        shell_m: f64 = 4.0 => 0.1, 20.0;
        /// of the flame, where the burner is full on
        flame_degc: f64 = 1450.0 => 100.0, 2500.0;
        /// where the gas is hottest
        flame_at_m: f64 = 15.0 => 0.0, 300.0;
        /// standard deviation of the gas temperature along the kiln
        flame_width_m: f64 = 18.0 => 0.1, 300.0;
        /// of the gas far from the flame, and of all of it without a burner
        ends_degc: f64 = 600.0 => 0.0, 2000.0;
        /// heat transfer from the gas to the wall
        inside_w_m2_k: f64 = 150.0 => 1.0, 1e4;
        /// brick when it is new
        brick_m: f64 = 0.2 => 0.001, 2.0;
        /// conductivity of the brick
        brick_w_m_k: f64 = 3.0 => 0.01, 100.0;
        /// by how much the brick wears
        wear_m_s: f64 = 0.0 => 0.0, 1e-3;
        /// coating when it has grown
        coating_m: f64 = 0.1 => 0.0, 2.0;
        /// coating at the start
        coating_start_m: f64 = 0.1 => 0.0, 2.0;
        /// conductivity of coating and rings
        coating_w_m_k: f64 = 1.5 => 0.01, 100.0;
        /// time constant of the coating's growth
        coating_s: f64 = 86400.0 => 1.0, 1e9;
        /// a ring: where it is
        ring_at_m: f64 = 40.0 => 0.0, 300.0;
        /// a ring: its standard deviation along the kiln
        ring_width_m: f64 = 1.5 => 0.1, 300.0;
        /// a ring: its thickness at the start
        ring_m: f64 = 0.0 => 0.0, 5.0;
        /// a ring that grows: by how much
        ring_growth_m_s: f64 = 1e-6 => 0.0, 1.0;
        /// a hot spot, there from the start: by how much it is hotter, in K
        spot_more_degc: f64 = 0.0 => -500.0, 1000.0;
        /// a hot spot: where it is along the kiln
        spot_at_m: f64 = 22.0 => 0.0, 300.0;
        /// a hot spot: where it is around the shell
        spot_at_deg: f64 = 130.0 => -360.0, 360.0;
        /// a hot spot, and one of a lost brick: standard deviation along the kiln
        spot_along_m: f64 = 0.8 => 0.01, 100.0;
        /// a hot spot, and one of a lost brick: standard deviation around the shell
        spot_around_m: f64 = 0.8 => 0.01, 100.0;
        /// a lost brick: by how much it is hotter in the end, in K
        lost_more_degc: f64 = 150.0 => -500.0, 1000.0;
        /// a lost brick: where it was along the kiln
        lost_at_m: f64 = 18.0 => 0.0, 300.0;
        /// a lost brick: where it was around the shell
        lost_at_deg: f64 = 250.0 => -360.0, 360.0;
        /// a lost brick: time constant with which its spot comes and goes
        lost_s: f64 = 7200.0 => 0.0, 1e9;
        /// draught: what the fan draws with, at the end to which gas goes
        draught_pa: f64 = 200.0 => 0.0, 1e5;
        /// draught: part of it that an open kiln has at the hood
        hood_pct: f64 = 10.0 => 0.0, 100.0;
        /// draught: part of it that an open kiln loses as the velocity head of its cross section
        head_pct: f64 = 5.0 => 0.0, 100.0;
        /// a blockage: where it is along the kiln
        blocked_at_m: f64 = 30.0 => 0.0, 300.0;
        /// a blockage: part of the cross section that it closes
        blocked_pct: f64 = 90.0 => 0.0, 99.9;
        /// heat transfer from the shell to the air
        outside_w_m2_k: f64 = 15.0 => 0.1, 1e4;
        /// emissivity of the shell
        emissivity_pct: f64 = 85.0 => 0.0, 100.0;
        /// heat that shell and brick hold
        heat_j_m2_k: f64 = 380_000.0 => 1.0, 1e9;
        /// of shell at the start; from the steady state if it is below absolute zero
        start_degc: f64 = -300.0 => -300.0, 1500.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// what the burner gives
        burner_pct: f64 = 100.0,
        /// air around the shell
        ambient_degc: f64 = 20.0,
        /// angle of the shell
        angle_rad: f64,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// hottest zone, without spots
        hottest_degc: f64,
        /// where the hottest zone is
        hottest_m: f64,
        /// coldest zone
        coldest_degc: f64,
        /// by how much the spot of a lost brick is hotter, in K
        lost_degc: f64,
        /// thickest coating, a ring included
        coating_most_m: f64,
        /// thinnest brick
        brick_least_m: f64,
        /// heat that the shell loses
        loss_w: f64,
        /// gas that flows, of what flows through an open kiln
        flow_pct: f64,
        /// suction at the hood
        hood_pa: f64,
        /// suction that is lost across a blockage
        across_pa: f64,
        /// hottest point of the first eighth of the shell, spots included
        zone_1_degc: f64,
        /// hottest point of the second eighth
        zone_2_degc: f64,
        /// hottest point of the third eighth
        zone_3_degc: f64,
        /// hottest point of the fourth eighth
        zone_4_degc: f64,
        /// hottest point of the fifth eighth
        zone_5_degc: f64,
        /// hottest point of the sixth eighth
        zone_6_degc: f64,
        /// hottest point of the seventh eighth
        zone_7_degc: f64,
        /// hottest point of the last eighth
        zone_8_degc: f64,
    }
}

failures! {
    /// What is wrong with the process.
    Failure {
        /// bricks have fallen out: a hot spot grows
        BrickLost = "brick_lost",
        /// a ring grows: a band becomes cold
        RingGrowing = "ring_growing",
        /// the coating falls off, and grows again when this ends
        CoatingFalls = "coating_falls",
        /// the burner is out
        BurnerOut = "burner_out",
        /// a lump blocks the gas: the draught falls, it becomes hotter before and colder behind
        Blocked = "blocked",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    zones_degc: [f64; ZONES],
    coating_m: f64,
    ring_m: f64,
    brick_m: f64,
    lost_k: f64,
    ambient_degc: f64,
    angle_rad: f64,
}

/// The heat of a kiln by its parameters.
pub(crate) struct KilnHeat {
    p: Parameters,
}

/// What a zone exchanges, per m²: what it is heated with and through what, and what is around it.
#[derive(Clone, Copy, Debug)]
struct Wall {
    gas_degc: f64,
    /// Through which heat comes in, W/(m²·K).
    inside_w_k: f64,
    outside_w_k: f64,
    radiation_w_k4: f64,
    ambient_degc: f64,
}

impl Wall {
    fn loss_w(&self, degc: f64) -> f64 {
        let fourth = |degc: f64| (degc + ZERO_K) * (degc + ZERO_K) * (degc + ZERO_K) * (degc + ZERO_K);
        self.outside_w_k * (degc - self.ambient_degc) + self.radiation_w_k4 * (fourth(degc) - fourth(self.ambient_degc))
    }

    fn gain_w(&self, degc: f64) -> f64 {
        self.inside_w_k * (self.gas_degc - degc) - self.loss_w(degc)
    }

    /// By how much the gain falls with each K; more than 0.
    fn slope_w_k(&self, degc: f64) -> f64 {
        let kelvin = degc + ZERO_K;
        self.inside_w_k + self.outside_w_k + 4.0 * self.radiation_w_k4 * kelvin * kelvin * kelvin
    }

    /// The temperature after a step.
    fn after(&self, degc: f64, heat_j_k: f64, dt_s: f64) -> f64 {
        let slope = self.slope_w_k(degc);
        // `e^x - 1` itself would lose its digits where the step is short.
        degc - self.gain_w(degc) / slope * libm::expm1(-slope * dt_s / heat_j_k)
    }

    /// The temperature at which as much comes in as goes out: by Newton, from above the root, where each step is
    /// towards it.
    fn steady_degc(&self) -> f64 {
        let mut degc = self.gas_degc.max(self.ambient_degc);
        for _ in 0..64 {
            degc += self.gain_w(degc) / self.slope_w_k(degc);
        }
        degc
    }
}

impl KilnHeat {
    fn middle_m(&self, zone: usize) -> f64 {
        (zone as f64 + 0.5) / ZONES as f64 * self.p.length_m
    }

    fn coating_at(&self, state: &State, zone: usize) -> f64 {
        let aside = (self.middle_m(zone) - self.p.ring_at_m) / self.p.ring_width_m;
        state.coating_m + state.ring_m * libm::exp(-0.5 * aside * aside)
    }

    /// The gas in the middle of each zone, °C.
    fn gas_degc(&self, burner: f64, draught: Draught) -> [f64; ZONES] {
        let p = &self.p;
        let excess_k = std::array::from_fn(|zone| {
            let aside = (self.middle_m(zone) - p.flame_at_m) / p.flame_width_m;
            burner * (p.flame_degc - p.ends_degc) * libm::exp(-0.5 * aside * aside)
        });
        let behind = (0..ZONES).take_while(|zone| self.middle_m(*zone) < p.blocked_at_m).count();
        draught.carries(&excess_k, behind).map(|hotter_k| p.ends_degc + hotter_k)
    }

    fn draught(&self, failed: Failed) -> Draught {
        if failed.has(Failure::Blocked) {
            Draught::blocked(self.p.blocked_pct / 100.0, self.p.head_pct / 100.0)
        } else {
            Draught::OPEN
        }
    }

    fn wall(&self, state: &State, gas_degc: f64, zone: usize) -> Wall {
        let p = &self.p;
        let layers = 1.0 / p.inside_w_m2_k + self.coating_at(state, zone) / p.coating_w_m_k + state.brick_m / p.brick_w_m_k;
        Wall {
            gas_degc,
            inside_w_k: 1.0 / layers,
            outside_w_k: p.outside_w_m2_k,
            radiation_w_k4: p.emissivity_pct / 100.0 * SIGMA,
            ambient_degc: state.ambient_degc,
        }
    }

    /// The hottest point of each part of the shell, among the middles of zones and spots.
    fn parts_degc(&self, state: &State) -> [f64; PARTS] {
        let field = self.effect(state);
        let zones = |part: usize| &field.zones_degc[part * ZONES_PER_PART..(part + 1) * ZONES_PER_PART];
        let mut parts = std::array::from_fn(|part| zones(part).iter().copied().fold(f64::NEG_INFINITY, f64::max));
        for spot in field.spots.iter().filter(|spot| spot.more_k > 0.0) {
            let part = spot.at_m / field.length_m * PARTS as f64;
            if let Some(hottest) = parts.get_mut(part as usize) {
                *hottest = hottest.max(field.at(spot.at_m, spot.at_rad));
            }
        }
        parts
    }

    fn spots(&self, state: &State) -> [Spot; SPOTS] {
        let p = &self.p;
        let spot = |more_k: f64, at_m: f64, at_deg: f64| Spot {
            more_k,
            at_m,
            at_rad: at_deg.to_radians(),
            along_m: p.spot_along_m,
            around_m: p.spot_around_m,
        };
        [spot(p.spot_more_degc, p.spot_at_m, p.spot_at_deg), spot(state.lost_k, p.lost_at_m, p.lost_at_deg)]
    }
}

impl Component for KilnHeat {
    const NAME: &'static str = "kiln_heat";
    const SUMMARY: &'static str = "rotary kiln: heat through coating and brick to the shell, with rings and hot spots";
    const FORMULA: &'static [&'static str] = &[
        "C dT/dt = (T_gas - T)/(1/h_in + d_c/k_c + d_b/k_b) - h_out (T - T_a) - ε σ (T⁴ - T_a⁴)",
        "T_gas(x) = T_e + b (T_f - T_e) exp(-(x - x_f)²/2w²)",
        "blocked: f = (1 + ζ (1/(1 - β)² - 1))^-½, hood h p f², across p (1 - f²)",
        "T_gas - T_e behind it f times, before it 1 + (1 - f) E_behind/E_before times as much",
        "spots A exp(-(x - x_i)²/2σ_x² - R²(φ - φ_i)²/2σ_a²)",
    ];
    const SOURCE: &'static str = "closed form; faults of the process: Jacket, 2009, ch. 2.2";
    const INITIAL: &'static [&'static str] = &["start_degc", "coating_start_m", "ring_m"];
    own_types!(moves Heats);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        let unset = Inputs::default();
        let mut state = State {
            zones_degc: [self.p.start_degc; ZONES],
            coating_m: self.p.coating_start_m,
            ring_m: self.p.ring_m,
            brick_m: self.p.brick_m,
            lost_k: 0.0,
            ambient_degc: unset.ambient_degc,
            angle_rad: 0.0,
        };
        if self.p.start_degc < -ZERO_K {
            let gas_degc = self.gas_degc(unset.burner_pct / 100.0, Draught::OPEN);
            state.zones_degc = std::array::from_fn(|zone| self.wall(&state, gas_degc[zone], zone).steady_degc());
        }
        state
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let (p, dt_s) = (&self.p, turn.dt_s);
        let out = turn.failed.has(Failure::BurnerOut);
        let burner = if out { 0.0 } else { (inputs.burner_pct / 100.0).clamp(0.0, 1.0) };
        let coating_m = if turn.failed.has(Failure::CoatingFalls) { 0.0 } else { p.coating_m };
        let lost_k = if turn.failed.has(Failure::BrickLost) { p.lost_more_degc } else { 0.0 };
        state.ambient_degc = inputs.ambient_degc.clamp(-ZERO_K, 1000.0);
        state.angle_rad = inputs.angle_rad;
        let gas_degc = self.gas_degc(burner, self.draught(turn.failed));
        for (zone, gas_degc) in gas_degc.into_iter().enumerate() {
            let wall = self.wall(state, gas_degc, zone);
            state.zones_degc[zone] = wall.after(state.zones_degc[zone], p.heat_j_m2_k, dt_s);
        }
        state.coating_m = lag(state.coating_m, coating_m, p.coating_s, dt_s);
        state.lost_k = lag(state.lost_k, lost_k, p.lost_s, dt_s);
        // a kiln is closed by a ring of its own radius, and what is left of a brick is its back
        if turn.failed.has(Failure::RingGrowing) {
            state.ring_m = (state.ring_m + p.ring_growth_m_s * dt_s).min(p.shell_m / 2.0);
        }
        state.brick_m = (state.brick_m - p.wear_m_s * dt_s).max(0.01 * p.brick_m);
    }

    fn effect(&self, state: &State) -> TemperatureField {
        TemperatureField {
            zones_degc: state.zones_degc,
            spots: self.spots(state),
            length_m: self.p.length_m,
            radius_m: self.p.shell_m / 2.0,
            ambient_degc: state.ambient_degc,
            angle_rad: state.angle_rad,
            bend: Bend::default(),
        }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn) -> Outputs {
        let first = (0, state.zones_degc[0]);
        let zones = || state.zones_degc.iter().copied().enumerate();
        let (hottest, hottest_degc) = zones().fold(first, |most, zone| if zone.1 > most.1 { zone } else { most });
        let (_, coldest_degc) = zones().fold(first, |least, zone| if zone.1 < least.1 { zone } else { least });
        let area_m2 = PI * self.p.shell_m * self.p.length_m / ZONES as f64;
        let loss = |(zone, degc): (usize, f64)| area_m2 * self.wall(state, 0.0, zone).loss_w(degc);
        let draught = self.draught(turn.failed);
        let [zone_1_degc, zone_2_degc, zone_3_degc, zone_4_degc, zone_5_degc, zone_6_degc, zone_7_degc, zone_8_degc] =
            self.parts_degc(state);
        Outputs {
            hottest_degc,
            hottest_m: self.middle_m(hottest),
            coldest_degc,
            lost_degc: state.lost_k,
            coating_most_m: (0..ZONES).map(|zone| self.coating_at(state, zone)).fold(0.0, f64::max),
            brick_least_m: state.brick_m,
            loss_w: zones().map(loss).sum(),
            flow_pct: 100.0 * draught.flow(),
            hood_pa: draught.left_of(self.p.hood_pct / 100.0 * self.p.draught_pa),
            across_pa: self.p.draught_pa - draught.left_of(self.p.draught_pa),
            zone_1_degc,
            zone_2_degc,
            zone_3_degc,
            zone_4_degc,
            zone_5_degc,
            zone_6_degc,
            zone_7_degc,
            zone_8_degc,
        }
    }
}

#[cfg(test)]
mod tests;
