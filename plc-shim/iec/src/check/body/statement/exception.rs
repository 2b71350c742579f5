//! `__TRY` of vendors: statements that a fault ends, what is done then, and what is done in any case.
//!
//! RETURN, EXIT and CONTINUE leave neither the statements nor the handler before `__FINALLY` has run: they say how they
//! leave, and what follows goes there.

use super::jump::Labels;
use crate::check::body::Body;
use crate::check::types::build::{assign, load, operation, when};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{
    Binary, ElementaryType, Expr, ExprKind, LabelId, Labelled, LocalId, Place, Statement, StatementKind, Storage, Try,
    Value,
};
use crate::syntax::Span;
use crate::syntax::ast;

/// A way out of the statements of a `__TRY`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::check::body) enum Leave {
    Return,
    Exit,
    Continue,
}

impl Leave {
    fn outcome(self) -> i32 {
        match self {
            Self::Return => Try::RETURNED,
            Self::Exit => Try::EXITED,
            Self::Continue => Try::CONTINUED,
        }
    }

    fn statement(self) -> StatementKind {
        match self {
            Self::Return => StatementKind::Return,
            Self::Exit => StatementKind::Exit,
            Self::Continue => StatementKind::Continue,
        }
    }
}

/// The part of a `__TRY` whose statements are being checked.
#[derive(Debug)]
pub(in crate::check::body) struct Tried {
    /// Loops around the part: EXIT and CONTINUE of these leave it.
    loops: u32,
    left: Vec<Leave>,
    /// Where a handler that is left goes on. The function of the statements themselves says how they are left.
    handler: Option<Rest>,
}

/// What follows a handler.
#[derive(Debug, Clone, Copy)]
struct Rest {
    outcome: LocalId,
    label: LabelId,
}

impl Body<'_, '_> {
    /// `__TRY … __CATCH(code) … __FINALLY … __ENDTRY`
    pub(super) fn try_statement(&mut self, inner: &ast::TryStatement, span: Span) -> Vec<Statement> {
        let at = Span { end: span.start + 5, ..span };
        let outcome = self.scope.register(ElementaryType::Dint);
        let (body, mut left) = self.tried_part(&inner.body, None);
        let tried = StatementKind::Try(Box::new(Try { body, outcome }));
        let mut made = vec![Statement { kind: tried, span: at }];
        let code = inner.code.as_ref().and_then(|code| self.exception_code(code, outcome));
        let label = LabelId(self.label_count);
        self.label_count += 1;
        let rest = (!inner.finally.is_empty()).then_some(Rest { outcome, label });
        let (handler, left_early) = match rest {
            Some(_) => self.tried_part(&inner.handler, rest),
            None => (self.statements(&inner.handler), Vec::new()),
        };
        let handler = code.into_iter().chain(handler).collect();
        let handler = when(compared(Binary::Greater, outcome, Try::ENDED, at), handler, at);
        let mut last = self.statements(&inner.finally);
        left.extend(left_early);
        left.sort_unstable();
        left.dedup();
        for leave in left {
            let kind = self.leaving(leave, at);
            let leaves = vec![Statement { kind, span: at }];
            last.push(when(compared(Binary::Equal, outcome, leave.outcome(), at), leaves, at));
        }
        if rest.is_some() {
            let parts = vec![(label, last)];
            let labelled = Labelled { first: vec![handler], parts, register: None };
            made.push(Statement { kind: StatementKind::Labelled(Box::new(labelled)), span: at });
        } else {
            made.push(handler);
            made.extend(last);
        }
        made
    }

    /// The statements of a part, out of which no jump leads, and how they are left.
    fn tried_part(&mut self, list: &[ast::Statement], handler: Option<Rest>) -> (Vec<Statement>, Vec<Leave>) {
        let tried = Tried { loops: self.loops, left: Vec::new(), handler };
        self.tried.push(tried);
        let around: Vec<Labels> = std::mem::take(&mut self.labels);
        let checked = self.statements(list);
        self.labels = around;
        let left = self.tried.pop().map_or_else(Vec::new, |tried| tried.left);
        (checked, left)
    }

    /// RETURN, EXIT or CONTINUE.
    pub(super) fn leaving(&mut self, leave: Leave, span: Span) -> StatementKind {
        let Some(tried) = self.tried.last_mut() else { return leave.statement() };
        if leave != Leave::Return && self.loops > tried.loops {
            return leave.statement();
        }
        tried.left.push(leave);
        let Some(Rest { outcome, label }) = tried.handler else { return leave.statement() };
        let place = held(outcome, span);
        let says = assign(&place, number(leave.outcome(), span));
        let goes = Statement { kind: StatementKind::Jump(label), span };
        StatementKind::If(Vec::new(), vec![says, goes])
    }

    /// The variable gets the code of the fault.
    fn exception_code(&mut self, code: &ast::Expr, outcome: LocalId) -> Option<Statement> {
        let target = self.target(code)?;
        let held_as = self.elementary(target.ty).or_else(|| self.base_of_enumeration(target.ty, code.span));
        if held_as.is_none_or(|ty| !ty.is_integer() || ty.size() != 4) {
            let message =
                format!("`__CATCH` gives a code of `__SYSTEM.ExceptionCode`, this is {}", self.type_name(target.ty));
            self.report(Diagnostic::error(Code::TypeMismatch, code.span, message));
            return None;
        }
        let value = Place { ty: target.ty, ..held(outcome, code.span) };
        Some(assign(&target, load(&value)))
    }
}

fn held(outcome: LocalId, span: Span) -> Place {
    Place::whole(Storage::Register(outcome), ElementaryType::Dint.into(), span)
}

fn number(value: i32, span: Span) -> Expr {
    Expr { kind: ExprKind::Constant(Value::Int(value.into())), ty: ElementaryType::Dint.into(), span }
}

fn compared(operator: Binary, outcome: LocalId, value: i32, span: Span) -> Expr {
    let compared = operation(operator, load(&held(outcome, span)), number(value, span));
    Expr { ty: ElementaryType::Bool.into(), ..compared }
}
