//! IF as a choice between two values that are both computed.

use wasm_encoder::Instruction;

use super::emitter::{Emitter, value_type};
use crate::compile::analyse::Choice;

impl Emitter<'_, '_> {
    pub(crate) fn choose(&mut self, choice: &Choice<'_>) {
        let Choice { target, condition, first, second } = choice;
        let held = value_type(self.held_as(target.ty));
        self.store(target, |emitter| {
            emitter.expression(first);
            emitter.expression(second);
            emitter.expression(condition);
            emitter.emit(Instruction::TypedSelect(held));
        });
    }
}
