//! Statements report to the host when they begin and end and what they read, and decisions which way they go.

use wasm_encoder::Instruction;

use super::emitter::Emitter;
use crate::compile::analyse::{Address, Extent};
use crate::compile::points::{PointKind, Points};
use crate::compile::trace::index;
use onescan_iec::ir::{Expr, ExprKind, Place, PouId, Statement, StatementKind, Step, Storage};
use onescan_iec::syntax::Span;

impl Emitter<'_, '_> {
    /// Reports that a point's statement begins.
    pub(crate) fn trace_begin(&mut self, point: u32) {
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(point as i32));
            emitter.emit(Instruction::Call(index(0)));
        });
    }

    /// Reports that a statement goes a way.
    pub(crate) fn trace_choice(&mut self, statement: u32, outcome: u32) {
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(statement as i32));
            emitter.emit(Instruction::I32Const(outcome as i32));
            emitter.emit(Instruction::Call(index(2)));
        });
    }

    /// Reports that a place is read, if the program is traced. What a library reads is its own business.
    pub(crate) fn trace_read(&mut self, place: &Place, span: Span) {
        if !self.shared().points().is_some_and(|points| points.is_traced() && points.is_own(span)) {
            return;
        }
        // A register is not a place that a variable outlives its unit in. What calls something must not do so twice.
        if matches!(place.storage, Storage::Register(_)) || !is_pure(place) {
            return;
        }
        let size = self.size_of(place.ty);
        self.free_of_charge(|emitter| {
            match emitter.fixed_address(place) {
                Some(address) => emitter.push_address(address),
                None => emitter.full_address(place),
            }
            emitter.emit(Instruction::I32Const(size as i32));
            emitter.emit(Instruction::Call(index(3)));
        });
    }

    /// True if a unit is not a user's.
    pub(crate) fn is_of_library(&self, pou: PouId) -> bool {
        let span = self.program().pou(pou).map(|pou| pou.span);
        self.shared().points().is_some_and(|points| span.is_some_and(|span| !points.is_own(span)))
    }

    /// Reports that a statement ends, if the program is traced.
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

/// True if the way to a place does nothing but read and reckon.
fn is_pure(place: &Place) -> bool {
    place.steps.iter().all(|step| match step {
        Step::Index { index, .. } => is_pure_value(index),
        Step::Offset(_) | Step::Pointer { .. } | Step::Open { .. } => true,
    })
}

fn is_pure_value(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Constant(_) => true,
        ExprKind::Load(place) => is_pure(place),
        ExprKind::Unary(_, operand)
        | ExprKind::Convert(_, operand)
        | ExprKind::FromRegister(operand)
        | ExprKind::Limited(_, _, operand) => is_pure_value(operand),
        ExprKind::Binary(_, left, right) => is_pure_value(left) && is_pure_value(right),
        _ => false,
    }
}
