//! Statements tell the host when they begin and end, and decisions which way they go, so that it can
//! say which statement wrote a byte, and why that one.
//!
//! The end of an assignment says what it has written, as far as that is known; what other
//! statements write the host finds by comparing. Statements of the library are silent: what they
//! write is written by the statement that called them.

use wasm_encoder::{Instruction, ValType};

use super::address::{Address, Extent};
use super::emitter::Emitter;
use super::points::PointKind;
use super::{host, text_host};
use crate::ir::{Statement, StatementKind};
use crate::syntax::Span;

/// Module name of the imports.
pub(crate) const MODULE: &str = "trace";
/// A statement, by its point, begins.
pub(crate) const BEGIN: &str = "begin";
/// A statement ends; address and size of what it has written follow, or zeros.
pub(crate) const END: &str = "end";
/// A statement, by its point, goes one of its ways, by the outcome's point.
pub(crate) const CHOOSE: &str = "choose";

/// The imports, in their order behind all others, with their numbers of parameters.
pub(super) const IMPORTS: [(&str, usize); 3] = [(BEGIN, 1), (END, 3), (CHOOSE, 2)];

/// Parameters of an import; there is no result.
pub(super) fn parameters(count: usize) -> Vec<ValType> {
    vec![ValType::I32; count]
}

fn index(import: usize) -> u32 {
    (host::IMPORTS.len() + text_host::IMPORTS.len() + import) as u32
}

impl Emitter<'_, '_> {
    /// Tells that a point's statement begins.
    pub(super) fn trace_begin(&mut self, point: u32) {
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(point as i32));
            emitter.emit(Instruction::Call(index(0)));
        });
    }

    /// Tells that a statement goes a way.
    pub(super) fn trace_choice(&mut self, statement: u32, outcome: u32) {
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(statement as i32));
            emitter.emit(Instruction::I32Const(outcome as i32));
            emitter.emit(Instruction::Call(index(2)));
        });
    }

    /// Tells that a statement ends, if the program is traced.
    pub(super) fn trace_end(&mut self, statement: &Statement) {
        let Some(point) = self.traced_point(statement.span) else { return };
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

    fn traced_point(&mut self, span: Span) -> Option<u32> {
        let pou = self.frames.last().and_then(|frame| self.shared.pous.get(&frame.pou))?;
        let points = self.shared.points.as_mut().filter(|points| points.is_traced())?;
        if pou.variables.iter().any(|variable| variable.span == span) {
            return None;
        }
        points.index(PointKind::Statement, &pou.name, span)
    }
}
