//! Statements tell the host when they begin and end, and decisions which way they go.

use wasm_encoder::Instruction;

use super::emitter::Emitter;
use crate::compile::analyse::{Address, Extent};
use crate::compile::points::{PointKind, Points};
use crate::compile::trace::index;
use crate::ir::{Statement, StatementKind};

impl Emitter<'_, '_> {
    /// Tells that a point's statement begins.
    pub(crate) fn trace_begin(&mut self, point: u32) {
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(point as i32));
            emitter.emit(Instruction::Call(index(0)));
        });
    }

    /// Tells that a statement goes a way.
    pub(crate) fn trace_choice(&mut self, statement: u32, outcome: u32) {
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(statement as i32));
            emitter.emit(Instruction::I32Const(outcome as i32));
            emitter.emit(Instruction::Call(index(2)));
        });
    }

    /// Tells that a statement ends, if the program is traced.
    pub(crate) fn trace_end(&mut self, statement: &Statement) {
        if !self.shared().points().is_some_and(Points::is_traced) || self.is_declaration(statement.span) {
            return;
        }
        let Some(point) = self.note_of(PointKind::Statement, statement.span) else { return };
        let written = match &statement.kind {
            StatementKind::Assign(target, _) | StatementKind::Copy(target, _) => self.extent(target),
            _ => None,
        };
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(point as i32));
            if let Some(Extent { base, start, end }) = written {
                emitter.push_address(Address { base, offset: start });
                emitter.emit(Instruction::I32Const((end - start) as i32));
            } else {
                emitter.emit(Instruction::I32Const(0));
                emitter.emit(Instruction::I32Const(0));
            }
            emitter.emit(Instruction::Call(index(1)));
        });
    }
}
