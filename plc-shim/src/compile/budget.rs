//! The budget of instructions of a task, which ends endless loops at the same place in every run.
//!
//! It stands in a global of the module. A loop of which it is not known that it ends soon pays for
//! each of its turns, as many units as the turn has instructions; so does a large unit when it is
//! called. What is small and ends for sure is paid for by what contains it.

use wasm_encoder::{BlockType, ConstExpr, GlobalSection, GlobalType, Instruction, ValType};

use super::emitter::Emitter;
use super::fault::{FaultKind, Mark, MarkKind};
use crate::syntax::Span;

/// Name of the exported global.
pub(crate) const BUDGET_EXPORT: &str = "budget";

/// Its index.
const GLOBAL: u32 = 0;

/// What costs at most this is paid for by what contains it.
pub(super) const SMALL: u64 = 4_000;

/// The module's globals.
pub(super) fn globals() -> GlobalSection {
    let mut section = GlobalSection::new();
    let ty = GlobalType { val_type: ValType::I64, mutable: true, shared: false };
    section.global(ty, &ConstExpr::i64_const(0));
    section
}

fn constant(cost: u64) -> Instruction<'static> {
    Instruction::I64Const(i64::try_from(cost).unwrap_or(i64::MAX))
}

impl Emitter<'_, '_> {
    /// Accounts for what runs elsewhere.
    pub(super) fn charge(&mut self, cost: u64) {
        self.cost = self.cost.saturating_add(cost);
    }

    /// Gets the budget into a register; returns whether it was not in one.
    pub(super) fn open_budget(&mut self) -> bool {
        self.metered = true;
        if self.budget.is_some() {
            return false;
        }
        self.budget = Some(self.scratch(ValType::I64));
        self.take_budget();
        true
    }

    pub(super) fn close_budget(&mut self) {
        self.put_budget_back();
        if let Some(register) = self.budget.take() {
            self.release(register);
        }
    }

    /// Before something that may change the budget itself.
    pub(super) fn put_budget_back(&mut self) {
        if let Some(register) = self.budget {
            self.get(register);
            self.emit(Instruction::GlobalSet(GLOBAL));
        }
    }

    /// And afterwards.
    pub(super) fn take_budget(&mut self) {
        if let Some(register) = self.budget {
            self.emit(Instruction::GlobalGet(GLOBAL));
            self.set(register);
        }
    }

    /// Pays for the code since the cost was `before`.
    pub(super) fn pay_turn(&mut self, before: u64, span: Span) {
        let Some(register) = self.budget else { return };
        let cost = self.cost.saturating_sub(before).max(1);
        self.get(register);
        self.emit(constant(cost));
        self.emit(Instruction::I64Sub);
        self.tee(register);
        self.emit(Instruction::I64Const(0));
        self.emit(Instruction::I64LtS);
        self.fault_if(FaultKind::EndlessLoop, span);
    }

    /// Lets a large unit pay before all its code; returns what is left to pay for its callers.
    pub(super) fn pay_at_entry(&mut self) -> u64 {
        if self.cost <= SMALL {
            return self.cost;
        }
        self.metered = true;
        let entry = [
            Instruction::GlobalGet(GLOBAL),
            constant(self.cost),
            Instruction::I64Sub,
            Instruction::GlobalSet(GLOBAL),
            Instruction::GlobalGet(GLOBAL),
            Instruction::I64Const(0),
            Instruction::I64LtS,
            Instruction::If(BlockType::Empty),
            Instruction::Unreachable,
            Instruction::End,
        ];
        let count = entry.len();
        self.code.splice(0..0, entry);
        for (at, _) in &mut self.marks {
            *at += count;
        }
        // The unit itself is the first that a mark tells of.
        if let Some((_, Mark { span, unit, .. })) = self.marks.first().copied() {
            let mark = Mark { span, unit, kind: MarkKind::Fault(FaultKind::EndlessLoop) };
            self.marks.splice(0..0, [(count - 3, mark), (count - 2, mark)]);
        }
        1
    }
}
