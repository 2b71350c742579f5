//! Globals that hand a unit's registers on to another function of it.

use wasm_encoder::{Instruction, ValType};

use super::Emitter;
use super::budget::FIRST_HANDED;

/// The globals, by their types.
#[derive(Debug, Default)]
pub(crate) struct Handed(Vec<ValType>);

impl Handed {
    pub(super) fn types(&self) -> &[ValType] {
        &self.0
    }

    /// The global for the `nth` value of a type among those that are handed on together.
    fn global(&mut self, ty: ValType, nth: usize) -> u32 {
        let mut of_type = self.0.iter().enumerate().filter(|(_, known)| **known == ty);
        let at = if let Some((at, _)) = of_type.nth(nth) {
            at
        } else {
            self.0.push(ty);
            self.0.len() - 1
        };
        FIRST_HANDED + at as u32
    }
}

impl Emitter<'_, '_> {
    /// The globals for values of these types, in their order.
    pub(crate) fn globals_for(&mut self, types: &[ValType]) -> Vec<u32> {
        let nth = |at: usize, ty: ValType| types[..at].iter().filter(|known| **known == ty).count();
        types.iter().enumerate().map(|(at, ty)| self.shared.handed.global(*ty, nth(at, *ty))).collect()
    }

    /// Hands on the value on the stack.
    pub(crate) fn hand_on(&mut self, global: u32) {
        self.emit(Instruction::GlobalSet(global));
    }

    /// Pushes a value that was handed on.
    pub(crate) fn take_handed(&mut self, global: u32) {
        self.emit(Instruction::GlobalGet(global));
    }
}
