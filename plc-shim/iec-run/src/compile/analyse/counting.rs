//! FOR loops whose step is a constant and whose body leaves the variable alone: how they count.

use super::address::Extent;
use super::effect::Effects;
use super::interval::interval;
use super::range::{Interval, Ranges, Slot};
use super::scope::Scope;
use onescan_iec::ir::{Binary, ElementaryType, ForStatement};

/// How such a loop counts.
#[derive(Debug)]
pub(crate) struct Count {
    ty: ElementaryType,
    slot: Slot,
    step: i128,
    from: Interval,
    to: Interval,
    wide: bool,
}

impl Count {
    /// How the loop counts, if it does so by itself. `effects` are those of its body.
    pub(crate) fn of(scope: &Scope<'_>, ranges: &Ranges, inner: &ForStatement, effects: &Effects) -> Option<Self> {
        let ty = scope.held_as(inner.variable.ty);
        let slot = scope.slot(&inner.variable)?;
        let changed = match slot {
            Slot::Memory(address) => effects.changes(Extent::new(address, ty.size()), scope.roots()),
            Slot::Register(register) => effects.sets(register),
        };
        let (step, highest) = interval(scope, ranges, &inner.by)?;
        let (from, to) = (interval(scope, ranges, &inner.from)?, interval(scope, ranges, &inner.to)?);
        let (least, greatest) = ty.range()?;
        let wide = if step > 0 { to.1 + step > greatest } else { to.0 + step < least };
        // A sum beyond 64 bits could not be compared with the last value.
        let possible = step == highest && step != 0 && !(wide && ty.size() == 8) && !changed;
        possible.then_some(Self { ty, slot, step, from, to, wide })
    }

    /// The variable's type.
    pub(crate) fn ty(&self) -> ElementaryType {
        self.ty
    }

    /// The variable.
    pub(crate) fn slot(&self) -> Slot {
        self.slot
    }

    /// Never 0.
    pub(crate) fn step(&self) -> i128 {
        self.step
    }

    /// The step behind the last value may leave the type, so that the sum needs 64 bits.
    pub(crate) fn is_wide(&self) -> bool {
        self.wide
    }

    /// Between what the variable lies in the body.
    pub(crate) fn range(&self) -> Interval {
        if self.step > 0 { (self.from.0, self.to.1) } else { (self.to.0, self.from.1) }
    }

    /// True if there is a first turn for sure.
    pub(crate) fn begins(&self) -> bool {
        if self.step > 0 { self.from.1 <= self.to.0 } else { self.from.0 >= self.to.1 }
    }

    /// How many turns, if that is known.
    pub(crate) fn turns(&self) -> Option<u64> {
        debug_assert!(self.step != 0, "a loop that counts by itself has a step");
        let ((from, other), (to, another)) = (self.from, self.to);
        let known = from == other && to == another;
        let turns = if (to - from) * self.step.signum() < 0 { 0 } else { (to - from) / self.step + 1 };
        if known { u64::try_from(turns).ok() } else { None }
    }

    /// What says that another turn follows.
    pub(crate) fn goes_on(&self) -> Binary {
        if self.step > 0 { Binary::LessEqual } else { Binary::GreaterEqual }
    }
}
