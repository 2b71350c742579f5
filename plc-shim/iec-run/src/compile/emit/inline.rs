//! Calls, and small units put in place of a call.

use wasm_encoder::Instruction;

use super::emitter::Emitter;
use crate::compile::analyse::Address;
use crate::compile::analyse::RunsOn;
use crate::compile::fault::Callee;
use crate::compile::points::PointKind;
use onescan_iec::ir::{Argument, Expr, ExprKind, FunctionCall, InstanceCall, LocalId, Place, Pou, PouId};
use onescan_iec::syntax::Span;

/// A call of a unit, and what it is to a reader of the source.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Call {
    pub(crate) pou: PouId,
    /// The instance that it may change.
    pub(crate) on: RunsOn,
    pub(crate) callee: Callee,
    pub(crate) span: Span,
}

impl Emitter<'_, '_> {
    /// Calls a function of the module.
    pub(crate) fn call(&mut self, Call { pou, on, callee, span }: Call) {
        let metered = self.program().costs().is_metered(pou);
        if metered {
            self.put_budget_back();
            self.meter();
        }
        self.mark_call(callee, span);
        match self.shared().function(pou) {
            Some(index) => self.emit(Instruction::Call(index)),
            None => self.impossible(span),
        }
        self.charge(self.program().costs().of_call(pou));
        if metered {
            self.take_budget();
        }
        match on {
            RunsOn::Nothing if self.program().costs().stays_inside(pou) => {}
            RunsOn::Instance(extent) if self.program().costs().stays_inside(pou) => self.changed(Some(extent)),
            _ => self.changed(None),
        }
    }

    /// The unit's statements and its result.
    pub(crate) fn body(&mut self, pou: &Pou) {
        self.mark_statement(pou.span);
        self.cover(PointKind::Unit, pou.span);
        self.enter_guarded(pou);
        let end = self.open_block();
        self.returns_to(end);
        self.statements(&pou.body);
        self.close();
        self.meet_returns();
        self.leave_guarded(pou);
        if let Some(result) = &pou.result {
            let kind = ExprKind::Load(result.clone());
            self.expression(&Expr { kind, ty: result.ty, span: result.span });
        }
    }

    pub(crate) fn inline_instance(&mut self, call: &InstanceCall, pou: &Pou, callee: Callee, instance: Address) {
        self.enter(call.pou, pou, 0, Some((callee, call.instance.span)));
        self.runs_on(instance);
        self.body(pou);
        self.leave();
    }

    pub(crate) fn call_function(&mut self, call: &FunctionCall, span: Span) {
        match &call.receiver {
            Some(receiver) => {
                let instance = self.receiver(receiver);
                self.side_statements(&call.before);
                self.push_address(instance);
                self.push_arguments(&call.arguments);
                let method = Call { pou: call.pou, on: RunsOn::Anywhere, callee: Callee::Function, span };
                self.call_on(instance, receiver.dispatch, method);
            }
            None => self.call_plain_function(call, span),
        }
        if let Some(place) = &call.result {
            self.keep_result(place);
        }
        self.side_statements(&call.outputs);
    }

    fn call_plain_function(&mut self, call: &FunctionCall, span: Span) {
        self.side_statements(&call.before);
        if let Some(pou) = self.inlinable(call.pou) {
            self.inline_function(call, pou, span);
        } else {
            self.push_arguments(&call.arguments);
            self.call(Call { pou: call.pou, on: RunsOn::Nothing, callee: Callee::Function, span });
        }
    }

    fn push_arguments(&mut self, arguments: &[Argument]) {
        for argument in arguments {
            match argument {
                Argument::Value(expr) => self.settled(expr),
                Argument::Reference(place) => self.full_address(place),
            }
        }
    }

    /// The arguments are evaluated where the caller is, then become the unit's registers.
    fn inline_function(&mut self, call: &FunctionCall, pou: &Pou, span: Span) {
        let targets: Vec<_> = call.arguments.iter().map(|argument| self.scope().argument(argument)).collect();
        self.push_arguments(&call.arguments);
        self.enter(call.pou, pou, 0, Some((Callee::Function, span)));
        for (index, (address, extent)) in targets.into_iter().enumerate().rev() {
            let local = LocalId(index as u32);
            let register = self.repoint(local, extent);
            self.set(register);
            if let Some(address) = address {
                self.point(local, address);
            }
        }
        self.body(pou);
        self.leave();
    }

    /// Copies the aggregate whose address is on the stack to `place` and pushes that address.
    fn keep_result(&mut self, place: &Place) {
        let source = self.scratch(wasm_encoder::ValType::I32);
        self.set(source);
        self.full_address(place);
        self.get(source);
        self.release(source);
        let size = self.size_of(place.ty);
        self.emit(Instruction::I32Const(size as i32));
        self.emit(Instruction::MemoryCopy { src_mem: 0, dst_mem: 0 });
        self.changed(self.extent(place));
        self.full_address(place);
    }
}
