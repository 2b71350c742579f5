//! Inputs of which a unit sees the edges, `R_EDGE` and `F_EDGE` (2nd ed. 2.5.2.2, Table 33).
//!
//! The unit behaves as if it had an instance of `R_TRIG` or `F_TRIG` for the input, called once at its
//! beginning, and used its Q instead of the input.

use super::scope::Body;
use crate::ir::{
    Binary, EdgeDetection, ElementaryType, Expr, ExprKind, Place, Statement, StatementKind, Storage, TypeId, Unary,
    Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::Edge;

fn load(storage: Storage, span: Span) -> Expr {
    let ty: TypeId = ElementaryType::Bool.into();
    Expr { kind: ExprKind::Load(Place::whole(storage, ty, span)), ty, span }
}

fn not(operand: Expr) -> Expr {
    let (ty, span) = (operand.ty, operand.span);
    Expr { kind: ExprKind::Unary(Unary::Not, Box::new(operand)), ty, span }
}

fn assign(storage: Storage, value: Expr) -> Statement {
    let (ty, span) = (value.ty, value.span);
    Statement { kind: StatementKind::Assign(Place::whole(storage, ty, span), value), span }
}

impl Body<'_, '_> {
    /// Looks for the edge once in every call of the unit.
    pub(super) fn detected(variable: &Variable, detection: EdgeDetection) -> [Statement; 2] {
        let span = variable.span;
        let level = match detection.edge {
            Edge::Rising => load(variable.storage, span),
            Edge::Falling => not(load(variable.storage, span)),
        };
        let (ty, before) = (level.ty, not(load(detection.memory, span)));
        let kind = ExprKind::Binary(Binary::And, Box::new(level.clone()), Box::new(before));
        let seen = assign(Storage::Register(detection.seen), Expr { kind, ty, span });
        [seen, assign(detection.memory, level)]
    }
}
