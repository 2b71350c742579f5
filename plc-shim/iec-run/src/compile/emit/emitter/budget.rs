//! The budget of instructions of a task, which ends endless loops at the same place in every run.
//!
//! It stands in a global of the module. A loop of which it is not known that it ends soon pays for
//! each of its turns, as many units as the turn has instructions; so does a large unit when it is
//! called. What is small and ends for sure is paid for by what contains it.

use wasm_encoder::{BlockType, ConstExpr, GlobalSection, GlobalType, Instruction, ValType};

use super::{Emitter, Shared};
use crate::compile::analyse::SMALL;
use crate::compile::fault::FaultKind;
use onescan_iec::syntax::Span;

/// Index of the global.
const GLOBAL: u32 = 0;

/// The first of the globals that hand registers on, see [`handed`](super::handed).
pub(super) const FIRST_HANDED: u32 = GLOBAL + 1;

/// The module's globals.
pub(crate) fn globals(shared: &Shared<'_>) -> GlobalSection {
    let mut section = GlobalSection::new();
    let ty = GlobalType { val_type: ValType::I64, mutable: true, shared: false };
    section.global(ty, &ConstExpr::i64_const(0));
    for ty in shared.handed.types() {
        let zero = match ty {
            ValType::I64 => ConstExpr::i64_const(0),
            ValType::F32 => ConstExpr::f32_const(0.0.into()),
            ValType::F64 => ConstExpr::f64_const(0.0.into()),
            _ => ConstExpr::i32_const(0),
        };
        section.global(GlobalType { val_type: *ty, mutable: true, shared: false }, &zero);
    }
    section
}

/// No task has as much as the greatest number, so what costs more ends it all the same.
fn constant(cost: u64) -> Instruction<'static> {
    Instruction::I64Const(i64::try_from(cost).unwrap_or(i64::MAX))
}

impl Emitter<'_, '_> {
    /// What the code so far costs at most.
    pub(crate) fn cost(&self) -> u64 {
        self.code.cost()
    }

    /// Accounts for what runs elsewhere.
    pub(crate) fn charge(&mut self, cost: u64) {
        self.code.set_cost(self.code.cost().saturating_add(cost));
    }

    /// Accounts for code since the cost was `before` that runs so many times.
    pub(crate) fn charge_turns(&mut self, before: u64, turns: u64) {
        let once = self.code.cost().saturating_sub(before);
        self.code.set_cost(before.saturating_add(turns.saturating_mul(once)));
    }

    /// Emits what the plain program does not have. A budget that paid for it would end a loop sooner than there.
    pub(crate) fn free_of_charge(&mut self, emit: impl FnOnce(&mut Self)) {
        let cost = self.code.cost();
        emit(self);
        self.code.set_cost(cost);
    }

    /// The function calls what takes from the budget itself.
    pub(crate) fn meter(&mut self) {
        self.metered = true;
    }

    /// What `emit` makes pays for its turns: it has the budget in a register.
    pub(crate) fn with_budget(&mut self, emit: impl FnOnce(&mut Self)) {
        self.metered = true;
        if self.budget.is_some() {
            emit(self);
            return;
        }
        let register = self.scratch(ValType::I64);
        self.budget = Some(register);
        self.take_budget();
        emit(self);
        debug_assert_eq!(self.budget, Some(register), "the budget stays in its register while a loop runs");
        self.put_budget_back();
        self.budget = None;
        self.release(register);
    }

    /// Before something that may change the budget itself.
    pub(crate) fn put_budget_back(&mut self) {
        if let Some(register) = self.budget {
            self.get(register);
            self.emit(Instruction::GlobalSet(GLOBAL));
        }
    }

    /// And afterwards.
    pub(crate) fn take_budget(&mut self) {
        if let Some(register) = self.budget {
            self.emit(Instruction::GlobalGet(GLOBAL));
            self.set(register);
        }
    }

    /// Pays for the code since the cost was `before`.
    pub(crate) fn pay_turn(&mut self, before: u64, span: Span) {
        let Some(register) = self.budget else { return };
        // A turn costs at least 1, or a loop without a body would never use the budget up.
        let cost = self.code.cost().saturating_sub(before).max(1);
        self.get(register);
        self.emit(constant(cost));
        self.emit(Instruction::I64Sub);
        self.tee(register);
        if self.program().costs().has_tries() {
            // A fault may end the loop and not the task, which then has what is left here.
            self.emit(Instruction::GlobalSet(GLOBAL));
            self.get(register);
        }
        self.emit(Instruction::I64Const(0));
        self.emit(Instruction::I64LtS);
        self.fault_if(FaultKind::EndlessLoop, span);
    }

    /// Lets a large unit pay before all its code, and one that may come back to itself; returns what is left to pay for
    /// its callers.
    pub(super) fn pay_at_entry(&mut self, may_recur: bool) -> u64 {
        let cost = self.code.cost();
        if cost <= SMALL && !may_recur {
            return cost;
        }
        self.metered = true;
        let entry = vec![
            Instruction::GlobalGet(GLOBAL),
            constant(cost),
            Instruction::I64Sub,
            Instruction::GlobalSet(GLOBAL),
            Instruction::GlobalGet(GLOBAL),
            Instruction::I64Const(0),
            Instruction::I64LtS,
            Instruction::If(BlockType::Empty),
            Instruction::Unreachable,
            Instruction::End,
        ];
        // Where a machine traps without a branch, it does so at the branch.
        let trapping = [entry.len() - 3, entry.len() - 2];
        self.code.begin_with(entry, trapping, FaultKind::EndlessLoop);
        1
    }
}
