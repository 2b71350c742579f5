//! FOR loops whose step is a constant and whose body leaves the variable alone: it counts in a
//! register, and its range is known inside.

use wasm_encoder::{Instruction, ValType};

use super::address::Extent;
use super::budget::SMALL;
use super::emitter::{Emitter, value_type};
use super::interval::{Interval, Slot};
use super::registers::Register;
use super::repetition::{DONE, TURN};
use super::survey::Survey;
use crate::ir::{Binary, ElementaryType, ForStatement, Value};
use crate::syntax::Span;

/// How such a loop counts.
#[derive(Debug)]
pub(super) struct Count {
    ty: ElementaryType,
    slot: Slot,
    step: i128,
    from: Interval,
    to: Interval,
    /// The step behind the last value may leave the type, so that the sum needs 64 bits.
    wide: bool,
}

impl Count {
    /// Between what the variable lies in the body.
    fn range(&self) -> Interval {
        if self.step > 0 { (self.from.0, self.to.1) } else { (self.to.0, self.from.1) }
    }

    /// True if there is a first turn for sure.
    fn begins(&self) -> bool {
        if self.step > 0 { self.from.1 <= self.to.0 } else { self.from.0 >= self.to.1 }
    }

    /// How many turns, if that is known.
    fn turns(&self) -> Option<u64> {
        let ((from, other), (to, another)) = (self.from, self.to);
        let known = from == other && to == another;
        let turns = if (to - from) * self.step.signum() < 0 { 0 } else { (to - from) / self.step + 1 };
        if known { u64::try_from(turns).ok() } else { None }
    }

    /// What says that another turn follows.
    fn goes_on(&self) -> Binary {
        if self.step > 0 { Binary::LessEqual } else { Binary::GreaterEqual }
    }
}

impl Emitter<'_, '_> {
    /// What the body alone does.
    pub(super) fn survey_body(&mut self, inner: &ForStatement) -> Survey {
        self.survey(&|emitter: &mut Self| {
            let exit = emitter.open_block();
            emitter.open_loop();
            emitter.turn(exit, &inner.body);
            emitter.close();
            emitter.close();
        })
    }

    /// How the loop counts, if it does so by itself.
    pub(super) fn counted(&self, inner: &ForStatement, ty: ElementaryType, survey: &Survey) -> Option<Count> {
        let effects = survey.effects.as_ref()?;
        let slot = self.slot(&inner.variable)?;
        let changed = match slot {
            Slot::Memory(address) => effects.changes(Extent::new(address, ty.size()), &self.roots),
            Slot::Register(register) => effects.sets(register),
        };
        let (step, highest) = self.interval(&inner.by)?;
        let (from, to) = (self.interval(&inner.from)?, self.interval(&inner.to)?);
        let (least, greatest) = ty.range()?;
        let wide = if step > 0 { to.1 + step > greatest } else { to.0 + step < least };
        let possible = step == highest && step != 0 && !(wide && ty.size() == 8) && !changed;
        possible.then_some(Count { ty, slot, step, from, to, wide })
    }

    pub(super) fn counted_loop(&mut self, inner: &ForStatement, count: &Count, mut survey: Survey, span: Span) {
        let held = if count.wide { ValType::I64 } else { value_type(count.ty) };
        let last = self.scratch(held);
        self.expression(&inner.to);
        if count.wide {
            self.extend(count.ty);
        }
        self.set(last);
        self.store(&inner.variable, |emitter| emitter.expression(&inner.from));
        let outer = self.pins.len();
        if let (Slot::Memory(address), Some(effects)) = (count.slot, &mut survey.effects) {
            effects.store(address, count.ty);
            self.pin(address, count.ty);
        }
        let most = count.turns().map(|turns| turns.saturating_mul(survey.cost + 8));
        let small = most.is_some_and(|most| most <= SMALL) && !survey.leaves && !survey.metered;
        self.enter_loop(&survey);
        let opened = !small && self.open_budget();
        let before = self.cost;
        self.counted_turns(inner, count, (last, small), span);
        if let Some(turns) = count.turns().filter(|_| small) {
            self.cost = before.saturating_add(turns.saturating_mul(self.cost - before));
        }
        if opened {
            self.close_budget();
        }
        self.leave_loop(outer);
        self.release(last);
    }

    fn counted_turns(&mut self, inner: &ForStatement, count: &Count, (last, small): (Register, bool), span: Span) {
        let exit = self.open_block();
        let done = self.open_block();
        if !count.begins() {
            self.load(&inner.variable);
            if count.wide {
                self.extend(count.ty);
            }
            self.get(last);
            self.compare(count, span);
            self.emit(Instruction::I32Eqz);
            self.branch_if(done);
        }
        let top = self.open_loop();
        let cost = self.cost;
        self.mark_statement(span);
        self.cover(TURN, span);
        self.facts.push(count.slot, count.range());
        self.turn(exit, &inner.body);
        self.facts.pop();
        self.mark_statement(span);
        if !small {
            self.pay_turn(cost, span);
        }
        self.step(inner, count, last, span);
        self.branch_if(top);
        self.close();
        self.close();
        self.cover(DONE, span);
        self.close();
    }

    fn compare(&mut self, count: &Count, span: Span) {
        let ty = if count.wide { ElementaryType::Lint } else { count.ty };
        self.operation(count.goes_on(), ty, span);
    }

    /// Gives the variable its next value and pushes whether that is another turn's.
    fn step(&mut self, inner: &ForStatement, count: &Count, last: Register, span: Span) {
        if count.wide {
            let next = self.scratch(ValType::I64);
            self.load(&inner.variable);
            self.extend(count.ty);
            self.emit(Instruction::I64Const(count.step as i64));
            self.emit(Instruction::I64Add);
            self.set(next);
            self.store(&inner.variable, |emitter| {
                emitter.get(next);
                emitter.emit(Instruction::I32WrapI64);
                emitter.wrap(count.ty);
            });
            self.get(next);
            self.release(next);
        } else {
            self.store(&inner.variable, |emitter| {
                emitter.load(&inner.variable);
                emitter.constant(count.ty, Value::Int(count.step.abs()));
                let operator = if count.step > 0 { Binary::Add } else { Binary::Subtract };
                emitter.unwrapped(operator, count.ty, span);
            });
            self.load(&inner.variable);
        }
        self.get(last);
        self.compare(count, span);
    }
}
