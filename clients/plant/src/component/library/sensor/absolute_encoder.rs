//! An absolute encoder: the position as a binary or a Gray number.
//!
//! # Equations
//! - code `n = floor(2^b (x - x_0) / X) mod 2^b`;
//! - in Gray code `n xor (n >> 1)`: one bit changes at a time.
//!
//! # Source
//! F. Gray, US patent 2632058 (1953).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::{Coordinate, Measures};

parameters! {
    /// Its parameters.
    Parameters {
        /// bits of the code
        bits: u32 = 13 => 1.0, 31.0;
        /// length, m, or angle, rad, of all codes
        span: f64 = std::f64::consts::TAU => 1e-6, 1e6;
        /// position, m or rad, of code 0
        offset: f64 = 0.0 => -1e6, 1e6;
        /// Gray code, not binary
        gray: bool = false;
    }
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// the code
        code: i32,
        /// the code can be trusted
        valid: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// a bit is stuck at 1: the least one
        BitStuck = "bit_stuck",
        /// the link is broken: code 0, not valid
        LinkDown = "link_down",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    code: u32,
}

/// An absolute encoder, by its parameters.
pub(crate) struct AbsoluteEncoder {
    p: Parameters,
}

impl Component for AbsoluteEncoder {
    const NAME: &'static str = "absolute_encoder";
    const SUMMARY: &'static str = "absolute encoder: position as a binary or a Gray number";
    const FORMULA: &'static [&'static str] = &["n = floor(2^b (x - x_0)/X) mod 2^b", "Gray: n xor (n >> 1)"];
    const SOURCE: &'static str = "F. Gray, US patent 2632058 (1953)";
    own_types!(senses Measures);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<Coordinate>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Coordinate>) -> Outputs {
        let position = turn.seen.position;
        let codes = 1_i64 << self.p.bits;
        let number = ((position - self.p.offset) / self.p.span * codes as f64).floor() as i64;
        let binary = number.rem_euclid(codes) as u32;
        state.code = if self.p.gray { binary ^ (binary >> 1) } else { binary };
        if turn.failed.has(Failure::LinkDown) {
            return Outputs { code: 0, valid: false };
        }
        let stuck = u32::from(turn.failed.has(Failure::BitStuck));
        Outputs { code: (state.code | stuck) as i32, valid: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;


    fn at(rig: &mut Rig<AbsoluteEncoder>, position: f64) -> i32 {
        rig.seen = Coordinate { position, velocity: 0.0 };
        rig.run(Inputs {}, 0.001, 1).code
    }

    fn rig(gray: bool) -> Rig<AbsoluteEncoder> {
        Rig::new(AbsoluteEncoder::new(Parameters { bits: 10, span: 2.0, offset: -0.5, gray }))
    }

    #[test]
    fn the_code_is_the_position_to_its_last_bit() {
        let mut rig = rig(false);
        assert_eq!([-0.5, 0.5, 1.499, 1.5, -0.501].map(|x| at(&mut rig, x)), [0, 512, 1023, 0, 1023]);
    }

    #[test]
    fn in_gray_code_one_bit_changes_at_a_time_and_all_codes_come() {
        let mut rig = rig(true);
        let codes: Vec<_> = (0..1024).map(|k| at(&mut rig, -0.499 + f64::from(k) / 512.0)).collect();
        assert!(codes.windows(2).all(|pair| (pair[0] ^ pair[1]).count_ones() == 1));
        assert_eq!((codes[0] ^ codes[1023]).count_ones(), 1, "from the last to the first");
        let mut sorted = codes.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..1024).collect::<Vec<_>>());
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(at(&mut rig(false).failing(Failure::BitStuck), -0.5), 1);
        assert!(!rig(false).failing(Failure::LinkDown).run(Inputs {}, 0.01, 1).valid);
    }
}
