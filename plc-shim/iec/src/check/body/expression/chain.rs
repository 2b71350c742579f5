//! Long rows of operators, from the left to the right, without depth: the sum so far is kept in a register now and then.

use crate::check::body::Body;
use crate::check::types::constant::fold;
use crate::check::types::operand::{Operand, constant};
use crate::ir::{Expr, ExprKind, Place, Statement, StatementKind, Storage};
use crate::syntax::Span;
use crate::syntax::ast::{self, BinaryOp, CHAIN_HEIGHT, Link};

impl Body<'_, '_> {
    pub(super) fn row_of_operators(&mut self, first: &ast::Expr, links: &[Link], span: Span) -> Option<Operand> {
        let mut comparisons = links.iter().filter(|link| link.operator.is_comparison()).count();
        let context = self.context;
        // What a comparison compares has nothing to do with where its result goes.
        let mut left = self.within(context.filter(|_| comparisons == 0), |body| body.expression(first));
        let mut before = Vec::new();
        for (index, link) in links.iter().enumerate() {
            let context = context.filter(|_| comparisons == 0);
            comparisons -= usize::from(link.operator.is_comparison());
            let right = |body: &mut Self| body.within(context, |body| body.expression(&link.operand));
            let until = first.span.to(link.operand.span);
            left = match link.operator {
                BinaryOp::AndThen | BinaryOp::OrElse => {
                    let left = left.and_then(|left| self.truth_of(left));
                    self.short_circuited(link.operator, left, &link.operand, until)
                }
                operator => match (left, right(self)) {
                    (Some(left), Some(right)) => self.binary(operator, left, right, until),
                    _ => None,
                },
            };
            if (index + 1) % usize::from(CHAIN_HEIGHT) == 0 {
                left = left.map(|left| self.kept_so_far(left, &mut before));
            }
        }
        let value = left?;
        if before.is_empty() {
            return Some(value);
        }
        let value = self.settle(value)?;
        let ty = value.ty;
        Some(Operand::Typed(Expr { kind: ExprKind::After(before, Some(Box::new(value))), ty, span }))
    }

    /// The same value, without the tree that computes it: a constant, or what a statement before leaves in a register.
    fn kept_so_far(&mut self, value: Operand, before: &mut Vec<Statement>) -> Operand {
        let Operand::Typed(expr) = value else { return value };
        let Some(ty) = self.elementary(expr.ty) else { return Operand::Typed(expr) };
        let (span, whole) = (expr.span, expr.ty);
        if let Ok(value) = fold(self.declarations.types(), &expr) {
            return Operand::Typed(Expr { ty: whole, ..constant(value, ty, span) });
        }
        let place = Place::whole(Storage::Register(self.scope.register(ty)), whole, span);
        before.push(Statement { kind: StatementKind::Assign(place.clone(), expr), span });
        Operand::Typed(Expr { kind: ExprKind::Load(place), ty: whole, span })
    }
}
