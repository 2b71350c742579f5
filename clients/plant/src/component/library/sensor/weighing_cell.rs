//! A weighing cell with its indicator: what bodies press on a platform.
//!
//! # Equations
//! - `τ dx/dt = m - x`, exact over a period, with the mass m whose weight presses along gravity: the sum of the forces in
//!   the contacts, so that what lies on a load counts, and what a blow adds. `τ = settling_s / ln 100`: after `settling_s`
//!   a hundredth of a step is left;
//! - `gross = d round(x/d)`, `net = d round((x - tare)/d)` with the division d;
//! - `stable` while x has stayed within one division for `stable_s`;
//! - `overload` above `capacity_kg + 9 d`.
//!
//! # Source
//! OIML R 60 (load cells); OIML R 76-1:2006, 4.2.3 (9 e above the capacity), 4.4.2 (stable equilibrium); EN 45501.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{OnDelay, lag, quantised};
use crate::coupling::{Pressing, Weighs};

/// ln 100: in so many time constants all but a hundredth of a step has come.
const TO_A_HUNDREDTH: f64 = 4.605_170_185_988_092;
/// So many divisions above its capacity it shows a load.
const BEYOND: f64 = 9.0;

parameters! {
    /// Its parameters.
    Parameters {
        /// greatest load
        capacity_kg: f64 = 30.0 => 1e-3, 1e6;
        /// division of the indicator
        division_kg: f64 = 0.01 => 1e-6, 1e4;
        /// until a hundredth of a step is left
        settling_s: f64 = 0.5 => 0.0, 100.0;
        /// how long the load must stay within a division
        stable_s: f64 = 0.3 => 0.0, 100.0;
        /// how fast the zero runs away, if it drifts
        drift_kg_s: f64 = 0.01 => -1e3, 1e3;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// rising: what lies on it is tare from now on
        tare: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// all that presses
        gross_kg: f64,
        /// the same without the tare
        net_kg: f64,
        /// the load stays within a division
        stable: bool,
        /// more than it can show
        overload: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the zero drifts by `drift_kg_s`
        Drift = "drift",
        /// the platform sticks: the load that it feels stands
        Stuck = "stuck",
        /// a wire of the bridge is open: overload
        Open = "open",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    felt_kg: f64,
    drift_kg: f64,
    tare_kg: f64,
    tared: bool,
    /// What the load has stayed within a division of.
    stands_kg: f64,
    standing: OnDelay,
}

/// A weighing cell, by its parameters.
pub(crate) struct WeighingCell {
    p: Parameters,
}

impl Component for WeighingCell {
    const NAME: &'static str = "weighing_cell";
    const SUMMARY: &'static str = "weighing cell and indicator: gross, net, tare, stable, overload";
    const FORMULA: &'static [&'static str] =
        &["τ dx/dt = m - x, τ = settling_s / ln 100", "gross = d round(x/d), net = d round((x - tare)/d)"];
    const SOURCE: &'static str = "OIML R 60; OIML R 76-1:2006, 4.2.3 and 4.4.2; EN 45501";
    own_types!(senses Weighs);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Pressing>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Pressing>) -> Outputs {
        let p = &self.p;
        if !turn.failed.has(Failure::Stuck) {
            state.felt_kg = lag(state.felt_kg, turn.seen.kg, p.settling_s / TO_A_HUNDREDTH, turn.dt_s);
        }
        // the zero is set again by who repairs it
        let drifts = turn.failed.has(Failure::Drift);
        state.drift_kg = if drifts { state.drift_kg + p.drift_kg_s * turn.dt_s } else { 0.0 };
        let load_kg = state.felt_kg + state.drift_kg;
        let before = std::mem::replace(&mut state.tared, inputs.tare);
        if inputs.tare && !before {
            state.tare_kg = load_kg;
        }
        let stands = (load_kg - state.stands_kg).abs() <= p.division_kg;
        if !stands {
            state.stands_kg = load_kg;
        }
        let stable = state.standing.holds(stands, p.stable_s, turn.dt_s);
        let most_kg = p.capacity_kg + BEYOND * p.division_kg;
        let open = turn.failed.has(Failure::Open);
        if open || load_kg > most_kg {
            return Outputs { gross_kg: most_kg, net_kg: most_kg, stable: stable && !open, overload: true };
        }
        let shown = |kg: f64| quantised(kg, p.division_kg);
        Outputs { gross_kg: shown(load_kg), net_kg: shown(load_kg - state.tare_kg), stable, overload: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const WEIGH: Inputs = Inputs { tare: false };
    const TARE: Inputs = Inputs { tare: true };

    fn rig(p: Parameters, kg: f64) -> Rig<WeighingCell> {
        let mut rig = Rig::new(WeighingCell::new(p));
        rig.seen = Pressing { kg };
        rig
    }

    #[test]
    fn a_step_comes_through_the_lag_at_any_period() {
        for dt_s in [0.001, 0.01, 0.1] {
            let fine = Parameters { division_kg: 1e-6, ..Parameters::default() };
            let mut rig = rig(fine, 10.0);
            let out = rig.run(WEIGH, dt_s, (0.5 / dt_s).round() as u32);
            assert!((out.gross_kg - 9.9).abs() < 1e-6, "a hundredth is left: {out:?}");
            let out = rig.run(WEIGH, dt_s, (0.5 / dt_s).round() as u32);
            assert!((out.gross_kg - 9.999).abs() < 1e-6, "{out:?}");
        }
    }

    #[test]
    fn it_shows_divisions_and_takes_tare_off() {
        let mut rig = rig(Parameters { division_kg: 0.02, settling_s: 0.0, ..Parameters::default() }, 2.513);
        let out = rig.run(WEIGH, 0.01, 1);
        assert!((out.gross_kg - 2.52).abs() < 1e-12 && out.net_kg == out.gross_kg, "{out:?}");
        assert_eq!(rig.run(TARE, 0.01, 1).net_kg, 0.0);
        rig.seen.kg = 3.513;
        let out = rig.run(TARE, 0.01, 1);
        assert!(
            (out.net_kg - 1.0).abs() < 1e-12 && (out.gross_kg - 3.52).abs() < 1e-12,
            "a held tare acts once: {out:?}"
        );
    }

    #[test]
    fn it_is_stable_when_the_load_has_stood_for_its_time() {
        let mut rig = rig(Parameters { settling_s: 0.0, ..Parameters::default() }, 5.0);
        // the load comes in the first turn; 0.3 s after it has come it is stable
        let stable: Vec<_> = (0..32).map(|_| rig.run(WEIGH, 0.01, 1).stable).collect();
        assert_eq!(stable.iter().position(|stable| *stable), Some(30));
        rig.seen.kg = 5.02;
        assert!(!rig.run(WEIGH, 0.01, 1).stable && rig.run(WEIGH, 0.01, 30).stable);
    }

    #[test]
    fn beyond_nine_divisions_it_is_overloaded() {
        let fast = || Parameters { settling_s: 0.0, ..Parameters::default() };
        assert!(!rig(fast(), 30.089).run(WEIGH, 0.01, 1).overload);
        assert!(rig(fast(), 30.091).run(WEIGH, 0.01, 1).overload);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let fast = || Parameters { settling_s: 0.0, ..Parameters::default() };
        let drifts = rig(fast(), 1.0).failing(Failure::Drift).run(WEIGH, 0.1, 100);
        assert!((drifts.gross_kg - 1.1).abs() < 1e-9, "{drifts:?}");
        assert_eq!(rig(fast(), 1.0).failing(Failure::Stuck).run(WEIGH, 0.1, 100).gross_kg, 0.0);
        let open = rig(fast(), 1.0).failing(Failure::Open).run(WEIGH, 0.1, 100);
        assert!(open.overload && !open.stable);
    }
}
