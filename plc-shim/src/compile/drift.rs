//! Variables that a WHILE loop counts in one direction, up to what its condition says: their range is
//! known inside of the loop and behind it.

use super::emitter::Emitter;
use super::interval::{Interval, Slot};
use super::survey::Survey;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Place};

/// Constants that a loop's body adds to a variable, each at most once a turn.
#[derive(Debug, Clone, Copy)]
struct Step {
    slot: Slot,
    ty: ElementaryType,
    up: i128,
    down: i128,
    count: u32,
}

/// The steps of a loop's body.
#[derive(Debug, Default)]
pub(super) struct Steps {
    found: Vec<Step>,
    /// How many loops are open: in an inner one, a step may be taken any number of times.
    depth: u32,
}

/// Most variables that are looked at.
const MAX_STEPS: usize = 32;

impl Steps {
    pub(super) fn open_turn(&mut self) {
        self.depth += 1;
    }

    pub(super) fn close_turn(&mut self) {
        self.depth -= 1;
    }

    fn note(&mut self, slot: Slot, ty: ElementaryType, by: i128) {
        if self.depth != 1 {
            return;
        }
        let known = self.found.iter().position(|step| step.slot == slot && step.ty == ty);
        let index = known.unwrap_or(self.found.len());
        if known.is_none() {
            if index >= MAX_STEPS {
                return;
            }
            self.found.push(Step { slot, ty, up: 0, down: 0, count: 0 });
        }
        if let Some(step) = self.found.get_mut(index) {
            step.up += by.max(0);
            step.down += (-by).max(0);
            step.count += 1;
        }
    }
}

/// A variable that drifts, and where it was before the loop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drift {
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

impl Emitter<'_, '_> {
    /// In a trial: the assignment may be a step.
    pub(super) fn note_drift(&mut self, target: &Place, value: &Expr) {
        if self.trial.is_none() {
            return;
        }
        let ExprKind::Binary(operator, left, right) = &value.kind else { return };
        let (Some(slot), Some(ty)) = (self.slot(target), self.shared.types.elementary(target.ty)) else { return };
        let own = |expr: &Expr| matches!(&expr.kind, ExprKind::Load(place) if self.slot(place) == Some(slot));
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
        let same = self.shared.types.elementary(value.ty) == Some(ty) && ty.is_integer();
        if let (true, Some(by), Some(trial)) = (same, by, &mut self.trial) {
            trial.steps.note(slot, ty, by);
        }
    }

    /// What the variable has been given lies in `range`.
    pub(super) fn remember_range(&mut self, target: &Place, range: Option<Interval>) {
        let (Some(slot), Some(ty)) = (self.slot(target), self.shared.types.elementary(target.ty)) else { return };
        let useful = range.filter(|_| ty.is_integer() && range != ty.range() && !self.known.is_unreachable());
        if let Some(range) = useful {
            self.known.ranges.insert(slot, ty, range);
        }
    }

    /// The variables that the loop drives one way, before it is entered.
    pub(super) fn drifts(&self, survey: &Survey) -> Vec<Drift> {
        let Some(effects) = &survey.effects else { return Vec::new() };
        let alone = |step: &&Step| effects.sets_of(step.slot, step.ty, &self.roots) == Some(step.count);
        let before = |step: &Step| {
            let range = self.range_of(step.slot, step.ty).or_else(|| step.ty.range())?;
            Some(Drift { step: *step, before: range })
        };
        effects.steps.found.iter().filter(alone).filter_map(before).collect()
    }

    /// Where they are at the beginning of every turn, before the condition is asked.
    pub(super) fn expect_drifts(&mut self, drifts: &[Drift], condition: &Expr) -> Vec<(Drift, Interval)> {
        let outside = self.known.clone();
        self.assume(condition, true);
        let mut found = Vec::new();
        for drift in drifts {
            let turn = self.known.ranges.find(drift.step.slot, drift.step.ty);
            if let Some(around) = turn.and_then(|turn| drift.around(turn)) {
                found.push((*drift, around));
            }
        }
        self.known = outside;
        self.remember_drifts(&found);
        found
    }

    /// Inside of the loop and behind it.
    pub(super) fn remember_drifts(&mut self, drifts: &[(Drift, Interval)]) {
        for (drift, around) in drifts {
            self.known.ranges.insert(drift.step.slot, drift.step.ty, *around);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::registers::Register;

    fn drift(up: i128, down: i128, before: Interval) -> Drift {
        let step = Step { slot: Slot::Register(Register(0)), ty: ElementaryType::Int, up, down, count: 1 };
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
        steps.note(Slot::Register(Register(0)), ElementaryType::Int, 1);
        steps.open_turn();
        steps.note(Slot::Register(Register(0)), ElementaryType::Int, 1);
        steps.close_turn();
        assert_eq!(steps.found.first().map(|step| step.count), Some(1));
    }
}
