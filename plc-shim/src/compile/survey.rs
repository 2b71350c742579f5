//! Loops: what their bodies change, and what stays in registers through all their turns.

use super::effect::Effects;
use super::emitter::{Emitter, value_type};
use super::known::{Entry, Known};
use crate::ir::ElementaryType;

/// Most values that loops keep in registers.
const MAX_PINS: usize = 10;

/// What a loop does, found by compiling it for trial; all unknown inside of another trial.
#[derive(Debug, Default)]
pub(super) struct Survey {
    pub(super) effects: Option<Effects>,
    /// Of one turn, about.
    pub(super) cost: u64,
    /// EXIT or RETURN may end the loop early.
    pub(super) leaves: bool,
    /// Something inside uses the budget.
    pub(super) metered: bool,
}

impl Emitter<'_, '_> {
    /// Compiles `turns` and takes everything back but what was learnt.
    pub(super) fn survey(&mut self, turns: &dyn Fn(&mut Self)) -> Survey {
        if self.trial.is_some() {
            return Survey::default();
        }
        let (code, marks, units) = (self.code.len(), self.marks.len(), self.units.len());
        let (registers, caches) = (self.registers.clone(), self.caches.len());
        let (known, frame) = (self.known.clone(), self.frames.last().cloned());
        let (data, cost, budget) = (self.shared.data.len(), self.cost, self.budget);
        let metered = std::mem::replace(&mut self.metered, false);
        let leaves = std::mem::replace(&mut self.leaves, false);
        self.known = Known::default();
        self.held += 1;
        self.trial = Some(Effects::default());
        turns(self);
        let effects = self.trial.take();
        self.held -= 1;
        let found = Survey { effects, cost: self.cost - cost, leaves: self.leaves, metered: self.metered };
        self.code.truncate(code);
        self.marks.truncate(marks);
        self.units.truncate(units);
        self.shared.data.truncate(data);
        self.caches.truncate(caches);
        (self.registers, self.known) = (registers, known);
        (self.cost, self.budget, self.metered, self.leaves) = (cost, budget, metered, leaves);
        if let (Some(last), Some(frame)) = (self.frames.last_mut(), frame) {
            *last = frame;
        }
        found
    }

    /// Forgets what the loop's turns change and gets what they use most into registers; returns
    /// how many values had one before.
    pub(super) fn enter_loop(&mut self, survey: &Survey) -> usize {
        let before = self.pins.len();
        let Some(effects) = &survey.effects else {
            self.known.forget_all();
            return before;
        };
        for (address, ty) in effects.candidates(&self.roots) {
            if self.pins.len() >= MAX_PINS {
                break;
            }
            self.pin(address, ty);
        }
        let roots = &self.roots;
        self.known.retain(|extent| !effects.changes(extent, roots), |register| !effects.sets(register));
        before
    }

    /// Gets a value into a register for as long as the loop runs.
    pub(super) fn pin(&mut self, address: super::address::Address, ty: ElementaryType) {
        let pinned = |entry: &Entry| entry.address == address && entry.ty == ty;
        if self.known.is_unreachable() || self.registers.are_many() || self.pins.iter().any(pinned) {
            return;
        }
        match self.known.find(address, ty) {
            Some(entry) => self.get(entry.register),
            None => self.load_from(address, ty),
        }
        let register = self.scratch(value_type(ty));
        self.set(register);
        self.pins.push(Entry { address, ty, register });
    }

    /// Behind the loop its registers still hold what is in memory.
    pub(super) fn leave_loop(&mut self, pins: usize) {
        self.known = Known::default();
        for entry in self.pins.split_off(pins) {
            self.caches.push(entry.register);
            self.known.insert(entry);
        }
    }
}
