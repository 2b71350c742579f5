//! Faults on the way of a signal, at work.
//!
//! Draws are made by the step or by the change, never by the commit, so that a signal is disturbed alike
//! in parallel and in sequential coupling.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::draws::{Draws, Onset};
use super::line::LineFault;
use super::number::{deviate, flip, has_bits, number, offset, shift};
use super::push::Pushes;
use crate::operation::SignalFault;
use crate::signal::SignalType;

/// Longest queue of a late signal, in steps: no test needs a million.
const LATE_STEPS_MAX: usize = 1_000_000;

/// A fault at work.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) enum Disturbance {
    /// The value that the signal keeps.
    Stuck(Vec<u8>),
    Inverted,
    /// Of a line of bytes.
    Line(LineFault),
    /// Added to a number of the signal's type, in the bytes of `f64` for REAL and LREAL and of `i64`
    /// for integers.
    Offset([u8; 8]),
    /// Values on their way, the oldest first: as many as the fault is steps long.
    Late(VecDeque<Vec<u8>>),
    Lost {
        draws: Draws,
        /// What the writer's value was at the last look.
        looked: Vec<u8>,
        /// The last value that was not lost.
        kept: Vec<u8>,
    },
    LostSteps {
        draws: Draws,
        /// Whether the values of the step under way are lost.
        lost: bool,
        kept: Vec<u8>,
    },
    Pushed {
        pushes: Pushes,
        kept: Vec<u8>,
    },
    Flipped {
        draws: Draws,
        /// Where the bit lies that is inverted in the step under way, if one is.
        at: Option<u64>,
    },
    Noisy {
        draws: Draws,
        /// The normal deviate of the step under way, as the bits of an `f64`.
        deviate: u64,
    },
}

impl Disturbance {
    /// The fault as it begins; nothing if the signal's type cannot have it.
    pub(super) fn begin(fault: &SignalFault, onset: &Onset<'_>) -> Option<Self> {
        let Onset { ty, committed, .. } = *onset;
        if let (SignalType::Bytes(_), Some(fault)) = (ty, LineFault::begin(fault, onset)) {
            return Some(Self::Line(fault));
        }
        Some(match fault {
            SignalFault::Stuck => Self::Stuck(committed.to_vec()),
            SignalFault::Inverted => (ty == SignalType::BOOL).then_some(Self::Inverted)?,
            SignalFault::Offset { by } => Self::Offset(offset(ty, by)?),
            SignalFault::Late { by } => {
                let steps = usize::try_from(by.as_nanos().div_ceil(onset.step.as_nanos())).ok()?;
                let values = || std::iter::repeat_n(committed.to_vec(), steps).collect();
                (steps <= LATE_STEPS_MAX).then(|| Self::Late(values()))?
            }
            SignalFault::Lost { rate, seed } => {
                let draws = Draws::at_rate(rate, *seed, onset)?;
                Self::Lost { draws, looked: committed.to_vec(), kept: committed.to_vec() }
            }
            SignalFault::LostSteps { rate, seed } => {
                let mut draws = Draws::at_rate(rate, *seed, onset)?;
                let lost = draws.happens();
                Self::LostSteps { draws, lost, kept: committed.to_vec() }
            }
            SignalFault::Pushed { interval, seed } => {
                Self::Pushed { pushes: Pushes::new(*interval, *seed, onset)?, kept: committed.to_vec() }
            }
            SignalFault::Flipped { rate, seed } => {
                let mut draws = has_bits(ty).then(|| Draws::at_rate(rate, *seed, onset))??;
                let at = draws.bit();
                Self::Flipped { draws, at }
            }
            SignalFault::Silent | SignalFault::Cut => return None,
            SignalFault::Noisy { sigma, seed } => {
                let sigma: f64 = number(ty).and(sigma.parse().ok())?;
                let mut draws = (sigma.is_finite() && sigma >= 0.0).then(|| Draws::new(sigma, *seed, onset))?;
                let deviate = draws.normal();
                Self::Noisy { draws, deviate }
            }
        })
    }

    /// What arrives of a value. The last commit of a step moves on to the draws of the next one.
    pub(super) fn pass(&mut self, ty: SignalType, bytes: &mut [u8], ends_step: bool) {
        match self {
            Self::Stuck(kept) => bytes.copy_from_slice(kept),
            Self::Inverted => bytes[0] ^= 1,
            Self::Line(fault) => fault.pass(ty, bytes, ends_step),
            Self::Offset(by) => shift(ty, bytes, *by),
            Self::Late(values) => {
                if ends_step {
                    values.push_back(bytes.to_vec());
                    if let Some(oldest) = values.pop_front() {
                        bytes.copy_from_slice(&oldest);
                    }
                } else if let Some(oldest) = values.front() {
                    bytes.copy_from_slice(oldest);
                }
            }
            Self::Lost { draws, looked, kept } => {
                if looked != bytes {
                    looked.copy_from_slice(bytes);
                    if !draws.happens() {
                        kept.copy_from_slice(bytes);
                    }
                }
                bytes.copy_from_slice(kept);
            }
            Self::LostSteps { draws, lost, kept } => {
                if *lost {
                    bytes.copy_from_slice(kept);
                }
                if ends_step {
                    kept.copy_from_slice(bytes);
                    *lost = draws.happens();
                }
            }
            Self::Pushed { pushes, kept } => {
                if !pushes.is_due() {
                    bytes.copy_from_slice(kept);
                }
                if ends_step {
                    kept.copy_from_slice(bytes);
                    pushes.next_step();
                }
            }
            Self::Flipped { draws, at } => {
                if let Some(at) = at {
                    flip(ty, bytes, *at);
                }
                if ends_step {
                    *at = draws.bit();
                }
            }
            Self::Noisy { draws, deviate: by } => {
                deviate(ty, bytes, f64::from_bits(*by));
                if ends_step {
                    *by = draws.normal();
                }
            }
        }
    }

    /// True if a signal of this type could have it: what a checkpoint says is not believed.
    pub(super) fn fits(&self, ty: SignalType) -> bool {
        let sized = |bytes: &Vec<u8>| bytes.len() == ty.size();
        match self {
            Self::Stuck(bytes) | Self::LostSteps { kept: bytes, .. } => sized(bytes),
            Self::Late(values) => !values.is_empty() && values.iter().all(sized),
            Self::Pushed { pushes, kept } => sized(kept) && pushes.fits(),
            Self::Inverted => ty == SignalType::BOOL,
            Self::Line(fault) => fault.fits(ty),
            Self::Offset(_) | Self::Noisy { .. } => number(ty).is_some(),
            Self::Lost { looked, kept, .. } => sized(looked) && sized(kept),
            Self::Flipped { .. } => has_bits(ty),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{StepCount, TimeSpan};

    fn begun(fault: &SignalFault, ty: SignalType, committed: &[u8]) -> Option<Disturbance> {
        let step = TimeSpan::from_millis(10).expect("not zero");
        Disturbance::begin(fault, &Onset { ty, committed, step, steps: StepCount(3) })
    }

    /// Counts that are binomial: of 10⁶, within 5 σ.
    fn assert_is_part(count: usize, rate: f64) {
        let (n, k) = (1e6, count as f64);
        assert!((k - n * rate).abs() <= 5.0 * (n * rate * (1.0 - rate)).sqrt(), "{k} of {n}, not {rate}");
    }

    /// How many of 10⁶ steps arrive as they were sent, of a DINT that changes in each.
    fn arrived(fault: &SignalFault) -> usize {
        let mut fault = begun(fault, SignalType::DINT, &[0; 4]).expect("a fault of a number");
        let passed = (1_i32..=1_000_000).filter(|value| {
            let mut bytes = value.to_le_bytes();
            fault.pass(SignalType::DINT, &mut bytes, true);
            bytes == value.to_le_bytes()
        });
        passed.count()
    }

    #[test]
    fn so_many_changes_and_steps_are_lost_as_the_rate_says() {
        for rate in [0.0, 0.001, 0.25, 1.0] {
            let text = rate.to_string();
            for seed in [1, 2] {
                let rate_text = text.clone();
                let faults = [
                    SignalFault::Lost { rate: rate_text.clone(), seed },
                    SignalFault::LostSteps { rate: rate_text.clone(), seed },
                    SignalFault::Flipped { rate: rate_text, seed },
                ];
                for fault in faults {
                    assert_is_part(1_000_000 - arrived(&fault), rate);
                }
            }
        }
    }

    #[test]
    fn an_edge_that_is_lost_is_not_made_up_for() {
        let all = SignalFault::Lost { rate: "1".to_owned(), seed: 0 };
        let mut fault = begun(&all, SignalType::BOOL, &[0]).expect("a fault of a BOOL");
        for value in [0, 1, 1, 1, 0, 1] {
            let mut bytes = [value];
            fault.pass(SignalType::BOOL, &mut bytes, true);
            assert_eq!(bytes, [0], "the edge was lost once, and the level with it");
        }
    }

    #[test]
    fn a_frame_is_lost_as_a_whole() {
        let half = SignalFault::LostSteps { rate: "0.5".to_owned(), seed: 9 };
        let mut frame = [(); 2].map(|()| begun(&half, SignalType::DINT, &[0; 4]).expect("a fault"));
        for value in 1_i32..1000 {
            let seen = frame.each_mut().map(|fault| {
                let mut bytes = value.to_le_bytes();
                fault.pass(SignalType::DINT, &mut bytes, true);
                bytes
            });
            assert_eq!(seen[0], seen[1]);
        }
    }

    #[test]
    fn noise_has_its_deviation() {
        let noisy = SignalFault::Noisy { sigma: "0.5".to_owned(), seed: 4 };
        let mut fault = begun(&noisy, SignalType::LREAL, &[0; 8]).expect("a fault of a number");
        let drawn: Vec<f64> = (0..100_000)
            .map(|_| {
                let mut bytes = 3_f64.to_le_bytes();
                fault.pass(SignalType::LREAL, &mut bytes, true);
                f64::from_le_bytes(bytes) - 3.0
            })
            .collect();
        let mean = drawn.iter().sum::<f64>() / 1e5;
        let variance = drawn.iter().map(|x| x * x).sum::<f64>() / 1e5;
        // Five standard errors: σ/√n of the mean, √(2/n) of the variance.
        assert!(mean.abs() < 0.008 && (variance / 0.25 - 1.0).abs() < 0.0224, "{mean} {variance}");
    }

    #[test]
    fn within_a_step_nothing_is_drawn() {
        let faults = [
            SignalFault::LostSteps { rate: "0.5".to_owned(), seed: 1 },
            SignalFault::Flipped { rate: "0.5".to_owned(), seed: 1 },
            SignalFault::Noisy { sigma: "2".to_owned(), seed: 1 },
        ];
        for fault in faults {
            let mut once = begun(&fault, SignalType::DINT, &[0; 4]).expect("a fault of a number");
            let mut thrice = once.clone();
            for value in 1_i32..200 {
                let mut seen = [value.to_le_bytes(); 4];
                once.pass(SignalType::DINT, &mut seen[0], true);
                thrice.pass(SignalType::DINT, &mut seen[1], false);
                thrice.pass(SignalType::DINT, &mut seen[2], false);
                thrice.pass(SignalType::DINT, &mut seen[3], true);
                assert!(seen.iter().all(|other| *other == seen[0]), "{fault} {seen:?}");
            }
        }
    }

    #[test]
    fn what_a_type_cannot_have_is_refused() {
        let rate = |rate: &str| SignalFault::Lost { rate: rate.to_owned(), seed: 0 };
        for wrong in ["-0.1", "1.1", "NaN", "x"] {
            assert_eq!(begun(&rate(wrong), SignalType::BOOL, &[0]), None, "{wrong}");
        }
        assert!(begun(&rate("0.5"), SignalType::String(4), &[0; 6]).is_some());
        let flipped = SignalFault::Flipped { rate: "0.5".to_owned(), seed: 0 };
        assert_eq!(begun(&flipped, SignalType::String(4), &[0; 6]), None);
        for sigma in ["-1", "inf"] {
            let noisy = SignalFault::Noisy { sigma: sigma.to_owned(), seed: 0 };
            assert_eq!(begun(&noisy, SignalType::LREAL, &[0; 8]), None, "{sigma}");
        }
        let noisy = SignalFault::Noisy { sigma: "1".to_owned(), seed: 0 };
        assert_eq!(begun(&noisy, SignalType::BOOL, &[0]), None);
    }
}
