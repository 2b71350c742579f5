//! Variables that a WHILE loop counts in one direction, up to what its condition says: their range is
//! known inside of the loop and behind it.

use super::effect::Effects;
use super::interval::range_of;
use super::range::{Interval, Ranges, Slot};
use super::refine::assume;
use super::scope::Scope;
use super::step::Step;
use onescan_iec::ir::{Binary, ElementaryType, Expr, ExprKind, Place};

/// A variable that drifts, and where it was before the loop.
#[derive(Debug, Clone, Copy)]
struct Drift {
    step: Step,
    before: Interval,
}

impl Drift {
    /// Where the variable is at all times, if each turn begins with it in `turn`; nothing if it
    /// could leave its type on the way, or goes both ways.
    fn around(&self, turn: Interval) -> Option<Interval> {
        let Step { up, down, ty, .. } = self.step;
        let (least, greatest) = ty.range()?;
        let (low, high) = match (up, down) {
            (0, _) => (self.before.0.min(turn.0 - down), self.before.1),
            (_, 0) => (self.before.0, self.before.1.max(turn.1 + up)),
            _ => return None,
        };
        (least <= low && high <= greatest).then_some((low, high))
    }
}

/// The step of an assignment that adds a constant to its own target: the variable, its type, and by how
/// much.
pub(crate) fn step_of(scope: &Scope<'_>, target: &Place, value: &Expr) -> Option<(Slot, ElementaryType, i128)> {
    let ExprKind::Binary(operator, left, right) = &value.kind else { return None };
    let (slot, ty) = (scope.slot(target)?, scope.types().elementary(target.ty)?);
    let own = |expr: &Expr| matches!(&expr.kind, ExprKind::Load(place) if scope.slot(place) == Some(slot));
    let constant = |expr: &Expr| match &expr.kind {
        ExprKind::Constant(value) => value.as_int(),
        _ => None,
    };
    let by = match operator {
        Binary::Add if own(left) => constant(right),
        Binary::Add if own(right) => constant(left),
        Binary::Subtract if own(left) => constant(right).map(|by| -by),
        _ => None,
    };
    // A sum of another type would be cut on its way into the variable.
    let same = scope.types().elementary(value.ty) == Some(ty) && ty.is_integer();
    by.filter(|_| same).map(|by| (slot, ty, by))
}

/// Between what the variables lie that a loop drives one way, at the beginning of every turn and behind the
/// loop. `ranges` is what is known before it, and `still_known` what of that its turns do not change.
pub(crate) fn driven(
    scope: &Scope<'_>,
    effects: &Effects,
    ranges: &Ranges,
    still_known: &Ranges,
    condition: &Expr,
) -> Driven {
    let mut turn = still_known.clone();
    assume(scope, &mut turn, condition, true);
    let around = |step: &Step| {
        // Any other store could set the variable back.
        let alone = effects.sets_of(step.slot, step.ty, scope.roots()) == Some(step.count);
        let before = range_of(scope, ranges, step.slot, step.ty).or_else(|| step.ty.range())?;
        let drift = Drift { step: *step, before };
        let around = drift.around(turn.find(step.slot, step.ty)?)?;
        alone.then_some((step.slot, step.ty, around))
    };
    Driven(effects.steps().found.iter().filter_map(around).collect())
}

/// Variables that a loop drives one way, and where they are at all times.
#[derive(Debug, Default)]
pub(crate) struct Driven(Vec<(Slot, ElementaryType, Interval)>);

impl Driven {
    /// Holds inside of the loop and behind it.
    pub(crate) fn remember(&self, ranges: &mut Ranges) {
        for (slot, ty, around) in &self.0 {
            ranges.insert(*slot, *ty, *around);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::step::Steps;
    use super::*;
    use crate::compile::analyse::address::Register;

    fn drift(up: i128, down: i128, before: Interval) -> Drift {
        let step = Step { slot: Slot::Register(Register::new(0)), ty: ElementaryType::Int, up, down, count: 1 };
        Drift { step, before }
    }

    #[test]
    fn a_variable_stays_between_where_it_began_and_one_turn_past_the_condition() {
        assert_eq!(drift(0, 1, (-1, 62)).around((0, 32_767)), Some((-1, 62)));
        assert_eq!(drift(3, 0, (0, 0)).around((-32_768, 9)), Some((0, 12)));
        assert_eq!(drift(1, 1, (0, 0)).around((0, 9)), None);
        assert_eq!(drift(0, 1, (0, 9)).around((-32_768, 9)), None, "it would wrap");
    }

    #[test]
    fn steps_of_inner_loops_are_not_bounded() {
        let mut steps = Steps::default();
        steps.open_turn();
        steps.note(Slot::Register(Register::new(0)), ElementaryType::Int, 1);
        steps.open_turn();
        steps.note(Slot::Register(Register::new(0)), ElementaryType::Int, 1);
        steps.close_turn();
        assert_eq!(steps.found.first().map(|step| step.count), Some(1));
    }
}
