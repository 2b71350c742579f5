//! The heat of a rotary kiln: through coating and brick to the shell, and from there to the air, zone by zone along it.
//!
//! # Equations
//! For each of 24 zones, per m² of shell:
//! - the gas is hottest at the flame, and its heat passes a film, the coating and the brick:
//!   `q_in = (T_gas − T)/(1/h_in + d_c/k_c + d_b/k_b)`, with `T_gas(x) = T_e + b·(T_f − T_e)·exp(−(x−x_f)²/2w²)` where `T_e` is
//!   at the ends and `b` what the burner gives;
//! - the shell loses it by convection and radiation: `q_out = h_out·(T − T_a) + ε·σ·(T⁴ − T_a⁴)`, temperatures in K there;
//! - `C·dT/dt = q_in − q_out`. A step is `T + f·(e^{Jh} − 1)/J` with `f` the right-hand side and `J` its slope, which is exact
//!   where that is a straight line, and for long steps becomes Newton's on the steady state: stable however long;
//! - coating grows to its thickness by a lag, brick wears evenly, a ring grows evenly at its place: exact for any step.
//!
//! A brick that is lost leaves a spot, which comes and goes by a lag. All of that is on the shell and turns with it.
//!
//! # Source
//! Closed form: heat balance of a wall in layers, law of Stefan and Boltzmann. Faults of the process: the thesis on the
//! shell scanner *Jacket*, 2009.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use crate::coupling::Heats;
use crate::temperature_field::{SPOTS, Spot, TemperatureField, ZONES};

/// Law of Stefan and Boltzmann, W/(m²·K⁴).
const SIGMA: f64 = 5.670_374_419e-8;
/// 0 °C in K.
const ZERO_K: f64 = 273.15;

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

    fn wall(&self, state: &State, burner: f64, zone: usize) -> Wall {
        let p = &self.p;
        let aside = (self.middle_m(zone) - p.flame_at_m) / p.flame_width_m;
        let hotter = burner * (p.flame_degc - p.ends_degc) * libm::exp(-0.5 * aside * aside);
        let layers = 1.0 / p.inside_w_m2_k + self.coating_at(state, zone) / p.coating_w_m_k + state.brick_m / p.brick_w_m_k;
        Wall {
            gas_degc: p.ends_degc + hotter,
            inside_w_k: 1.0 / layers,
            outside_w_k: p.outside_w_m2_k,
            radiation_w_k4: p.emissivity_pct / 100.0 * SIGMA,
            ambient_degc: state.ambient_degc,
        }
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
        "spots A exp(-(x - x_i)²/2σ_x² - R²(φ - φ_i)²/2σ_a²)",
    ];
    const SOURCE: &'static str = "closed form; faults of the process: Jacket, 2009";
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
            state.zones_degc =
                std::array::from_fn(|zone| self.wall(&state, unset.burner_pct / 100.0, zone).steady_degc());
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
        for zone in 0..ZONES {
            let wall = self.wall(state, burner, zone);
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
        }
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn) -> Outputs {
        let first = (0, state.zones_degc[0]);
        let zones = || state.zones_degc.iter().copied().enumerate();
        let (hottest, hottest_degc) = zones().fold(first, |most, zone| if zone.1 > most.1 { zone } else { most });
        let (_, coldest_degc) = zones().fold(first, |least, zone| if zone.1 < least.1 { zone } else { least });
        let area_m2 = PI * self.p.shell_m * self.p.length_m / ZONES as f64;
        let loss = |(zone, degc): (usize, f64)| area_m2 * self.wall(state, 0.0, zone).loss_w(degc);
        Outputs {
            hottest_degc,
            hottest_m: self.middle_m(hottest),
            coldest_degc,
            lost_degc: state.lost_k,
            coating_most_m: (0..ZONES).map(|zone| self.coating_at(state, zone)).fold(0.0, f64::max),
            brick_least_m: state.brick_m,
            loss_w: zones().map(loss).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const ON: Inputs = Inputs { burner_pct: 100.0, ambient_degc: 20.0, angle_rad: 0.0 };
    const DAY_S: f64 = 86400.0;

    fn rig(p: Parameters) -> Rig<KilnHeat> {
        Rig::new(KilnHeat::new(p))
    }

    /// A kiln that is the same all along, whose brick lets through just what a shell of 300 °C loses.
    fn by_hand() -> Parameters {
        let kelvin = |degc: f64| degc + 273.15;
        let loss = 15.0 * 280.0 + 0.85 * 5.670_374_419e-8 * (kelvin(300.0).powi(4) - kelvin(20.0).powi(4));
        let brick_m = (((1000.0 - 300.0) / loss) - 1.0 / 150.0) * 3.0;
        let p = Parameters::default();
        Parameters { ends_degc: 1000.0, flame_degc: 1000.0, coating_m: 0.0, coating_start_m: 0.0, brick_m, ..p }
    }

    #[test]
    fn the_steady_state_is_the_closed_form_whatever_the_step() {
        for (dt_s, turns) in [(10.0, 50_000), (3600.0, 200), (30.0 * DAY_S, 12)] {
            for start_degc in [-300.0, 20.0, 900.0] {
                let mut rig = rig(Parameters { start_degc, ..by_hand() });
                let out = rig.run(ON, dt_s, turns);
                assert!((out.hottest_degc - 300.0).abs() < 1e-6, "{dt_s} {start_degc} {out:?}");
                assert!((out.coldest_degc - 300.0).abs() < 1e-6, "{dt_s} {start_degc} {out:?}");
            }
        }
        // 4 m by 60 m of shell, each m² as computed
        let out = rig(by_hand()).run(ON, 1.0, 1);
        assert!((out.loss_w / (PI * 240.0) - (1000.0 - 300.0) / (by_hand().brick_m / 3.0 + 1.0 / 150.0)).abs() < 1e-6);
    }

    #[test]
    fn without_radiation_a_step_of_any_length_is_exact() {
        let p = Parameters { emissivity_pct: 0.0, start_degc: 20.0, ..by_hand() };
        let (g, h) = (1.0 / (p.brick_m / 3.0 + 1.0 / 150.0), 15.0);
        let (end, tau) = ((g * 1000.0 + h * 20.0) / (g + h), p.heat_j_m2_k / (g + h));
        for (dt_s, turns) in [(1.0, 7200), (7200.0, 1)] {
            let out = rig(p.clone()).run(ON, dt_s, turns);
            let exact = end + (20.0 - end) * libm::exp(-7200.0 / tau);
            assert!((out.hottest_degc - exact).abs() < 1e-7, "{dt_s}: {} {exact}", out.hottest_degc);
        }
    }

    #[test]
    fn half_the_step_leaves_a_quarter_of_the_error() {
        let after = |turns: u32| {
            let mut rig = rig(Parameters { start_degc: 20.0, ..Parameters::default() });
            rig.run(ON, 14_400.0 / f64::from(turns), turns).hottest_degc
        };
        let exact = after(50_000);
        let errors = [8, 16, 32].map(|turns| (after(turns) - exact).abs());
        assert!(errors[0] / errors[1] > 3.5 && errors[1] / errors[2] > 3.5, "{errors:?}");
    }

    #[test]
    fn a_flame_makes_its_place_hottest_and_a_ring_makes_its_place_cold() {
        let mut kiln = rig(Parameters::default());
        let out = kiln.run(ON, 60.0, 1);
        assert!((out.hottest_m - 15.0).abs() < 2.0 && (250.0..400.0).contains(&out.hottest_degc), "{out:?}");
        let field = kiln.component.effect(&kiln.state);
        let mut ringed = rig(Parameters::default()).failing(Failure::RingGrowing);
        let out = ringed.run(ON, 3600.0, 5 * 24);
        // five days at 1 µm/s; the middles of the nearest zones are 1.25 m aside
        let thickest = 0.1 + 0.432 * libm::exp(-0.5 * (1.25_f64 / 1.5).powi(2));
        assert!((out.coating_most_m - thickest).abs() < 1e-9, "{out:?}");
        let colder = field.at(40.0, 0.0) - ringed.component.effect(&ringed.state).at(40.0, 0.0);
        assert!(colder > 40.0, "{colder}");
    }

    #[test]
    fn a_lost_brick_grows_a_spot_by_its_lag_and_repair_lets_it_go() {
        let mut rig = rig(Parameters::default()).failing(Failure::BrickLost);
        let out = rig.run(ON, 60.0, 120);
        assert!((out.lost_degc - 150.0 * (1.0 - libm::exp(-1.0))).abs() < 1e-9, "{out:?}");
        let field = rig.component.effect(&rig.state);
        let angle = 250_f64.to_radians();
        assert!((field.at(18.0, angle) - field.at(18.0, angle + PI) - out.lost_degc).abs() < 1e-9);
    }

    #[test]
    fn months_wear_the_brick_and_warm_the_shell() {
        let mut rig = rig(Parameters { wear_m_s: 2e-9, ..Parameters::default() });
        let new = rig.run(ON, 60.0, 1).hottest_degc;
        let worn = rig.run(ON, 3600.0, 24 * 365);
        assert!((worn.brick_least_m - (0.2 - 2e-9 * (365.0 * DAY_S + 60.0))).abs() < 1e-9, "{worn:?}");
        assert!(worn.hottest_degc > new + 20.0, "{new} {worn:?}");
    }

    #[test]
    fn each_other_failure_has_its_effect() {
        let whole = rig(Parameters::default()).run(ON, 3600.0, 48).hottest_degc;
        let out = rig(Parameters::default()).failing(Failure::BurnerOut).run(ON, 3600.0, 48);
        assert!(out.hottest_degc < whole - 50.0, "{whole} {out:?}");
        let bare = rig(Parameters::default()).failing(Failure::CoatingFalls).run(ON, 3600.0, 480);
        assert!(bare.coating_most_m < 1e-3 && bare.hottest_degc > whole + 20.0, "{whole} {bare:?}");
    }
}
