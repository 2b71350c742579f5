//! Statements.

use std::sync::Arc;

use wasm_encoder::Instruction;

use super::emitter::Emitter;
use super::fault::Callee;
use crate::ir::elementary::Kind;
use crate::ir::{
    CaseStatement, ElementaryType, Expr, IfBranch, InstanceCall, LocalId, Place, Statement, StatementKind, Storage,
    TypeTable, Value,
};

impl Emitter<'_, '_> {
    pub(super) fn statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.mark_statement(statement.span);
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Assign(target, value) => {
                self.store(target, |emitter| emitter.expression(value));
            }
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
            StatementKind::If(branches, otherwise) => self.if_statement(branches, otherwise),
            StatementKind::Case(inner) => self.case_statement(inner),
            StatementKind::For(inner) => self.for_statement(inner, statement.span),
            StatementKind::While(condition, body) => {
                self.while_statement(condition, body, statement.span);
            }
            StatementKind::Repeat(body, until) => {
                self.repeat_statement(body, until, statement.span);
            }
            StatementKind::Exit => {
                if let Some(labels) = self.loops.last().copied() {
                    self.branch(labels.exit);
                }
            }
            StatementKind::Continue => {
                if let Some(labels) = self.loops.last().copied() {
                    self.branch(labels.next);
                }
            }
            StatementKind::Return => {
                if let Some(end) = self.end {
                    self.branch(end);
                }
            }
        }
    }

    pub(super) fn copy(&mut self, target: &Place, source: &Expr) {
        self.full_address(target);
        self.expression(source);
        let size = self.shared.types.size(target.ty);
        self.emit(Instruction::I32Const(size as i32));
        self.emit(Instruction::MemoryCopy { src_mem: 0, dst_mem: 0 });
    }

    fn initialise(&mut self, place: &Place, image: &Arc<[u8]>) {
        self.full_address(place);
        self.emit(Instruction::I32Const(0));
        self.emit(Instruction::I32Const(image.len() as i32));
        if image.iter().all(|byte| *byte == 0) {
            self.emit(Instruction::MemoryFill(0));
            return;
        }
        self.shared.data.push(image.clone());
        let data_index = self.shared.data.len() as u32 - 1;
        self.emit(Instruction::MemoryInit { mem: 0, data_index });
    }

    fn call_instance(&mut self, call: &InstanceCall) {
        self.full_address(&call.instance);
        self.set(call.pointer);
        // The inputs and outputs are part of the call: a fault in one points at itself.
        for input in &call.inputs {
            self.statement(input);
        }
        self.get(call.pointer);
        let global = matches!(call.instance.storage, Storage::Absolute(_) | Storage::AbsolutePointer(_));
        let callee = if global { Callee::Global } else { Callee::Inner };
        self.call_on(call.pointer, call.dispatch, call.pou, (callee, call.instance.span));
        for output in &call.outputs {
            self.statement(output);
        }
    }

    pub(super) fn call(&mut self, pou: crate::ir::PouId) {
        match self.shared.functions.get(&pou).copied() {
            Some(index) => self.emit(Instruction::Call(index)),
            None => self.emit(Instruction::Unreachable),
        }
    }

    pub(super) fn side_statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.statement(statement);
        }
    }

    /// Branches lie side by side, so that many of them are not nested deep.
    fn if_statement(&mut self, branches: &[IfBranch], otherwise: &[Statement]) {
        let end = self.open_block();
        for branch in branches {
            let next = self.open_block();
            self.expression(&branch.condition);
            self.emit(Instruction::I32Eqz);
            self.branch_if(next);
            self.statements(&branch.body);
            self.branch(end);
            self.close();
        }
        self.statements(otherwise);
        self.close();
    }

    fn case_statement(&mut self, inner: &CaseStatement) {
        let ty = self.held_as(inner.selector.ty);
        self.expression(&inner.selector);
        self.set(inner.register);
        let end = self.open_block();
        for arm in &inner.arms {
            let next = self.open_block();
            self.emit(Instruction::I32Const(0));
            for (low, high) in &arm.labels {
                self.within(inner.register, ty, *low, *high);
                self.emit(Instruction::I32Or);
            }
            self.emit(Instruction::I32Eqz);
            self.branch_if(next);
            self.statements(&arm.body);
            self.branch(end);
            self.close();
        }
        self.statements(&inner.otherwise);
        self.close();
    }

    /// Pushes whether the register lies in `low..=high`.
    fn within(&mut self, register: LocalId, ty: ElementaryType, low: i128, high: i128) {
        let wide = ty.size() == 8;
        let signed = ty.kind() == Kind::Signed;
        self.get(register);
        self.constant(ty, Value::Int(low));
        if low == high {
            self.emit(if wide { Instruction::I64Eq } else { Instruction::I32Eq });
            return;
        }
        self.emit(match (wide, signed) {
            (false, true) => Instruction::I32GeS,
            (false, false) => Instruction::I32GeU,
            (true, true) => Instruction::I64GeS,
            (true, false) => Instruction::I64GeU,
        });
        self.get(register);
        self.constant(ty, Value::Int(high));
        self.emit(match (wide, signed) {
            (false, true) => Instruction::I32LeS,
            (false, false) => Instruction::I32LeU,
            (true, true) => Instruction::I64LeS,
            (true, false) => Instruction::I64LeU,
        });
        self.emit(Instruction::I32And);
    }
}
