//! `DTL` of Siemens: date and time in parts (S7-1200 System Manual: data types, DTL). Its type and conversions
//! are program text, `iec/vendor/dtl.st`; here are its literals.

use crate::check::body::Body;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Expr, ExprKind, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Literal};
use crate::syntax::calendar::{CalendarKind, DAY_NS, civil_from_days};

/// Bytes of the structure.
const SIZE: usize = 12;

/// 1970-01-01 was a Thursday; 1 is Sunday.
const WEEKDAY_OF_DAY_0: i64 = 5;

/// True for `DTL#2024-05-06-07:08:09.5`.
pub(in crate::check) fn is_literal(expr: &ast::Expr) -> bool {
    matches!(&expr.kind, ast::ExprKind::Literal(Literal::Calendar { kind: CalendarKind::Parts, .. }))
}

/// The structure of a moment in nanoseconds since 1970-01-01.
fn parts(ns: i64) -> [u8; SIZE] {
    let (days, time) = (ns.div_euclid(DAY_NS), ns.rem_euclid(DAY_NS));
    let (year, month, day) = civil_from_days(days);
    let weekday = (days + WEEKDAY_OF_DAY_0 - 1).rem_euclid(7) + 1;
    let seconds = time / 1_000_000_000;
    let mut bytes = [0; SIZE];
    bytes[..2].copy_from_slice(&(year as u16).to_le_bytes());
    let small = [month, day, weekday, seconds / 3600, seconds / 60 % 60, seconds % 60];
    for (byte, value) in bytes[2..8].iter_mut().zip(small) {
        *byte = value as u8;
    }
    bytes[8..].copy_from_slice(&((time % 1_000_000_000) as u32).to_le_bytes());
    bytes
}

impl Body<'_, '_> {
    /// The value of a literal.
    pub(super) fn dtl_literal(&mut self, ns: i64, span: Span) -> Option<Operand> {
        let ty = self.dtl_type(span)?;
        let bytes = self.dtl_parts(ns, span)?;
        let place = self.declarations.constant_bytes(ty, bytes.into(), span)?;
        Some(Operand::Typed(Expr { kind: ExprKind::Load(place), ty, span }))
    }

    /// What a literal makes of a variable of type `ty`.
    pub(in crate::check) fn dtl_bytes(&mut self, expr: &ast::Expr, ty: TypeId) -> Option<[u8; SIZE]> {
        let ast::ExprKind::Literal(Literal::Calendar { ns, .. }) = &expr.kind else { return None };
        if self.dtl_type(expr.span)? != ty {
            let wanted = self.type_name(ty);
            return self.mismatch(&wanted, "DTL", expr.span);
        }
        self.dtl_parts(*ns, expr.span)
    }

    fn dtl_parts(&mut self, ns: i64, span: Span) -> Option<[u8; SIZE]> {
        if ns >= 0 {
            return Some(parts(ns));
        }
        self.report(Diagnostic::error(Code::InvalidLiteral, span, "a DTL begins with 1970-01-01"));
        None
    }

    /// The library's type, unless the project has one of its own.
    fn dtl_type(&mut self, span: Span) -> Option<TypeId> {
        if !self.declarations.is_library_type("DTL") {
            let message = "the type DTL is declared by the project, which leaves its literals without meaning";
            self.report(Diagnostic::error(Code::InvalidLiteral, span, message));
            return None;
        }
        self.declarations.named_type("DTL", None).map(|found| found.ty)
    }
}

#[cfg(test)]
mod tests {
    use super::parts;

    #[test]
    fn a_moment_has_its_parts() {
        assert_eq!(parts(0), [178, 7, 1, 1, 5, 0, 0, 0, 0, 0, 0, 0]);
        // 2024-05-06 was a Monday.
        let ns = 1_714_979_289_123_456_789;
        assert_eq!(parts(ns), [232, 7, 5, 6, 2, 7, 8, 9, 0x15, 0xCD, 0x5B, 0x07]);
        assert_eq!(parts(i64::MAX)[..8], [214, 8, 4, 11, 6, 23, 47, 16]);
    }
}
