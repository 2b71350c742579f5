//! What is noted of the execution, for coverage.

use wasm_encoder::{Instruction, MemArg};

use super::emitter::Emitter;
use crate::compile::points::{NOTES_MEMORY, PointKind, Points};
use onescan_iec::syntax::Span;

impl Emitter<'_, '_> {
    /// Notes that execution comes here.
    pub(crate) fn cover(&mut self, kind: PointKind, span: Span) {
        let Some(is_traced) = self.shared().points().map(Points::is_traced) else { return };
        if kind == PointKind::Statement && self.is_declaration(span) {
            return;
        }
        if is_traced {
            self.trace(kind, span);
            return;
        }
        let Some(index) = self.note_of(kind, span) else { return };
        let note = MemArg { offset: u64::from(index), align: 0, memory_index: NOTES_MEMORY };
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(0));
            emitter.emit(Instruction::I32Const(1));
            emitter.emit(Instruction::I32Store8(note));
        });
    }

    fn trace(&mut self, kind: PointKind, span: Span) {
        match kind {
            // The statement with the call has reported already.
            PointKind::Unit => {}
            PointKind::Statement => {
                if let Some(statement) = self.note_of(kind, span) {
                    self.trace_begin(statement);
                }
            }
            PointKind::Outcome(_) => {
                let statement = self.note_of(PointKind::Statement, span);
                if let Some((statement, outcome)) = statement.zip(self.note_of(kind, span)) {
                    self.trace_choice(statement, outcome);
                }
            }
        }
    }

    /// The number of a point of the running unit; nothing if none is noted there.
    pub(super) fn note_of(&mut self, kind: PointKind, span: Span) -> Option<u32> {
        let pou = self.program().pou(self.scope().unit()?)?;
        self.shared_mut().points_mut()?.index(kind, &pou.name, span)
    }

    /// Initial values are given by declarations, which are not statements.
    pub(super) fn is_declaration(&self, span: Span) -> bool {
        let pou = self.scope().unit().and_then(|id| self.program().pou(id));
        pou.is_some_and(|pou| pou.variables.iter().any(|variable| variable.span == span))
    }
}
