//! A pyrometer: the temperature of a surface that turns past it, at one place.
//!
//! # Equations
//! - `τ dx/dt = T(x_0, φ) − x`, exact over a period, with `φ` the angle of the shell that passes, a bend
//!   included;
//! - set to another emissivity than the surface's it shows what Wien's law says at 3.9 µm: `1/T' = 1/T − λ/c₂·ln(ε/ε_set)`.
//!
//! # Source
//! Closed form; law of Wien.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use crate::coupling::SeesHeat;
use crate::scanner::optics::shown_degc;
use crate::temperature_field::TemperatureField;

parameters! {
    /// Where it looks, and how.
    Parameters {
        /// the place along the shell that it looks at
        place_m: f64 = 0.0 => 0.0, 300.0;
        /// time constant
        lag_s: f64 = 0.0 => 0.0, 1e5;
        /// of the surface
        emissivity_pct: f64 = 95.0 => 5.0, 100.0;
        /// that it is set to
        set_emissivity_pct: f64 = 95.0 => 5.0, 100.0;
        /// part of the radiation that a dirty window lets through
        dirty_pct: f64 = 60.0 => 1.0, 100.0;
    }
}

signals! {
    /// It takes nothing.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// what it shows
        measured_degc: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// its window is dirty: it sees less
        Dirty = "dirty",
        /// its wire is broken: it shows absolute zero
        BrokenWire = "broken_wire",
    }
}

/// Absolute zero, °C.
const NOTHING_DEGC: f64 = -273.15;

/// What it remembers; nothing before its first look.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    shown_degc: Option<f64>,
}

/// A pyrometer by its parameters.
pub(crate) struct Pyrometer {
    p: Parameters,
}

impl Component for Pyrometer {
    const NAME: &'static str = "pyrometer";
    const SUMMARY: &'static str = "pyrometer: temperature of a heated surface at one place";
    const FORMULA: &'static [&'static str] = &["τ dx/dt = T(x_0, φ) - x", "1/T' = 1/T - λ/c₂ ln(ε/ε_set)"];
    const SOURCE: &'static str = "closed form; law of Wien";
    own_types!(senses SeesHeat);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<TemperatureField>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<TemperatureField>) -> Outputs {
        let clear = if turn.failed.has(Failure::Dirty) { self.p.dirty_pct / 100.0 } else { 1.0 };
        let surface_degc = turn.seen.seen_at(self.p.place_m);
        let seen_degc = shown_degc(surface_degc, self.p.emissivity_pct / 100.0 * clear, self.p.set_emissivity_pct / 100.0);
        let before_degc = state.shown_degc.filter(|_| turn.dt_s > 0.0).unwrap_or(seen_degc);
        let shown = lag(before_degc, seen_degc, self.p.lag_s, turn.dt_s);
        state.shown_degc = Some(shown);
        Outputs { measured_degc: if turn.failed.has(Failure::BrokenWire) { NOTHING_DEGC } else { shown } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;
    use crate::temperature_field::{Spot, ZONES};

    fn rig(lag_s: f64, angle_deg: f64) -> Rig<Pyrometer> {
        let spot = Spot { more_k: 60.0, at_m: 22.0, at_rad: 130_f64.to_radians(), along_m: 0.8, around_m: 0.8 };
        let mut rig = Rig::new(Pyrometer::new(Parameters { place_m: 22.0, lag_s, ..Parameters::default() }));
        rig.seen = TemperatureField {
            zones_degc: [300.0; ZONES],
            spots: [spot, Spot::default()],
            length_m: 60.0,
            radius_m: 2.0,
            angle_rad: angle_deg.to_radians(),
            ..TemperatureField::default()
        };
        rig
    }

    #[test]
    fn it_sees_the_spot_pass() {
        let at = |angle| rig(Parameters::default().lag_s, angle).run(Inputs {}, 0.01, 1).measured_degc;
        assert!((at(130.0) - 360.0).abs() < 1e-9 && (at(310.0) - 300.0).abs() < 1e-9);
    }

    #[test]
    fn a_lag_and_each_failure_have_their_effect() {
        let mut slow = rig(1.0, 310.0);
        slow.run(Inputs {}, 0.01, 1);
        slow.seen.angle_rad = 130_f64.to_radians();
        let after = slow.run(Inputs {}, 0.01, 100).measured_degc;
        assert!((after - (300.0 + 60.0 * (1.0 - libm::exp(-1.0)))).abs() < 1e-6, "{after}");
        let failing = |mode| rig(Parameters::default().lag_s, 310.0).failing(mode).run(Inputs {}, 0.01, 1).measured_degc;
        assert!(failing(Failure::Dirty) < 290.0 && failing(Failure::BrokenWire) == NOTHING_DEGC);
    }
}
