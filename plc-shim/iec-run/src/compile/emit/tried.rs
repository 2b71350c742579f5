//! Statements that a fault ends (`__TRY` of CODESYS and TwinCAT): a function of their own, which the host calls. A trap
//! in it comes to the host, which knows what must stop the PLC; after all else it goes on in the caller.
//!
//! The function knows the registers of its unit by globals. It changes none of them: all variables of such a unit lie
//! in memory.

use wasm_encoder::{Instruction, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::fault::Callee;
use crate::compile::tried;
use onescan_iec::ir::{LocalId, Pou, PouId, Statement, Try};
use onescan_iec::syntax::Span;

impl Emitter<'_, '_> {
    pub(super) fn try_statement(&mut self, inner: &Try, span: Span) {
        let Some((id, pou)) = self.scope().unit().and_then(|id| Some((id, self.program().pou(id)?))) else {
            return self.impossible(span);
        };
        let types = pou.registers.iter().take(inner.outcome.0 as usize);
        let types: Vec<ValType> = types.map(|ty| value_type(*ty)).collect();
        let globals = self.globals_for(&types);
        let number = self.outlined(id, pou, &inner.body, &globals, span);
        for (local, (global, ty)) in (0..).map(LocalId).zip(globals.into_iter().zip(types)) {
            if ty == ValType::I32 {
                // A pointer's register need not hold it.
                self.push_address(self.scope().pointer(local));
            } else {
                self.get(self.register(local));
            }
            self.hand_on(global);
        }
        self.meter();
        self.put_budget_back();
        self.emit(Instruction::I32Const(number.cast_signed()));
        self.mark_call(Callee::Itself, span);
        self.emit(Instruction::Call(tried::index()));
        self.store_register(inner.outcome);
        self.take_budget();
        self.changed(None);
    }

    /// Makes the function of the statements; returns its number.
    fn outlined(&mut self, id: PouId, pou: &Pou, body: &[Statement], globals: &[u32], span: Span) -> u32 {
        let mut inner = Emitter::new(self.shared_mut(), Vec::new());
        inner.enter(id, pou, 0, None);
        inner.mark_statement(span);
        for (local, global) in (0..).map(LocalId).zip(globals) {
            inner.take_handed(*global);
            inner.store_register(local);
        }
        let outcome = inner.begin_outcome(Try::ENDED);
        let end = inner.open_block();
        inner.returns_to(end);
        inner.statements(body);
        inner.close();
        inner.meet_returns();
        inner.get(outcome);
        let made = inner.finish_try();
        self.shared_mut().add_try(made)
    }
}
