//! FOR, WHILE and REPEAT (2nd ed. 3.3.2.4).

use wasm_encoder::{Instruction, ValType};

use super::emitter::{Emitter, Label, LoopLabels};
use crate::compile::analyse::{Count, Driven, Register, Survey};
use crate::compile::fault::FaultKind;
use crate::compile::points::PointKind;
use onescan_iec::ir::elementary::Kind;
use onescan_iec::ir::{Binary, ElementaryType, Expr, ForStatement, Statement};
use onescan_iec::syntax::Span;

/// A loop's body runs.
pub(crate) const TURN: PointKind = PointKind::Outcome(0);
/// A loop ends by its own condition.
pub(crate) const DONE: PointKind = PointKind::Outcome(1);

impl Emitter<'_, '_> {
    pub(crate) fn while_statement(&mut self, condition: &Expr, body: &[Statement], span: Span) {
        let survey = Survey::of_while(self.program(), self.scope(), condition, body);
        self.repeated(&survey, Some(condition), |emitter| {
            let exit = emitter.open_block();
            let done = emitter.open_block();
            let top = emitter.open_loop();
            let cost = emitter.cost();
            emitter.mark_statement(span);
            emitter.expression(condition);
            emitter.emit(Instruction::I32Eqz);
            emitter.branch_if(done);
            emitter.assume(condition);
            emitter.cover(TURN, span);
            emitter.turn(exit, body);
            emitter.pay_turn(cost, span);
            emitter.branch(top);
            emitter.close();
            emitter.close();
            emitter.cover(DONE, span);
            emitter.close();
        });
    }

    pub(crate) fn repeat_statement(&mut self, body: &[Statement], until: &Expr, span: Span) {
        let survey = Survey::of_repeat(self.program(), self.scope(), body, until);
        self.repeated(&survey, None, |emitter| {
            let exit = emitter.open_block();
            let done = emitter.open_block();
            let top = emitter.open_loop();
            let cost = emitter.cost();
            emitter.mark_statement(span);
            emitter.turn(exit, body);
            emitter.pay_turn(cost, span);
            emitter.mark_statement(until.span);
            emitter.expression(until);
            emitter.branch_if(done);
            emitter.cover(TURN, span);
            emitter.branch(top);
            emitter.close();
            emitter.close();
            emitter.cover(DONE, span);
            emitter.close();
        });
    }

    /// A loop that pays for its turns; each begins with the condition, if there is one.
    pub(crate) fn repeated(&mut self, survey: &Survey, condition: Option<&Expr>, turns: impl FnOnce(&mut Self)) {
        let before = self.ranges().clone();
        let mut found = Driven::default();
        self.in_turns(survey.effects(), None, |emitter| {
            if let Some(condition) = condition {
                found = emitter.driven(survey.effects(), &before, condition);
                emitter.remember(&found);
            }
            emitter.with_budget(turns);
        });
        self.remember(&found);
    }

    /// The body, with CONTINUE leading behind it.
    pub(crate) fn turn(&mut self, exit: Label, body: &[Statement]) {
        let next = self.open_block();
        self.in_loop(LoopLabels { exit, next }, |emitter| emitter.statements(body));
        self.close();
        // CONTINUE may have come here from anywhere.
        self.forget();
    }

    /// The last value and the step are computed once, before the variable is set.
    pub(crate) fn for_statement(&mut self, inner: &ForStatement, span: Span) {
        let ty = self.held_as(inner.variable.ty);
        let survey = Survey::of_body(self.program(), self.scope(), &inner.body);
        if let Some(count) = Count::of(self.scope(), self.ranges(), inner, survey.effects()) {
            self.counted_loop(inner, &count, survey, span);
            return;
        }
        let survey = Survey::of_for(self.program(), self.scope(), inner);
        let (last, step) = (self.register(inner.last), self.register(inner.step));
        self.widened(&inner.to, ty);
        self.set(last);
        self.widened(&inner.by, self.held_as(inner.by.ty));
        self.set(step);
        self.store(&inner.variable, |emitter| emitter.expression(&inner.from));
        self.get(step);
        self.emit(Instruction::I64Eqz);
        self.fault_if(FaultKind::ZeroStep, inner.by.span);
        self.in_turns(survey.effects(), None, |emitter| {
            emitter.with_budget(|emitter| emitter.turns_of_any(inner, ty, span));
        });
    }

    /// Whether another turn follows is decided from the distance to the last value, so that a
    /// variable at its type's limit ends the loop and does not wrap into another round.
    fn turns_of_any(&mut self, inner: &ForStatement, ty: ElementaryType, span: Span) {
        let exit = self.open_block();
        let done = self.open_block();
        let top = self.open_loop();
        let cost = self.cost();
        self.mark_statement(span);
        self.beyond(inner, ty);
        self.branch_if(done);
        self.cover(TURN, span);
        self.turn(exit, &inner.body);
        self.mark_statement(span);
        self.pay_turn(cost, span);
        let finished = self.scratch(ValType::I32);
        self.last_turn(inner, ty);
        self.set(finished);
        self.store(&inner.variable, |emitter| emitter.stepped(inner, ty));
        self.get(finished);
        self.emit(Instruction::I32Eqz);
        self.branch_if(top);
        self.release(finished);
        self.close();
        self.close();
        self.cover(DONE, span);
        self.close();
    }

    /// Pushes an integer of type `ty` as 64 bits.
    fn widened(&mut self, expr: &Expr, ty: ElementaryType) {
        self.expression(expr);
        self.extend(ty);
    }

    pub(crate) fn extend(&mut self, ty: ElementaryType) {
        if ty.size() < 8 {
            self.emit(match ty.kind() {
                Kind::Signed => Instruction::I64ExtendI32S,
                _ => Instruction::I64ExtendI32U,
            });
        }
    }

    fn widened_variable(&mut self, inner: &ForStatement, ty: ElementaryType) {
        self.load(&inner.variable);
        self.extend(ty);
    }

    /// Pushes whether the step is negative.
    fn downwards(&mut self, inner: &ForStatement) {
        if self.held_as(inner.by.ty).kind() == Kind::Signed {
            self.get(self.register(inner.step));
            self.emit(Instruction::I64Const(0));
            self.emit(Instruction::I64LtS);
        } else {
            self.emit(Instruction::I32Const(0));
        }
    }

    /// Pushes whether the variable lies beyond the last value.
    fn beyond(&mut self, inner: &ForStatement, ty: ElementaryType) {
        let signed = ty.kind() == Kind::Signed;
        let variable = self.scratch(ValType::I64);
        let last = self.register(inner.last);
        self.widened_variable(inner, ty);
        self.tee(variable);
        self.get(last);
        self.emit(if signed { Instruction::I64LtS } else { Instruction::I64LtU });
        self.get(variable);
        self.get(last);
        self.emit(if signed { Instruction::I64GtS } else { Instruction::I64GtU });
        self.downwards(inner);
        self.emit(Instruction::Select);
        self.release(variable);
    }

    /// Pushes whether the distance to the last value is less than the step.
    fn last_turn(&mut self, inner: &ForStatement, ty: ElementaryType) {
        let variable = self.scratch(ValType::I64);
        let (last, step) = (self.register(inner.last), self.register(inner.step));
        self.widened_variable(inner, ty);
        self.set(variable);
        self.distance_is_short(last, variable, step, false);
        self.distance_is_short(variable, last, step, true);
        // `select` takes the first if the condition holds.
        let (up, down) = (self.scratch(ValType::I32), self.scratch(ValType::I32));
        self.set(down);
        self.set(up);
        self.get(down);
        self.get(up);
        self.downwards(inner);
        self.emit(Instruction::Select);
        // A body that changed the variable past the last value ends the loop too.
        self.beyond(inner, ty);
        self.emit(Instruction::I32Or);
        for register in [variable, up, down] {
            self.release(register);
        }
    }

    /// Pushes `high - low < |step|`, unsigned: the distance of two 64 bit numbers fits.
    fn distance_is_short(&mut self, high: Register, low: Register, step: Register, negative: bool) {
        self.get(high);
        self.get(low);
        self.emit(Instruction::I64Sub);
        if negative {
            self.emit(Instruction::I64Const(0));
        }
        self.get(step);
        if negative {
            self.emit(Instruction::I64Sub);
        }
        self.emit(Instruction::I64LtU);
    }

    /// Pushes the variable's next value.
    fn stepped(&mut self, inner: &ForStatement, ty: ElementaryType) {
        self.load(&inner.variable);
        self.get(self.register(inner.step));
        if ty.size() < 8 {
            self.emit(Instruction::I32WrapI64);
        }
        self.operation(Binary::Add, ty, inner.by.span);
    }
}
