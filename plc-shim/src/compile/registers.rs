//! Registers of one function: locals of WebAssembly, given out and taken back.

use wasm_encoder::ValType;

/// A local of the function that is being made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Register(pub(super) u32);

/// WebAssembly allows 50,000 locals; what is only for speed stops long before.
const MANY: usize = 20_000;

#[derive(Debug, Clone)]
pub(super) struct Registers {
    parameters: usize,
    types: Vec<ValType>,
    free: Vec<Register>,
}

impl Registers {
    pub(super) fn new(parameters: Vec<ValType>) -> Self {
        Self { parameters: parameters.len(), types: parameters, free: Vec::new() }
    }

    /// A free register.
    pub(super) fn take(&mut self, ty: ValType) -> Register {
        let fits = |register: &Register| self.types.get(register.0 as usize) == Some(&ty);
        if let Some(index) = self.free.iter().position(fits) {
            return self.free.swap_remove(index);
        }
        self.types.push(ty);
        Register(self.types.len() as u32 - 1)
    }

    pub(super) fn release(&mut self, register: Register) {
        self.free.push(register);
    }

    pub(super) fn are_many(&self) -> bool {
        self.types.len() > MANY
    }

    /// The types of all but the parameters.
    pub(super) fn locals(&self) -> &[ValType] {
        self.types.get(self.parameters..).unwrap_or(&[])
    }
}
