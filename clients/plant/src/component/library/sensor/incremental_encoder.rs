//! An incremental encoder: two tracks in quadrature and a zero pulse.
//!
//! # Equations
//! - count `n = floor(4 N (x - x_0) / X)`: quarter periods of N lines over the length or angle X;
//! - track A is true for n mod 4 in {1, 2}, B for {2, 3}; A leads B upwards;
//! - the zero pulse is one quarter period wide, once each X.
//!
//! # Source
//! IEC 61800-7-1, annex on encoder feedback.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::{Coordinate, Measures};

parameters! {
    /// Its parameters.
    Parameters {
        /// lines on a length or a turn
        lines: u32 = 1024 => 1.0, 1e6;
        /// length, m, or angle, rad, that has so many lines
        span: f64 = std::f64::consts::TAU => 1e-6, 1e6;
    }
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// track A
        track_a: bool,
        /// track B, a quarter period behind
        track_b: bool,
        /// zero pulse
        zero: bool,
        /// quarter periods since the set-up
        count: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// track A is dead; a counter counts nonsense
        TrackADead = "track_a_dead",
        /// the shaft slips: the disc stands
        Slipping = "slipping",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    start: f64,
    quarters: i64,
}

/// An incremental encoder, by its parameters.
pub(crate) struct IncrementalEncoder {
    p: Parameters,
}

impl Component for IncrementalEncoder {
    const NAME: &'static str = "incremental_encoder";
    const SUMMARY: &'static str = "incremental encoder: tracks A and B in quadrature, zero pulse, count";
    const FORMULA: &'static [&'static str] = &["n = floor(4 N x / X)", "A: n mod 4 in {1, 2}, B: n mod 4 in {2, 3}"];
    const SOURCE: &'static str = "IEC 61800-7-1, annex on encoder feedback";
    own_types!(senses Measures);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Coordinate>) -> State {
        State { start: start.seen.position, quarters: 0 }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Coordinate>) -> Outputs {
        let moved = turn.seen.position - state.start;
        if !turn.failed.has(Failure::Slipping) {
            state.quarters = (4.0 * f64::from(self.p.lines) * moved / self.p.span).floor() as i64;
        }
        let phase = state.quarters.rem_euclid(4);
        Outputs {
            track_a: matches!(phase, 1 | 2) && !turn.failed.has(Failure::TrackADead),
            track_b: matches!(phase, 2 | 3),
            zero: state.quarters.rem_euclid(4 * i64::from(self.p.lines)) == 0,
            // a counter of 32 bits turns over
            count: state.quarters as i32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;


    fn at(rig: &mut Rig<IncrementalEncoder>, position: f64) -> Outputs {
        rig.seen = Coordinate { position, velocity: 0.0 };
        rig.run(Inputs {}, 0.001, 1)
    }

    fn rig() -> Rig<IncrementalEncoder> {
        Rig::new(IncrementalEncoder::new(Parameters { lines: 100, span: 1.0 }))
    }

    #[test]
    fn counting_edges_gives_the_position_back() {
        let mut rig = rig();
        let (mut counted, mut before) = (0, at(&mut rig, 0.0));
        let code = |out: &Outputs| i32::from(out.track_a != out.track_b) + 2 * i32::from(out.track_b);
        for k in (1..=900).chain((0..900).rev()) {
            let position = f64::from(k) * 0.001;
            let now = at(&mut rig, position);
            counted += (code(&now) - code(&before) + 5).rem_euclid(4) - 1;
            assert_eq!(counted, now.count, "{k}");
            // one quarter period
            assert!((f64::from(now.count) / 400.0 - position).abs() <= 1.0 / 400.0 + 1e-12);
            before = now;
        }
        assert!(at(&mut rig, 1.001).zero && !at(&mut rig, 1.0026).zero && at(&mut rig, 0.001).zero);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(!at(&mut rig().failing(Failure::TrackADead), 0.003).track_a);
        assert_eq!(at(&mut rig().failing(Failure::Slipping), 0.5).count, 0);
    }
}
