//! Assignments that vendors add: in chains, and those that depend on what is there already.

use crate::check::body::Body;
use crate::check::types::operand::{Operand, constant};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Expr, ExprKind, IfBranch, Statement, StatementKind, Value};
use crate::syntax::Span;
use crate::syntax::ast::{self, BinaryOp, UpdateOp};

impl Body<'_, '_> {
    /// `a := b := c` is `b := c; a := b`.
    pub(super) fn chained(&mut self, targets: &[ast::Expr], value: &ast::Expr, span: Span) -> Vec<Statement> {
        let mut source = value;
        let mut checked = Vec::new();
        for target in targets.iter().rev() {
            checked.extend(self.assign(target, source, span));
            source = target;
        }
        checked
    }

    /// `a += b` is `a := a + b`; `a S= b` is `IF b THEN a := TRUE; END_IF`.
    pub(super) fn update(
        &mut self,
        operator: UpdateOp,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Option<Statement> {
        let operator = match operator {
            UpdateOp::Set | UpdateOp::Reset => return self.set_or_reset(operator, target, value, span),
            UpdateOp::Add => BinaryOp::Add,
            UpdateOp::Subtract => BinaryOp::Subtract,
            UpdateOp::Multiply => BinaryOp::Multiply,
            UpdateOp::Divide => BinaryOp::Divide,
        };
        let place = self.target(target)?;
        let ty = self.declarations.types().of_value(place.ty);
        let before = Expr { kind: ExprKind::Load(place.clone()), ty, span: target.span };
        let context = self.elementary(ty);
        let value = self.within(context, |body| body.expression(value))?;
        let after = self.binary(operator, Operand::Typed(before), value, span)?;
        let after = self.coerce(after, place.ty)?;
        Some(self.assignment(place, after, span))
    }

    /// `a S= b R= c`: the value at the end, evaluated once, sets or resets each target.
    pub(super) fn set_and_reset(
        &mut self,
        targets: &[(UpdateOp, ast::Expr)],
        value: &ast::Expr,
        span: Span,
    ) -> Vec<Statement> {
        let condition = self.condition(value).map(|condition| self.once(condition));
        let (mut checked, condition) = condition.map_or((Vec::new(), None), |(before, again)| (before, Some(again)));
        for (operator, target) in targets {
            checked.extend(self.set_if(*operator, target, condition.clone(), span));
        }
        checked
    }

    fn set_or_reset(
        &mut self,
        operator: UpdateOp,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Option<Statement> {
        let condition = self.condition(value);
        self.set_if(operator, target, condition, span)
    }

    /// Sets or resets a target if the condition, where that is right, holds.
    fn set_if(
        &mut self,
        operator: UpdateOp,
        target: &ast::Expr,
        condition: Option<Expr>,
        span: Span,
    ) -> Option<Statement> {
        let place = self.target(target);
        let (place, condition) = (place?, condition?);
        if self.elementary(place.ty) != Some(ElementaryType::Bool) {
            let message = format!("{} is for BOOL, not {}", operator.text(), self.type_name(place.ty));
            self.report(Diagnostic::error(Code::InvalidOperand, target.span, message));
            return None;
        }
        let level = constant(Value::Bool(operator == UpdateOp::Set), ElementaryType::Bool, span);
        let body = vec![Statement { kind: StatementKind::Assign(place, level), span }];
        Some(Statement { kind: StatementKind::If(vec![IfBranch { condition, body }], Vec::new()), span })
    }
}
