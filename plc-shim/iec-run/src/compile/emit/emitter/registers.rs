//! Registers of one function: locals of WebAssembly, given out and taken back.

use wasm_encoder::{Instruction, ValType};

use super::Emitter;
use crate::compile::analyse::Register;

/// WebAssembly allows 50,000 locals; what is only for speed stops long before.
const MANY: usize = 20_000;

#[derive(Debug)]
pub(super) struct Registers {
    parameters: usize,
    types: Vec<ValType>,
    free: Vec<Register>,
}

impl Registers {
    pub(super) fn new(parameters: Vec<ValType>) -> Self {
        Self { parameters: parameters.len(), types: parameters, free: Vec::new() }
    }

    fn take(&mut self, ty: ValType) -> Register {
        let fits = |register: &Register| self.types.get(register.number() as usize) == Some(&ty);
        if let Some(index) = self.free.iter().position(fits) {
            return self.free.swap_remove(index);
        }
        self.types.push(ty);
        Register::new(self.types.len() as u32 - 1)
    }

    pub(super) fn are_many(&self) -> bool {
        self.types.len() > MANY
    }

    /// The types of all but the parameters.
    pub(super) fn locals(&self) -> &[ValType] {
        self.types.get(self.parameters..).unwrap_or(&[])
    }
}

impl Emitter<'_, '_> {
    /// A free register; [`Self::release`] gives it back.
    pub(crate) fn scratch(&mut self, ty: ValType) -> Register {
        self.registers.take(ty)
    }

    pub(crate) fn release(&mut self, register: Register) {
        debug_assert!((register.number() as usize) < self.registers.types.len(), "only a register of this function");
        debug_assert!(!self.registers.free.contains(&register), "a register is given back once");
        self.registers.free.push(register);
    }

    pub(crate) fn get(&mut self, register: Register) {
        debug_assert!((register.number() as usize) < self.registers.types.len(), "only a register of this function");
        self.emit(Instruction::LocalGet(register.number()));
    }

    pub(crate) fn set(&mut self, register: Register) {
        self.known.ranges_mut().forget_register(register);
        debug_assert!((register.number() as usize) < self.registers.types.len(), "only a register of this function");
        self.emit(Instruction::LocalSet(register.number()));
    }

    pub(crate) fn tee(&mut self, register: Register) {
        self.known.ranges_mut().forget_register(register);
        debug_assert!((register.number() as usize) < self.registers.types.len(), "only a register of this function");
        self.emit(Instruction::LocalTee(register.number()));
    }
}
