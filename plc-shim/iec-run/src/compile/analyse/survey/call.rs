//! Calls: the walk goes into units that are put in their place, and past all others.

use super::Walk;
use crate::compile::analyse::address::{Address, Extent, Register};
use crate::compile::analyse::price;
use crate::compile::analyse::reach::RunsOn;
use crate::compile::analyse::scope::INSTANCE;
use onescan_iec::ir::{Argument, Cast, Dispatch, FunctionCall, InstanceCall, LocalId, Pou, PouId, Receiver};

impl Walk<'_, '_> {
    pub(super) fn call_instance(&mut self, call: &InstanceCall) {
        let address = self.instance_address(call);
        self.scope.point(call.pointer, address);
        self.statements(&call.inputs);
        let inlined = self.program.inlined(call.pou, &self.scope);
        if let Some(pou) = inlined.filter(|_| call.dispatch == Dispatch::Direct) {
            self.enter(call.pou, pou);
            self.scope.point(INSTANCE, address);
            self.body(pou);
        } else {
            let size = self.scope.types().size(call.instance.ty);
            self.call(call.pou, call.dispatch, RunsOn::Instance(Extent::new(address, size)));
        }
        self.statements(&call.outputs);
    }

    pub(super) fn instance_address(&mut self, call: &InstanceCall) -> Address {
        if let Some(address) = self.scope.fixed_address(&call.instance) {
            return address;
        }
        let extent = self.scope.extent(&call.instance);
        self.full_address(&call.instance);
        let register = self.scope.register(call.pointer);
        self.set(register);
        self.scope.lead(register, extent);
        Address::of_register(register)
    }

    pub(super) fn enter(&mut self, id: PouId, pou: &Pou) {
        let first = self.next_register;
        self.next_register = first.saturating_add(pou.registers.len() as u32);
        self.scope.enter(id, (first..self.next_register).map(Register::new).collect());
    }

    pub(super) fn body(&mut self, pou: &Pou) {
        self.charge(2);
        self.statements(&pou.body);
        if let Some(result) = &pou.result {
            self.load(result);
        }
        self.scope.leave();
    }

    pub(super) fn call(&mut self, pou: PouId, dispatch: Dispatch, on: RunsOn) {
        let costs = self.program.costs();
        if let Dispatch::Row(_) = dispatch {
            self.metered = true;
            self.charge(price::ROW_CALL);
            self.changed(None);
            return;
        }
        self.metered |= costs.is_metered(pou);
        self.charge(costs.of_call(pou).saturating_add(1));
        match on {
            RunsOn::Nothing if costs.stays_inside(pou) => {}
            RunsOn::Instance(extent) if costs.stays_inside(pou) => self.changed(Some(extent)),
            RunsOn::Nothing | RunsOn::Instance(_) | RunsOn::Anywhere => self.changed(None),
        }
    }

    pub(super) fn call_function(&mut self, call: &FunctionCall) {
        if let Some(receiver) = &call.receiver {
            self.receiver(receiver);
            self.statements(&call.before);
            self.arguments(&call.arguments);
            self.call(call.pou, receiver.dispatch, RunsOn::Anywhere);
        } else {
            self.statements(&call.before);
            if let Some(pou) = self.program.inlined(call.pou, &self.scope) {
                self.inline_function(call, pou);
            } else {
                self.arguments(&call.arguments);
                self.call(call.pou, Dispatch::Direct, RunsOn::Nothing);
            }
        }
        if let Some(place) = &call.result {
            self.full_address(place);
            self.charge(price::COPY);
            self.changed(self.scope.extent(place));
            self.full_address(place);
        }
        self.statements(&call.outputs);
    }

    pub(super) fn inline_function(&mut self, call: &FunctionCall, pou: &Pou) {
        let targets: Vec<_> = call.arguments.iter().map(|argument| self.scope.argument(argument)).collect();
        self.arguments(&call.arguments);
        self.enter(call.pou, pou);
        for (index, (address, extent)) in targets.into_iter().enumerate().rev() {
            let local = LocalId(index as u32);
            let register = self.scope.register(local);
            self.set(register);
            self.scope.lead(register, extent);
            if let Some(address) = address {
                self.scope.point(local, address);
            }
        }
        self.body(pou);
    }

    pub(super) fn arguments(&mut self, arguments: &[Argument]) {
        for argument in arguments {
            match argument {
                Argument::Value(expr) => self.settled(expr),
                Argument::Reference(place) => self.full_address(place),
            }
        }
    }

    pub(super) fn receiver(&mut self, receiver: &Receiver) {
        self.expression(&receiver.instance);
        self.points_anywhere(receiver.pointer);
        self.charge(if receiver.may_be_null { 5 } else { 0 });
    }

    pub(super) fn cast(&mut self, cast: &Cast) {
        self.expression(&cast.reference);
        self.points_anywhere(cast.pointer);
        self.charge(3 + 7 * cast.types.len() as u64);
    }

    pub(super) fn points_anywhere(&mut self, pointer: LocalId) {
        let register = self.scope.register(pointer);
        self.scope.lead(register, None);
        self.scope.unpoint(pointer);
        self.set(register);
    }
}
