//! FOR loops that count by themselves: the variable in a register, without a distance to compute.

use wasm_encoder::{Instruction, ValType};

use super::emitter::{Emitter, value_type};
use super::repetition::{DONE, TURN};
use crate::compile::analyse::{Count, Register, SMALL, Slot, Survey};
use onescan_iec::ir::{Binary, ElementaryType, ForStatement, Value};
use onescan_iec::syntax::Span;

/// What a turn costs besides its body, about: the step, the comparison and the branch.
const STEP_COST: u64 = 8;

/// Whether a loop pays for its turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pays {
    /// Each turn, from the budget.
    ItsTurns,
    /// So many turns are paid for by what contains the loop.
    Nothing(u64),
}

impl Pays {
    /// A loop is small if its turns are known and all together cost little, and if none of them does what pays for
    /// itself or leaves the loop while the budget is in a register.
    fn of(count: &Count, survey: &Survey) -> Self {
        match count.turns() {
            Some(turns) if survey.is_plain() && turns.saturating_mul(survey.cost() + STEP_COST) <= SMALL => {
                Self::Nothing(turns)
            }
            _ => Self::ItsTurns,
        }
    }
}

impl Emitter<'_, '_> {
    pub(crate) fn counted_loop(&mut self, inner: &ForStatement, count: &Count, mut survey: Survey, span: Span) {
        let held = if count.is_wide() { ValType::I64 } else { value_type(count.ty()) };
        let last = self.scratch(held);
        self.expression(&inner.to);
        if count.is_wide() {
            self.extend(count.ty());
        }
        self.set(last);
        self.store(&inner.variable, |emitter| emitter.expression(&inner.from));
        let counted = match count.slot() {
            Slot::Memory(address) => Some((address, count.ty())),
            Slot::Register(_) => None,
        };
        if let Some((address, ty)) = counted {
            survey.effects_mut().store(address, ty);
        }
        let pays = Pays::of(count, &survey);
        self.in_turns(survey.effects(), counted, |emitter| match pays {
            Pays::Nothing(turns) => {
                let before = emitter.cost();
                emitter.counted_turns(inner, count, last, pays, span);
                emitter.charge_turns(before, turns);
            }
            Pays::ItsTurns => emitter.with_budget(|emitter| emitter.counted_turns(inner, count, last, pays, span)),
        });
        self.release(last);
    }

    fn counted_turns(&mut self, inner: &ForStatement, count: &Count, last: Register, pays: Pays, span: Span) {
        let exit = self.open_block();
        let done = self.open_block();
        if !count.begins() {
            self.load(&inner.variable);
            if count.is_wide() {
                self.extend(count.ty());
            }
            self.get(last);
            self.compare(count, span);
            self.emit(Instruction::I32Eqz);
            self.branch_if(done);
        }
        let top = self.open_loop();
        let cost = self.cost();
        self.mark_statement(span);
        self.cover(TURN, span);
        self.counting(count, |emitter| emitter.turn(exit, &inner.body));
        self.mark_statement(span);
        if pays == Pays::ItsTurns {
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
        let ty = if count.is_wide() { ElementaryType::Lint } else { count.ty() };
        self.operation(count.goes_on(), ty, span);
    }

    /// Gives the variable its next value and pushes whether that is another turn's.
    fn step(&mut self, inner: &ForStatement, count: &Count, last: Register, span: Span) {
        if count.is_wide() {
            let next = self.scratch(ValType::I64);
            self.load(&inner.variable);
            self.extend(count.ty());
            self.emit(Instruction::I64Const(count.step() as i64));
            self.emit(Instruction::I64Add);
            self.set(next);
            self.store(&inner.variable, |emitter| {
                emitter.get(next);
                emitter.emit(Instruction::I32WrapI64);
                emitter.wrap(count.ty());
            });
            self.get(next);
            self.release(next);
        } else {
            self.store(&inner.variable, |emitter| {
                emitter.load(&inner.variable);
                emitter.constant(count.ty(), Value::Int(count.step().abs()));
                let operator = if count.step() > 0 { Binary::Add } else { Binary::Subtract };
                emitter.unwrapped(operator, count.ty(), span);
            });
            self.load(&inner.variable);
        }
        self.get(last);
        self.compare(count, span);
    }
}
