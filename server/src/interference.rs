//! What lies over the values that writers stage: writes and forces from outside, and faults on the way
//! of a signal.
//!
//! A writer's own values stay as staged, so that a released or mended signal shows at once what its
//! writer last wrote, however long that client sleeps. Only what a commit makes visible is changed:
//! first by the fault, then by a write, then by a force, each hiding what is below it.

use std::collections::{BTreeMap, VecDeque};

use onescan_base::ElementaryType;
use onescan_base::elementary::Kind;
use serde::{Deserialize, Serialize};

use crate::layout::ImageLayout;
use crate::operation::SignalFault;
use crate::signal::{SignalId, SignalType};
use crate::time::TimeSpan;

/// A fault at work.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
enum Disturbance {
    /// The value that the signal keeps.
    Stuck(Vec<u8>),
    Inverted,
    /// Added to a number of the signal's type, in the bytes of `f64` for REAL and LREAL and of `i64`
    /// for integers.
    Offset([u8; 8]),
    /// Values on their way, the oldest first: as many as the fault is steps long.
    Late(VecDeque<Vec<u8>>),
}

/// Everything that lies over the writers' values, by signal.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct Interference {
    faults: BTreeMap<SignalId, Disturbance>,
    /// Values for the step under way; its last commit gives them to the writer's own values.
    writes: BTreeMap<SignalId, Vec<u8>>,
    forces: BTreeMap<SignalId, Vec<u8>>,
}

impl Interference {
    /// True while nothing lies over anything: a commit is a copy then.
    pub(crate) fn is_empty(&self) -> bool {
        self.faults.is_empty() && self.writes.is_empty() && self.forces.is_empty()
    }

    /// A value for one step; `bytes` has the signal's size.
    pub(crate) fn write(&mut self, signal: SignalId, bytes: Vec<u8>) {
        self.writes.insert(signal, bytes);
    }

    /// A value until it is released.
    pub(crate) fn force(&mut self, signal: SignalId, bytes: Vec<u8>) {
        // The force hides a write of the same boundary for good.
        self.writes.remove(&signal);
        self.forces.insert(signal, bytes);
    }

    /// True if the signal is forced.
    pub(crate) fn is_forced(&self, signal: SignalId) -> bool {
        self.forces.contains_key(&signal)
    }

    /// Ends a force; false if there was none.
    pub(crate) fn release(&mut self, signal: SignalId) -> bool {
        self.forces.remove(&signal).is_some()
    }

    /// Puts a fault on a signal in place of the one it has; `committed` is its value. False if its
    /// type cannot have that fault.
    pub(crate) fn disturb(
        &mut self,
        signal: SignalId,
        fault: &SignalFault,
        ty: SignalType,
        committed: &[u8],
        step: TimeSpan,
    ) -> bool {
        let disturbance = match fault {
            SignalFault::Stuck => Disturbance::Stuck(committed.to_vec()),
            SignalFault::Inverted if ty == SignalType::BOOL => Disturbance::Inverted,
            SignalFault::Inverted => return false,
            SignalFault::Offset { by } => match offset(ty, by) {
                Some(bytes) => Disturbance::Offset(bytes),
                None => return false,
            },
            SignalFault::Late { by } => {
                let steps = by.as_nanos().div_ceil(step.as_nanos());
                // A signal cannot be late by more values than memory has; no test needs a million.
                let Some(steps) = usize::try_from(steps).ok().filter(|steps| *steps <= LATE_STEPS_MAX) else {
                    return false;
                };
                Disturbance::Late(std::iter::repeat_n(committed.to_vec(), steps).collect())
            }
        };
        self.faults.insert(signal, disturbance);
        true
    }

    /// Ends a fault; false if there was none.
    pub(crate) fn mend(&mut self, signal: SignalId) -> bool {
        self.faults.remove(&signal).is_some()
    }

    /// Changes `committed`, which is a copy of `staged`. The last commit of a step moves time on for
    /// late signals and gives written values to the writers' own.
    #[cold]
    pub(crate) fn apply(&mut self, layout: &ImageLayout, staged: &mut [u8], committed: &mut [u8], ends_step: bool) {
        for (signal, fault) in &mut self.faults {
            let at = layout.range(*signal);
            disturbed(fault, layout.ty(*signal), &mut committed[at], ends_step);
        }
        for (signal, bytes) in &self.writes {
            let at = layout.range(*signal);
            committed[at.clone()].copy_from_slice(bytes);
            if ends_step {
                staged[at].copy_from_slice(bytes);
            }
        }
        if ends_step {
            self.writes.clear();
        }
        for (signal, bytes) in &self.forces {
            committed[layout.range(*signal)].copy_from_slice(bytes);
        }
    }

    /// True if it could lie over an image of this layout: what a checkpoint says is not believed.
    pub(crate) fn fits(&self, layout: &ImageLayout) -> bool {
        let known = |signal: &SignalId| signal.index() < layout.signals().len();
        let sized =
            |(signal, bytes): (&SignalId, &Vec<u8>)| known(signal) && bytes.len() == layout.range(*signal).len();
        let fault = |(signal, fault): (&SignalId, &Disturbance)| {
            known(signal)
                && match fault {
                    Disturbance::Stuck(bytes) => bytes.len() == layout.range(*signal).len(),
                    Disturbance::Late(values) => {
                        !values.is_empty() && values.iter().all(|bytes| bytes.len() == layout.range(*signal).len())
                    }
                    Disturbance::Inverted => layout.ty(*signal) == SignalType::BOOL,
                    Disturbance::Offset(_) => offset(layout.ty(*signal), "0").is_some(),
                }
        };
        self.forces.iter().all(sized) && self.writes.iter().all(sized) && self.faults.iter().all(fault)
    }
}

/// Longest queue of a late signal, in steps.
const LATE_STEPS_MAX: usize = 1_000_000;

fn disturbed(fault: &mut Disturbance, ty: SignalType, bytes: &mut [u8], ends_step: bool) {
    match fault {
        Disturbance::Stuck(kept) => bytes.copy_from_slice(kept),
        Disturbance::Inverted => bytes[0] ^= 1,
        Disturbance::Offset(by) => shift(ty, bytes, *by),
        Disturbance::Late(values) => {
            if ends_step {
                values.push_back(bytes.to_vec());
                if let Some(oldest) = values.pop_front() {
                    bytes.copy_from_slice(&oldest);
                }
            } else if let Some(oldest) = values.front() {
                bytes.copy_from_slice(oldest);
            }
        }
    }
}

/// The elementary type of a signal that can be shifted: an integer, a bit string or a real.
fn number(ty: SignalType) -> Option<ElementaryType> {
    match ty {
        SignalType::Elementary(ty) if ty.is_number() || ty.kind() == Kind::Bits => Some(ty),
        _ => None,
    }
}

/// The bytes of an offset for a signal of type `ty`; nothing if there is no such offset.
fn offset(ty: SignalType, by: &str) -> Option<[u8; 8]> {
    if number(ty)?.is_real() {
        let by: f64 = by.parse().ok()?;
        return by.is_finite().then(|| by.to_le_bytes());
    }
    by.parse::<i64>().ok().map(i64::to_le_bytes)
}

/// Shifts a number in place. NaN stays as it is: its canonical form is part of the digest.
fn shift(ty: SignalType, bytes: &mut [u8], by: [u8; 8]) {
    let Some(elementary) = number(ty) else {
        debug_assert!(false, "{ty} cannot be shifted, and `disturb` refuses it");
        return;
    };
    if let Some((low, high)) = elementary.range() {
        let size = bytes.len();
        let negative = elementary.is_signed() && bytes[size - 1] & 0x80 != 0;
        let mut wide = [if negative { 0xff } else { 0 }; 16];
        wide[..size].copy_from_slice(bytes);
        let value = (i128::from_le_bytes(wide) + i128::from(i64::from_le_bytes(by))).clamp(low, high);
        bytes.copy_from_slice(&value.to_le_bytes()[..size]);
        return;
    }
    let by = f64::from_le_bytes(by);
    if let Ok(real) = <[u8; 4]>::try_from(&*bytes) {
        let value = f64::from(f32::from_le_bytes(real)) + by;
        if !value.is_nan() {
            bytes.copy_from_slice(&(value as f32).to_le_bytes());
        }
    } else if let Ok(real) = <[u8; 8]>::try_from(&*bytes) {
        let value = f64::from_le_bytes(real) + by;
        if !value.is_nan() {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shifted<const N: usize>(ty: SignalType, value: [u8; N], by: &str) -> [u8; N] {
        let mut bytes = value;
        shift(ty, &mut bytes, offset(ty, by).unwrap());
        bytes
    }

    #[test]
    fn numbers_are_shifted_within_their_type() {
        use SignalType as S;
        assert_eq!(shifted(S::INT, (-5_i16).to_le_bytes(), "-10"), (-15_i16).to_le_bytes());
        assert_eq!(shifted(S::INT, i16::MAX.to_le_bytes(), "1"), i16::MAX.to_le_bytes());
        assert_eq!(shifted(S::SINT, (-128_i8).to_le_bytes(), "-1"), (-128_i8).to_le_bytes());
        assert_eq!(shifted(S::UINT, 3_u16.to_le_bytes(), "-10"), 0_u16.to_le_bytes());
        assert_eq!(shifted(S::ULINT, u64::MAX.to_le_bytes(), "1"), u64::MAX.to_le_bytes());
        assert_eq!(shifted(S::REAL, 1.5_f32.to_le_bytes(), "-0.5"), 1_f32.to_le_bytes());
        assert_eq!(shifted(S::LREAL, f64::NAN.to_le_bytes(), "1"), f64::NAN.to_le_bytes());
        assert_eq!(offset(S::BOOL, "1"), None);
        assert_eq!(offset(S::INT, "0.5"), None);
        assert_eq!(offset(S::LREAL, "inf"), None);
    }
}
