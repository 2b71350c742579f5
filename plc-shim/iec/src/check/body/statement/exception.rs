//! What vendors write as statements of their own: a value that goes nowhere, and `__TRY`.

use crate::check::body::Body;
use crate::check::types::build::{truth, when};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Statement, StatementKind};
use crate::syntax::Span;
use crate::syntax::ast;

impl Body<'_, '_> {
    /// `a.b;`: reads it, which a property may notice.
    pub(super) fn value_statement(&mut self, value: &ast::Expr) -> Option<StatementKind> {
        let operand = self.within(None, |body| body.expression(value))?;
        let found = self.settle(operand)?;
        let message = "this value goes nowhere";
        self.report(Diagnostic::warning(Code::ResultIgnored, value.span, message));
        Some(StatementKind::Evaluate(found))
    }

    /// `__TRY`: its statements run as if it were not there. A fault stops the PLC, wherever it is, so the handler is
    /// checked and never runs.
    pub(super) fn try_statement(&mut self, inner: &ast::TryStatement, span: Span) -> Vec<Statement> {
        let at = Span { end: span.start + 5, ..span };
        let found = Diagnostic::warning(Code::UncaughtFault, at, "a fault in here is not caught: it stops the PLC");
        self.report(found.with_help("check what may fail before it does"));
        let mut always = self.statements(&inner.body);
        if let Some(code) = &inner.code {
            // Whatever its type is called, it takes a code.
            self.target(code);
        }
        let handler = self.statements(&inner.handler);
        always.push(when(truth(false, at), handler, at));
        always.extend(self.statements(&inner.finally));
        always
    }
}
