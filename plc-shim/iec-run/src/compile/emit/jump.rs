//! Labels and jumps (2nd ed. 3.2.2, 4.1.4): forwards a branch out of blocks, backwards another turn of a
//! loop, which pays for its turns as every loop does.

use wasm_encoder::Instruction;

use super::emitter::{Back, Emitter, JumpTo, Label};
use crate::compile::analyse::Survey;
use onescan_iec::ir::{LabelId, Labelled};
use onescan_iec::syntax::Span;

impl Emitter<'_, '_> {
    pub(crate) fn labelled(&mut self, inner: &Labelled, span: Span) {
        if inner.register.is_some() {
            let survey = Survey::of_labelled(self.program(), self.scope(), inner);
            self.repeated(&survey, None, |emitter| emitter.parts(inner, span));
        } else {
            self.parts(inner, span);
        }
    }

    fn parts(&mut self, inner: &Labelled, span: Span) {
        let back = inner.register.map(|local| {
            let register = self.register(local);
            self.emit(Instruction::I32Const(0));
            self.set(register);
            Back { top: self.open_loop(), register, cost: self.cost() }
        });
        let mut labels: Vec<_> = inner.parts.iter().rev().map(|(id, _)| (*id, self.open_block())).collect();
        // The innermost block is the first label's.
        labels.reverse();
        if let Some(back) = back {
            self.mark_statement(span);
            self.begin_turn(back, &labels);
        }
        self.among_labels(labels, back, |emitter| {
            emitter.statements(&inner.first);
            for (at, (_, part)) in (1..).zip(&inner.parts) {
                emitter.close();
                // A jump may have come here from anywhere.
                emitter.forget();
                emitter.begin_part(at);
                emitter.statements(part);
            }
        });
        if back.is_some() {
            self.close();
        }
    }

    /// Goes to the part that the turn before has chosen.
    fn begin_turn(&mut self, back: Back, labels: &[(LabelId, Label)]) {
        let first = self.open_block();
        let labels: Vec<_> = std::iter::once(first).chain(labels.iter().map(|(_, label)| *label)).collect();
        self.get(back.register);
        self.branch_table(&labels, first);
        self.close();
    }

    pub(crate) fn jump(&mut self, label: LabelId, span: Span) {
        match self.way_to(label) {
            Some(JumpTo::Behind { block, has_budget }) => {
                // The code there does not look into the register.
                if !has_budget {
                    self.put_budget_back();
                }
                self.branch(block);
            }
            Some(JumpTo::Back { back, part }) => {
                self.pay_turn(back.cost, span);
                self.emit(Instruction::I32Const(part as i32));
                self.set(back.register);
                self.branch(back.top);
            }
            None => self.impossible(span),
        }
        self.leave_here();
    }
}
