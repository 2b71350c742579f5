//! Statements.

use std::sync::Arc;

use wasm_encoder::Instruction;

use super::address::{Address, Extent};
use super::calls::leaves;
use super::emitter::Emitter;
use super::fault::Callee;
use super::points::PointKind;
use super::reach::RunsOn;
use crate::ir::{
    Dispatch, Expr, ExprKind, IfBranch, InstanceCall, Intrinsic, Place, Statement, StatementKind, Storage, TypeTable,
};
use crate::syntax::Span;

impl Emitter<'_, '_> {
    pub(super) fn statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.sweep();
            self.mark_statement(statement.span);
            self.cover(PointKind::Statement, statement.span);
            self.statement(statement);
            self.trace_end(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Assign(target, value) => self.assign(target, value),
            StatementKind::Copy(target, source) => self.copy(target, source),
            StatementKind::Bind(pointer, place) => {
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
            StatementKind::Exit => self.leave_to(|labels| labels.exit),
            StatementKind::Continue => self.leave_to(|labels| labels.next),
            StatementKind::Return => self.return_statement(),
            StatementKind::Labelled(inner) => self.labelled(inner, statement.span),
            StatementKind::Jump(label) => self.jump(*label, statement.span),
            StatementKind::Pass => {}
        }
    }

    fn assign(&mut self, target: &Place, value: &Expr) {
        let range = self.interval(value);
        self.note_drift(target, value);
        self.store(target, |emitter| emitter.settled(value));
        self.remember_range(target, range);
    }

    /// True if a real value is computed: if it is NaN, the machine has chosen which. What is
    /// fetched, chosen or has its sign changed keeps its bits; variables never hold such a NaN.
    pub(super) fn may_be_any_nan(&self, expr: &Expr) -> bool {
        let real = |expr: &Expr| self.held_as(expr.ty).is_real();
        real(expr)
            && match &expr.kind {
                ExprKind::Constant(_)
                | ExprKind::Load(_)
                | ExprKind::Call(_)
                | ExprKind::Unary(..)
                | ExprKind::Intrinsic(Intrinsic::Reinterpret | Intrinsic::Abs, _) => false,
                ExprKind::Intrinsic(Intrinsic::Select | Intrinsic::Multiplex, operands) => {
                    operands.iter().any(|operand| self.may_be_any_nan(operand))
                }
                ExprKind::Convert(_, operand) => real(operand),
                _ => true,
            }
    }

    /// Pushes a value; a NaN is one that is the same on every machine.
    pub(super) fn settled(&mut self, expr: &Expr) {
        self.expression(expr);
        if self.may_be_any_nan(expr) {
            self.canonical(self.held_as(expr.ty));
        }
    }

    pub(super) fn copy(&mut self, target: &Place, source: &Expr) {
        self.full_address(target);
        self.expression(source);
        let size = self.shared.types.size(target.ty);
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
        self.shared.data.push(image.clone());
        let data_index = self.shared.data.len() as u32 - 1;
        self.emit(Instruction::MemoryInit { mem: 0, data_index });
    }

    fn call_instance(&mut self, call: &InstanceCall) {
        let address = self.instance_address(call);
        if let Some(frame) = self.frames.last_mut() {
            frame.pointers.insert(call.pointer, address);
        }
        // The inputs and outputs are part of the call: a fault in one points at itself.
        self.side_statements(&call.inputs);
        let global = matches!(call.instance.storage, Storage::Absolute(_) | Storage::AbsolutePointer(_));
        let callee = if global { Callee::Global } else { Callee::Inner };
        if let Some(pou) = self.inlinable(call.pou).filter(|_| call.dispatch == Dispatch::Direct) {
            self.inline_instance(call, pou, callee, address);
        } else {
            self.push_address(address);
            let size = self.shared.types.size(call.instance.ty);
            let on = (address, RunsOn::Instance(Extent::new(address, size)));
            self.call_on(on, call.dispatch, call.pou, (callee, call.instance.span));
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
        let register = self.register(call.pointer);
        self.set(register);
        self.known.forget_base(register);
        self.roots.lead(register, extent);
        Address::of_register(register)
    }

    /// Pushes an address as a number.
    pub(super) fn push_address(&mut self, address: Address) {
        match address.base {
            super::address::Base::Memory => self.emit(Instruction::I32Const(address.offset as i32)),
            super::address::Base::Register(register) => {
                self.get(register);
                if address.offset > 0 {
                    self.emit(Instruction::I32Const(address.offset as i32));
                    self.emit(Instruction::I32Add);
                }
            }
        }
    }

    pub(super) fn side_statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.statement(statement);
        }
    }

    /// Branches lie side by side, so that many of them are not nested deep.
    fn if_statement(&mut self, branches: &[IfBranch], otherwise: &[Statement], span: Span) {
        if !self.is_covered() && self.choice(branches, otherwise) {
            return;
        }
        let end = self.open_block();
        self.held += 1;
        let mut after = None;
        for (outcome, branch) in (0..).zip(branches) {
            let next = self.open_block();
            self.expression(&branch.condition);
            self.emit(Instruction::I32Eqz);
            if leaves(&branch.body) {
                self.mark_likely(branch.condition.span);
            }
            self.branch_if(next);
            let before = self.known.clone();
            self.assume(&branch.condition, false);
            let passed = std::mem::replace(&mut self.known, before);
            self.assume(&branch.condition, true);
            self.cover(PointKind::Outcome(outcome), span);
            self.leaving += u32::from(leaves(&branch.body));
            self.statements(&branch.body);
            self.leaving -= u32::from(leaves(&branch.body));
            self.branch(end);
            self.join(&mut after, passed);
            self.close();
        }
        self.cover(PointKind::Outcome(branches.len() as u32), span);
        self.statements(otherwise);
        self.meet(after);
        self.held -= 1;
        self.close();
    }

    fn leave_to(&mut self, label: impl FnOnce(super::frame::LoopLabels) -> super::emitter::Label) {
        if let Some(labels) = self.frames.last().and_then(|frame| frame.loops.last()).copied() {
            self.branch(label(labels));
            self.known.leave();
            self.leaves = true;
        }
    }

    fn return_statement(&mut self) {
        let Some(frame) = self.frames.last_mut() else { return };
        let Some(end) = frame.end else { return };
        match &mut frame.returned {
            Some(returned) => returned.meet(&self.known),
            None => frame.returned = Some(self.known.clone()),
        }
        self.put_budget_back();
        self.branch(end);
        self.known.leave();
        self.leaves = true;
    }

    /// One of several ways ends here; the next begins with what was known `before` it.
    pub(super) fn join(&mut self, after: &mut Option<super::known::Known>, before: super::known::Known) {
        let here = std::mem::replace(&mut self.known, before);
        match after {
            Some(after) => after.meet(&here),
            None => *after = Some(here),
        }
    }

    /// The ways that ended before come together with this one.
    pub(super) fn meet(&mut self, after: Option<super::known::Known>) {
        if let Some(after) = after {
            self.known.meet(&after);
        }
    }
}
