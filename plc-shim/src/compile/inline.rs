//! Calls, and small units put in place of a call.

use wasm_encoder::Instruction;

use super::address::Address;
use super::emitter::{Emitter, value_type};
use super::fault::{Callee, Unit};
use super::frame::Frame;
use super::place::INSTANCE;
use super::points::PointKind;
use super::reach::RunsOn;
use crate::ir::{Argument, Expr, ExprKind, FunctionCall, InstanceCall, LocalId, Place, Pou, PouId};
use crate::syntax::Span;

impl<'p> Emitter<'_, 'p> {
    /// Calls a function of the module.
    pub(super) fn call(&mut self, pou: PouId, on: RunsOn, callee: Callee, span: Span) {
        let metered = self.shared.costs.is_metered(pou);
        if metered {
            self.put_budget_back();
        }
        self.metered |= metered;
        self.mark_call(callee, span);
        match self.shared.functions.get(&pou).copied() {
            Some(index) => self.emit(Instruction::Call(index)),
            None => self.emit(Instruction::Unreachable),
        }
        self.charge(self.shared.costs.of_call(pou));
        if metered {
            self.take_budget();
        }
        match on {
            RunsOn::Nothing if self.shared.costs.stays_inside(pou) => {}
            RunsOn::Instance(extent) if self.shared.costs.stays_inside(pou) => self.changed(Some(extent)),
            _ => self.changed(None),
        }
    }

    /// The unit, if its body goes in the call's place.
    pub(super) fn inlinable(&self, pou: PouId) -> Option<&'p Pou> {
        if self.leaving > 0 {
            return None;
        }
        let active = self.frames.iter().map(|frame| frame.pou);
        self.shared.costs.is_inlined(pou, active).then(|| self.shared.pous.get(&pou)).flatten()
    }

    /// Opens a frame for the unit; `registers` beyond the given ones are new.
    pub(super) fn enter(&mut self, id: PouId, pou: &Pou, parameters: u32, call: Option<(Callee, Span)>) {
        let caller = call.map(|(callee, span)| (self.unit(), callee, span));
        let given = parameters as usize;
        let mut registers: Vec<_> = (0..parameters).map(super::registers::Register).collect();
        for ty in pou.registers.iter().skip(given) {
            registers.push(self.scratch(value_type(*ty)));
        }
        self.units.push(Unit { name: pou.name.clone(), caller });
        self.frames.push(Frame {
            pou: id,
            registers,
            pointers: std::collections::BTreeMap::new(),
            loops: Vec::new(),
            jumps: Vec::new(),
            end: None,
            returned: None,
            unit: self.units.len() as u32 - 1,
        });
    }

    /// The unit's statements and its result.
    pub(super) fn body(&mut self, pou: &Pou) {
        self.mark_statement(pou.span);
        self.cover(PointKind::Unit, pou.span);
        self.enter_guarded(pou);
        let end = self.open_block();
        if let Some(frame) = self.frames.last_mut() {
            frame.end = Some(end);
        }
        self.statements(&pou.body);
        self.close();
        let returned = self.frames.last_mut().and_then(|frame| frame.returned.take());
        self.meet(returned);
        self.leave_guarded(pou);
        if let Some(result) = &pou.result {
            let kind = ExprKind::Load(result.clone());
            self.expression(&Expr { kind, ty: result.ty, span: result.span });
        }
    }

    /// Closes an inlined unit's frame.
    fn leave(&mut self) {
        let Some(frame) = self.frames.pop() else { return };
        for register in frame.registers {
            self.known.forget_base(register);
            self.roots.lead(register, None);
            self.release(register);
        }
        let span = self.marks.iter().rev().find(|(_, mark)| mark.unit < frame.unit).map(|(_, mark)| mark.span);
        if let Some(span) = span {
            self.mark_statement(span);
        }
    }

    pub(super) fn inline_instance(&mut self, call: &InstanceCall, pou: &Pou, callee: Callee, instance: Address) {
        self.enter(call.pou, pou, 0, Some((callee, call.instance.span)));
        if let Some(frame) = self.frames.last_mut() {
            frame.pointers.insert(INSTANCE, instance);
        }
        self.body(pou);
        self.leave();
    }

    pub(super) fn call_function(&mut self, call: &FunctionCall, span: Span) {
        match &call.receiver {
            Some(receiver) => {
                let instance = self.receiver(receiver);
                self.side_statements(&call.before);
                self.push_address(instance);
                self.push_arguments(&call.arguments);
                let on = (instance, RunsOn::Anywhere);
                self.call_on(on, receiver.dispatch, call.pou, (Callee::Function, span));
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
            self.call(call.pou, RunsOn::Nothing, Callee::Function, span);
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
        let targets: Vec<_> = call
            .arguments
            .iter()
            .map(|argument| match argument {
                Argument::Reference(place) => (self.fixed_address(place), self.extent(place)),
                Argument::Value(Expr { kind: ExprKind::Load(place), ty, .. })
                    if self.shared.types.elementary(*ty).is_none() =>
                {
                    (self.fixed_address(place), self.extent(place))
                }
                Argument::Value(_) => (None, None),
            })
            .collect();
        self.push_arguments(&call.arguments);
        self.enter(call.pou, pou, 0, Some((Callee::Function, span)));
        for (index, (address, extent)) in targets.into_iter().enumerate().rev() {
            let local = LocalId(index as u32);
            let register = self.register(local);
            self.set(register);
            self.known.forget_base(register);
            self.roots.lead(register, extent);
            if let (Some(address), Some(frame)) = (address, self.frames.last_mut()) {
                frame.pointers.insert(local, address);
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
        let size = self.shared.types.size(place.ty);
        self.emit(Instruction::I32Const(size as i32));
        self.emit(Instruction::MemoryCopy { src_mem: 0, dst_mem: 0 });
        self.changed(self.extent(place));
        self.full_address(place);
    }
}
