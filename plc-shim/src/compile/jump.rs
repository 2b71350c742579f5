//! Labels and jumps (2nd ed. 3.2.2, 4.1.4): forwards a branch out of blocks, backwards another turn of a
//! loop, which pays for its turns as every loop does.

use wasm_encoder::Instruction;

use super::emitter::{Emitter, Label};
use super::known::Known;
use super::registers::Register;
use crate::ir::{LabelId, Labelled};
use crate::syntax::Span;

/// Where the labels of one list of statements are.
#[derive(Debug, Clone)]
pub(super) struct Targets {
    /// Each label in its order, and the block whose end it stands behind.
    labels: Vec<(LabelId, Label)>,
    /// The part that is being compiled; 0 is what stands before the first label.
    at: usize,
    back: Option<Back>,
    /// True if the budget is in a register.
    budget: bool,
}

/// What a jump backwards needs.
#[derive(Debug, Clone, Copy)]
struct Back {
    top: Label,
    /// Holds the part that the next turn begins with.
    register: Register,
    /// Cost of the code before the loop.
    cost: u64,
}

impl Emitter<'_, '_> {
    pub(super) fn labelled(&mut self, inner: &Labelled, span: Span) {
        if inner.register.is_some() {
            self.repeated(None, |emitter| {
                // What a part does may be done any number of times in a turn of a loop around.
                if let Some(trial) = &mut emitter.trial {
                    trial.steps.open_turn();
                }
                emitter.parts(inner, span);
                if let Some(trial) = &mut emitter.trial {
                    trial.steps.close_turn();
                }
            });
        } else {
            self.parts(inner, span);
        }
    }

    fn parts(&mut self, inner: &Labelled, span: Span) {
        let back = inner.register.map(|local| {
            let register = self.register(local);
            self.emit(Instruction::I32Const(0));
            self.set(register);
            Back { top: self.open_loop(), register, cost: self.cost }
        });
        let mut labels: Vec<_> = inner.parts.iter().rev().map(|(id, _)| (*id, self.open_block())).collect();
        // The innermost block is the first label's.
        labels.reverse();
        if let Some(back) = back {
            self.mark_statement(span);
            self.begin_turn(back, &labels);
        }
        let budget = self.budget.is_some();
        if let Some(frame) = self.frames.last_mut() {
            frame.jumps.push(Targets { labels, at: 0, back, budget });
        }
        self.statements(&inner.first);
        for (at, (_, part)) in (1..).zip(&inner.parts) {
            self.close();
            // Execution may come here from anywhere.
            self.known = Known::default();
            if let Some(targets) = self.frames.last_mut().and_then(|frame| frame.jumps.last_mut()) {
                targets.at = at;
            }
            self.statements(part);
        }
        if let Some(frame) = self.frames.last_mut() {
            frame.jumps.pop();
        }
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

    pub(super) fn jump(&mut self, label: LabelId, span: Span) {
        let jumps = self.frames.last().map_or(&[][..], |frame| &frame.jumps);
        let found = jumps.iter().rev().find_map(|targets| {
            let at = targets.labels.iter().position(|(id, _)| *id == label)?;
            let block = targets.labels.get(at).filter(|_| at >= targets.at).map(|(_, block)| *block);
            Some((at + 1, block, targets.back, targets.budget))
        });
        // The checker makes no jumps to labels that are not around.
        let Some((part, block, back, budget)) = found else { return };
        match (block, back) {
            (Some(block), _) => {
                if !budget {
                    self.put_budget_back();
                }
                self.branch(block);
            }
            (None, Some(back)) => {
                self.pay_turn(back.cost, span);
                self.emit(Instruction::I32Const(part as i32));
                self.set(back.register);
                self.branch(back.top);
            }
            (None, None) => return,
        }
        self.known.leave();
        self.leaves = true;
    }
}
