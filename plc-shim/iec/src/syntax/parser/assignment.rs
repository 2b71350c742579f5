//! Assignments, calls, and what vendors write like them.

use onescan_base::ElementaryType;

use super::cursor::Cursor;
use super::exception::TRY;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, StatementKind, UpdateOp};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

impl Cursor<'_> {
    pub(super) fn assignment_or_call(&mut self) -> StatementKind {
        if let Some(kind) = self.slip() {
            return kind;
        }
        if let Some(kind) = self.jump() {
            return kind;
        }
        if self.at_word(TRY) {
            return self.try_statement();
        }
        let known = self.reported();
        let target = self.expression_or_target();
        if self.pass_increment(&target) {
            return StatementKind::Error;
        }
        if self.take_mark(Punctuation::Assign) {
            return self.assigned(target);
        }
        if self.take_mark(Punctuation::Attempt) {
            return StatementKind::Attempt(target, self.expression());
        }
        if self.at_reference_assignment() {
            self.advance();
            self.advance();
            return StatementKind::Refer(target, self.expression());
        }
        if let Some((operator, at)) = self.take_update() {
            let value = self.expression();
            self.require_update(operator, at, &target, &value);
            if matches!(operator, UpdateOp::Set | UpdateOp::Reset) && self.at_set_or_reset() {
                return self.set_and_reset((operator, target), value);
            }
            return StatementKind::Update(operator, target, value);
        }
        if let ExprKind::Call(call) = target.kind {
            return StatementKind::Call(call);
        }
        if self.reported() == known && self.is_value(&target) {
            self.require(Feature::ValueStatements, target.span);
            let is_allowed = self.dialect().has(Feature::ValueStatements);
            return if is_allowed { StatementKind::Value(target) } else { StatementKind::Error };
        }
        if self.reported() == known {
            if self.at_mark(Punctuation::Equal) || matches!(target.kind, ExprKind::Binary(BinaryOp::Equal, ..)) {
                let message = "this is a comparison, not an assignment";
                let found = Diagnostic::error(Code::UnexpectedToken, target.span, message);
                self.report(found.with_help("assign with `:=`"));
            } else if let Some(help) = self.meant_declaration(self.text(target.span.start, target.span.end)) {
                let message = "a variable is not declared among statements";
                self.report(Diagnostic::error(Code::UnexpectedToken, target.span, message).with_help(help));
            } else {
                self.unexpected("`:=` or `(`");
            }
        }
        StatementKind::Error
    }

    /// True for a place that is a statement by itself. One name alone is what remains of another mistake more often.
    fn is_value(&self, expr: &Expr) -> bool {
        self.at_mark(Punctuation::Semicolon)
            && matches!(expr.kind, ExprKind::Member(..) | ExprKind::Index(..) | ExprKind::Dereference(_))
    }

    /// What a statement begins with; of `a++` the name alone.
    fn expression_or_target(&mut self) -> Expr {
        if self.is_increment() { self.postfix() } else { self.expression() }
    }

    /// What stands behind `target :=`.
    fn assigned(&mut self, target: Expr) -> StatementKind {
        let mut value = self.expression();
        if !self.at_mark(Punctuation::Assign) {
            return StatementKind::Assign(target, value);
        }
        let mut targets = vec![target];
        while self.at_mark(Punctuation::Assign) {
            self.require(Feature::ChainedAssignment, self.span());
            self.advance();
            targets.push(std::mem::replace(&mut value, self.expression()));
        }
        StatementKind::Chain(targets, value)
    }

    /// `REF=`, which the lexer takes for a name and a mark.
    pub(super) fn at_reference_assignment(&self) -> bool {
        self.at_word("REF") && self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::Equal))
    }

    fn take_update(&mut self) -> Option<(UpdateOp, Span)> {
        let span = self.span();
        let operator = match self.peek()? {
            TokenKind::Punctuation(Punctuation::PlusAssign) => UpdateOp::Add,
            TokenKind::Punctuation(Punctuation::MinusAssign) => UpdateOp::Subtract,
            TokenKind::Punctuation(Punctuation::StarAssign) => UpdateOp::Multiply,
            TokenKind::Punctuation(Punctuation::SlashAssign) => UpdateOp::Divide,
            // Behind an operand a name can only be `S` or `R` of `S=` and `R=`.
            TokenKind::Identifier if self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::Equal)) => {
                let operator = match self.next_text() {
                    "S" | "s" => UpdateOp::Set,
                    "R" | "r" => UpdateOp::Reset,
                    _ => return None,
                };
                self.advance();
                operator
            }
            _ => return None,
        };
        self.advance();
        Some((operator, span))
    }

    fn at_set_or_reset(&self) -> bool {
        self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::Equal))
            && (self.at_word("S") || self.at_word("R"))
    }

    /// `a S= b R= c`
    fn set_and_reset(&mut self, first: (UpdateOp, Expr), mut value: Expr) -> StatementKind {
        let mut targets = vec![first];
        while self.at_set_or_reset()
            && let Some((operator, _)) = self.take_update()
        {
            let target = std::mem::replace(&mut value, self.expression());
            targets.push((operator, target));
        }
        StatementKind::SetReset(targets, value)
    }

    /// Reports `+=` and the like where the dialect lacks them.
    fn require_update(&mut self, operator: UpdateOp, at: Span, target: &Expr, value: &Expr) {
        if matches!(operator, UpdateOp::Set | UpdateOp::Reset) {
            return self.require(Feature::SetReset, at);
        }
        let text = |expr: &Expr| self.text(expr.span.start, expr.span.end);
        let (target, sign) = (text(target), operator.text().trim_end_matches('='));
        let instead = format!("{target} := {target} {sign} {}", text(value));
        self.require_or(Feature::CompoundAssignment, at, Some(instead));
    }

    /// `label:`
    pub(super) fn label(&mut self) -> Option<StatementKind> {
        let colon = self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::Colon));
        // `a : = 1` is an assignment with a blank in it.
        let equals = self.peek_ahead(2) == Some(TokenKind::Punctuation(Punctuation::Equal));
        if self.peek() != Some(TokenKind::Identifier) || !colon || equals {
            return None;
        }
        let name = self.take_identifier()?;
        self.advance();
        if self.at_type() {
            let message = "a variable is declared between `VAR` and `END_VAR`";
            self.report(Diagnostic::error(Code::UnexpectedToken, name.span, message));
            return Some(StatementKind::Error);
        }
        self.require(Feature::Jumps, name.span);
        Some(StatementKind::Label(name))
    }

    /// `JMP label`, `GOTO label`
    fn jump(&mut self) -> Option<StatementKind> {
        let named = self.peek_ahead(1) == Some(TokenKind::Identifier);
        if !named || !(self.at_word("JMP") || self.at_word("GOTO")) {
            return None;
        }
        self.require(Feature::Jumps, self.span());
        self.advance();
        self.take_identifier().map(StatementKind::Jump)
    }

    /// True for the name of an elementary type or `ARRAY`: what is before it is not a label.
    fn at_type(&self) -> bool {
        let text = self.next_text();
        let string = || ["STRING", "WSTRING"].iter().any(|name| name.eq_ignore_ascii_case(text));
        self.at_keyword(Keyword::Array) || ElementaryType::find(text).is_some() || string()
    }
}
