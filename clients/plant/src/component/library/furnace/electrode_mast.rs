//! A mast that carries a graphite electrode of an arc furnace: hydraulic drive, tip, contact, consumption.
//!
//! # Equations
//! - The velocity of the mast follows the valve with a lag: `v → speed·valve`, up to its stops.
//! - Tip over the scrap or bath: `L = mast + highest tip - electrode - surface`, the length of the arc; below 0 the
//!   electrode presses with `F = k·(-L)`, and breaks above a force.
//! - Tip consumption is in proportion to the energy of the arc: `dm/dt = consumption·P`, `dl/dt = dm/dt / (ρ π d²/4)`.
//!
//! # Source
//! Closed form; electrodes of Ø 400 × 6500 mm: `[Vergnano]` sec. 4.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;

/// Density of graphite, kg/m³.
const GRAPHITE_KG_M3: f64 = 1700.0;
/// J in a megawatt-hour.
const MWH_J: f64 = 3.6e9;
/// An electrode over which there is no arc: longer than any voltage carries, m.
const NO_ARC_M: f64 = 10.0;
/// How fast a mast sinks whose hose has burst, of its speed.
const SINKING: f64 = 0.5;
/// How fast an electrode slides out of a clamp that slips, m/s.
const SLIPPING_M_S: f64 = 0.05;

parameters! {
    /// Mast and electrode.
    Parameters {
        /// speed at the full valve
        speed_m_s: f64 = 0.15 => 1e-3, 2.0;
        /// time constant of the drive
        lag_s: f64 = 0.15 => 0.0, 10.0;
        /// stroke of the mast
        stroke_m: f64 = 5.0 => 0.1, 20.0;
        /// where the mast stands at the start
        start_m: f64 = 5.0 => 0.0, 20.0;
        /// height of the clamp over the floor of the vessel when the mast is down
        clamp_m: f64 = 5.5 => 0.1, 30.0;
        /// length of a new electrode below its clamp
        electrode_m: f64 = 5.5 => 0.1, 30.0;
        /// diameter of the electrode
        diameter_m: f64 = 0.4 => 0.05, 1.0;
        /// graphite that the arc takes
        consumption_kg_mwh: f64 = 1.5 => 0.0, 20.0;
        /// how stiff scrap and mast are against an electrode that presses on scrap
        stiffness_n_m: f64 = 200_000.0 => 1.0, 1e9;
        /// force that breaks the electrode
        breaking_n: f64 = 20000.0 => 1.0, 1e9;
        /// how much of the electrode falls when it breaks
        piece_m: f64 = 1.0 => 0.0, 10.0;
        /// pressure of the cylinder that holds the mast
        pressure_bar: f64 = 80.0 => 1.0, 500.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// valve of the cylinder, -1 (down) to 1 (up)
        valve: f64,
        /// height of scrap or bath below the electrode, over the floor of the vessel
        surface_m: f64,
        /// power of its arc
        arc_w: f64,
        /// the clamp is opened and the electrode lowered in it to its new length, after pieces have been joined on
        slip: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// height of the mast over its lowest position
        position_m: f64,
        /// height of the tip over the floor of the vessel
        tip_m: f64,
        /// length of the arc, 0 in contact
        arc_m: f64,
        /// the electrode touches
        contact: bool,
        /// force on the tip
        force_n: f64,
        /// length of the electrode below its clamp
        electrode_m: f64,
        /// graphite that the arc has taken
        consumed_kg: f64,
        /// the electrode has broken
        broken: bool,
        /// pressure of the cylinder
        pressure_bar: f64,
        /// the mast is at its upper stop
        up: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// a hose of the cylinder has burst: no pressure, and the mast sinks
        HoseBurst = "hose_burst",
        /// the valve is stuck in its middle
        Stuck = "stuck",
        /// the clamp slips: the electrode slides down
        ClampSlips = "clamp_slips",
        /// what lies below does not conduct: no arc, and the electrode goes down on it
        Insulated = "insulated",
        /// the electrode breaks off
        Breakage = "breakage",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    position_m: f64,
    velocity_m_s: f64,
    electrode_m: f64,
    consumed_kg: f64,
    broken: bool,
}

/// A mast by its parameters.
pub(crate) struct ElectrodeMast {
    p: Parameters,
}

impl ElectrodeMast {
    fn tip_m(&self, state: &State) -> f64 {
        self.p.clamp_m + state.position_m - state.electrode_m
    }

    fn force_n(&self, state: &State, surface_m: f64) -> f64 {
        self.p.stiffness_n_m * (surface_m - self.tip_m(state)).max(0.0)
    }

    fn travel(&self, state: &mut State, valve: f64, turn: &Turn) {
        let wanted_m_s = if turn.failed.has(Failure::HoseBurst) {
            -SINKING * self.p.speed_m_s
        } else if turn.failed.has(Failure::Stuck) {
            0.0
        } else {
            valve.clamp(-1.0, 1.0) * self.p.speed_m_s
        };
        state.velocity_m_s = lag(state.velocity_m_s, wanted_m_s, self.p.lag_s, turn.dt_s);
        let free_m = state.position_m + state.velocity_m_s * turn.dt_s;
        state.position_m = free_m.clamp(0.0, self.p.stroke_m);
        if state.position_m != free_m {
            state.velocity_m_s = 0.0;
        }
    }

    fn consume(&self, state: &mut State, arc_w: f64, dt_s: f64) {
        let taken_kg = self.p.consumption_kg_mwh * arc_w.max(0.0) / MWH_J * dt_s;
        let section_m2 = PI * self.p.diameter_m * self.p.diameter_m / 4.0;
        state.consumed_kg += taken_kg;
        state.electrode_m = (state.electrode_m - taken_kg / (GRAPHITE_KG_M3 * section_m2)).max(0.0);
    }
}

impl Component for ElectrodeMast {
    const NAME: &'static str = "electrode_mast";
    const SUMMARY: &'static str = "hydraulic mast with a graphite electrode of an arc furnace";
    const FORMULA: &'static [&'static str] =
        &["L = clamp + mast - electrode - surface", "F = k·(-L), broken above a force", "dm/dt = consumption·P"];
    const SOURCE: &'static str = "closed form; electrodes: Vergnano et al., 2012, sec. 4";
    const INITIAL: &'static [&'static str] = &["start_m"];
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State {
            position_m: self.p.start_m.min(self.p.stroke_m),
            velocity_m_s: 0.0,
            electrode_m: self.p.electrode_m,
            consumed_kg: 0.0,
            broken: false,
        }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        self.travel(state, inputs.valve, turn);
        self.consume(state, inputs.arc_w, turn.dt_s);
        if turn.failed.has(Failure::ClampSlips) {
            state.electrode_m = (state.electrode_m + SLIPPING_M_S * turn.dt_s).min(self.p.clamp_m + self.p.stroke_m);
        }
        let breaks = turn.failed.has(Failure::Breakage) || self.force_n(state, inputs.surface_m) > self.p.breaking_n;
        if breaks && !state.broken {
            state.electrode_m = (state.electrode_m - self.p.piece_m).max(0.0);
            state.broken = true;
        }
        // a new piece is joined on away from the furnace; what is left of an old one counts for nothing
        if inputs.slip && !breaks {
            state.electrode_m = self.p.electrode_m;
            state.broken = false;
        }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let length_m = self.tip_m(state) - inputs.surface_m;
        let insulated = turn.failed.has(Failure::Insulated);
        Outputs {
            position_m: state.position_m,
            tip_m: self.tip_m(state),
            arc_m: if insulated { NO_ARC_M } else { length_m.max(0.0) },
            contact: length_m <= 0.0,
            force_n: self.force_n(state, inputs.surface_m),
            electrode_m: state.electrode_m,
            consumed_kg: state.consumed_kg,
            broken: state.broken,
            pressure_bar: if turn.failed.has(Failure::HoseBurst) { 0.0 } else { self.p.pressure_bar },
            up: state.position_m >= self.p.stroke_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const DOWN: Inputs = Inputs { valve: -1.0, surface_m: 0.4, arc_w: 0.0, slip: false };

    fn rig() -> Rig<ElectrodeMast> {
        Rig::new(ElectrodeMast::new(Parameters::default()))
    }

    #[test]
    fn the_mast_follows_its_valve_with_a_lag() {
        let out = rig().run(DOWN, 0.001, 10_000);
        // 10 s at 0.15 m/s without 0.15 s of lag; the velocity is that at the end of each step
        assert!((out.position_m - (5.0 - 0.15 * (10.0 - 0.15))).abs() < 1e-4, "{out:?}");
        assert!((out.tip_m - out.position_m).abs() < 1e-12 && (out.arc_m - (out.tip_m - 0.4)).abs() < 1e-12);
        let up = rig().run(Inputs { valve: 1.0, ..DOWN }, 0.01, 100);
        assert!(up.up && up.position_m == 5.0, "{up:?}");
    }

    #[test]
    fn an_electrode_that_presses_breaks_at_its_force() {
        let mut rig = rig();
        let slow = Inputs { valve: -0.1, surface_m: 4.99, ..DOWN };
        let mut greatest_n = 0f64;
        let out = loop {
            let out = rig.run(slow, 0.01, 1);
            if out.broken {
                break out;
            }
            greatest_n = greatest_n.max(out.force_n);
        };
        assert!(
            (greatest_n - 20e3).abs() < 50.0 && out.electrode_m == 4.5 && out.force_n == 0.0,
            "{greatest_n} {out:?}"
        );
        let joined = rig.run(Inputs { valve: 1.0, surface_m: 0.0, slip: true, ..DOWN }, 0.01, 1);
        assert!(!joined.broken && joined.electrode_m == 5.5, "{joined:?}");
    }

    #[test]
    fn the_arc_takes_graphite_in_proportion_to_its_energy() {
        let out = rig().run(Inputs { valve: 0.0, arc_w: 30e6, ..DOWN }, 1.0, 3600);
        assert!((out.consumed_kg - 45.0).abs() < 1e-9, "{out:?}");
        assert!((5.5 - out.electrode_m - 45.0 / (1700.0 * PI * 0.04)).abs() < 1e-9, "{out:?}");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let still = Inputs { valve: 0.0, ..DOWN };
        let burst = rig().failing(Failure::HoseBurst).run(still, 0.01, 1000);
        assert!(burst.pressure_bar == 0.0 && burst.position_m < 4.4, "{burst:?}");
        assert_eq!(rig().failing(Failure::Stuck).run(DOWN, 0.01, 100).position_m, 5.0);
        assert!((rig().failing(Failure::ClampSlips).run(still, 0.01, 100).electrode_m - 5.55).abs() < 1e-9);
        assert_eq!(rig().failing(Failure::Insulated).run(still, 0.01, 1).arc_m, NO_ARC_M);
        assert_eq!(rig().failing(Failure::Breakage).run(still, 0.01, 5).electrode_m, 4.5);
    }
}
