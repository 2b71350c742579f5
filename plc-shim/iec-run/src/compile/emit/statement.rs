//! Statements.

use std::sync::Arc;

use wasm_encoder::Instruction;

use super::emitter::{Emitter, Label, LoopLabels};
use super::inline::Call;
use crate::compile::analyse::{Address, Choice, Extent, RunsOn, leaves, may_be_any_nan};
use crate::compile::fault::Callee;
use crate::compile::points::PointKind;
use onescan_iec::ir::{
    Dispatch, Expr, IfBranch, InstanceCall, Place, Statement, StatementKind, Storage, Try, TypeTable,
};
use onescan_iec::syntax::Span;

impl Emitter<'_, '_> {
    pub(crate) fn statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.sweep();
            self.mark_statement(statement.span);
            self.cover(PointKind::Statement, statement.span);
            self.statement(statement);
            self.require_foresight(statement.span);
            self.trace_end(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Assign(target, value) => self.assign(target, value),
            StatementKind::Copy(target, source) => self.copy(target, source),
            StatementKind::Bind(pointer, place) => {
                self.trace_read(place, statement.span);
                self.store(pointer, |emitter| emitter.full_address(place));
            }
            StatementKind::Initialise(place, image) => self.initialise(place, image),
            StatementKind::Evaluate(expr) => {
                self.expression(expr);
                if expr.ty != TypeTable::nothing() {
                    self.emit(Instruction::Drop);
                }
            }
            StatementKind::CallInstance(call) => self.call_instance(call),
            StatementKind::If(branches, otherwise) => self.if_statement(branches, otherwise, statement.span),
            StatementKind::Case(inner) => self.case_statement(inner, statement.span),
            StatementKind::For(inner) => self.for_statement(inner, statement.span),
            StatementKind::While(condition, body) => {
                self.while_statement(condition, body, statement.span);
            }
            StatementKind::Repeat(body, until) => {
                self.repeat_statement(body, until, statement.span);
            }
            StatementKind::Exit => self.leave_to(|labels| labels.exit, Try::EXITED),
            StatementKind::Continue => self.leave_to(|labels| labels.next, Try::CONTINUED),
            StatementKind::Return => self.return_statement(Try::RETURNED),
            StatementKind::Labelled(inner) => self.labelled(inner, statement.span),
            StatementKind::Try(inner) => self.try_statement(inner, statement.span),
            StatementKind::Jump(label) => self.jump(*label, statement.span),
            StatementKind::Pass => {}
        }
    }

    fn assign(&mut self, target: &Place, value: &Expr) {
        let range = self.interval(value);
        self.store(target, |emitter| emitter.settled(value));
        self.assigned(target, range);
    }

    /// Pushes a value; a NaN is one that is the same on every machine.
    pub(crate) fn settled(&mut self, expr: &Expr) {
        self.expression(expr);
        if may_be_any_nan(self.scope(), expr) {
            self.canonical(self.held_as(expr.ty));
        }
    }

    pub(crate) fn copy(&mut self, target: &Place, source: &Expr) {
        self.full_address(target);
        self.expression(source);
        let size = self.size_of(target.ty);
        self.emit(Instruction::I32Const(size as i32));
        self.emit(Instruction::MemoryCopy { src_mem: 0, dst_mem: 0 });
        self.changed(self.extent(target));
    }

    fn initialise(&mut self, place: &Place, image: &Arc<[u8]>) {
        self.full_address(place);
        self.emit(Instruction::I32Const(0));
        self.emit(Instruction::I32Const(image.len() as i32));
        self.changed(self.extent(place));
        if image.iter().all(|byte| *byte == 0) {
            self.emit(Instruction::MemoryFill(0));
            return;
        }
        let data_index = self.shared_mut().add_data(image);
        self.emit(Instruction::MemoryInit { mem: 0, data_index });
    }

    fn call_instance(&mut self, call: &InstanceCall) {
        let address = self.instance_address(call);
        self.point(call.pointer, address);
        // The inputs and outputs are part of the call: a fault in one points at itself.
        self.side_statements(&call.inputs);
        if self.is_of_library(call.pou) {
            // What a library's block does with its own variables nobody reports but its caller.
            self.trace_read(&call.instance, call.instance.span);
        }
        let global = matches!(call.instance.storage, Storage::Absolute(_) | Storage::AbsolutePointer(_));
        let callee = if global { Callee::Global } else { Callee::Inner };
        if let Some(pou) = self.inlinable(call.pou).filter(|_| call.dispatch == Dispatch::Direct) {
            self.inline_instance(call, pou, callee, address);
        } else {
            self.push_address(address);
            let size = self.size_of(call.instance.ty);
            let on = RunsOn::Instance(Extent::new(address, size));
            self.call_on(address, call.dispatch, Call { pou: call.pou, on, callee, span: call.instance.span });
        }
        self.side_statements(&call.outputs);
    }

    /// The instance's address; one that is not known goes to the call's register.
    fn instance_address(&mut self, call: &InstanceCall) -> Address {
        if let Some(address) = self.fixed_address(&call.instance) {
            return address;
        }
        let extent = self.extent(&call.instance);
        self.full_address(&call.instance);
        let register = self.repoint(call.pointer, extent);
        self.set(register);
        Address::of_register(register)
    }

    pub(crate) fn side_statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.statement(statement);
        }
    }

    /// Branches lie side by side, so that many of them are not nested deep.
    fn if_statement(&mut self, branches: &[IfBranch], otherwise: &[Statement], span: Span) {
        if !self.program().has_whole_branches()
            && let Some(choice) = Choice::of(self.scope(), branches, otherwise)
        {
            self.choose(&choice);
            return;
        }
        let end = self.open_block();
        let mut ways = self.open_ways();
        for (outcome, branch) in (0..).zip(branches) {
            let next = self.open_block();
            self.expression(&branch.condition);
            self.emit(Instruction::I32Eqz);
            if leaves(&branch.body) {
                self.mark_likely(branch.condition.span);
            }
            self.branch_if(next);
            let passed = self.part(&branch.condition);
            self.cover(PointKind::Outcome(outcome), span);
            self.in_branch(&branch.body, |emitter| emitter.statements(&branch.body));
            self.branch(end);
            self.end_way(&mut ways, passed);
            self.close();
        }
        self.cover(PointKind::Outcome(branches.len() as u32), span);
        self.statements(otherwise);
        self.close_ways(ways);
        self.close();
    }

    /// Without a loop around, the one around the statements that a fault ends goes on there.
    fn leave_to(&mut self, label: impl FnOnce(LoopLabels) -> Label, outcome: i32) {
        match self.innermost_loop() {
            Some(labels) => {
                self.branch(label(labels));
                self.leave_here();
            }
            None => self.return_statement(outcome),
        }
    }

    fn return_statement(&mut self, outcome: i32) {
        self.set_outcome(outcome);
        if let Some(end) = self.begin_return() {
            self.put_budget_back();
            self.branch(end);
            self.leave_here();
        }
    }
}
