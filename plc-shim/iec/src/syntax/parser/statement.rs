//! Statements (2nd ed. 3.3.2), with recovery inside a statement.

use super::cursor::Cursor;
use super::declaration::ends_object;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{
    CaseBranch, CaseLabel, CaseStatement, ExprKind, ForStatement, IfBranch, IfStatement, RepeatStatement, Statement,
    StatementKind, WhileStatement,
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// Keywords that close a list of statements, whoever opened it.
fn closes_list(keyword: Keyword) -> bool {
    use Keyword as K;
    if keyword.is_soft() || keyword.is_of_chart() || ends_object(keyword) {
        return true;
    }
    matches!(
        keyword,
        K::EndProgram | K::EndFunctionBlock | K::EndFunction | K::EndIf | K::EndCase | K::EndFor
            | K::EndWhile | K::EndRepeat | K::EndStep | K::EndTransition | K::Elsif | K::Else | K::Until
            | K::Var | K::VarInput | K::VarOutput | K::VarInOut | K::VarTemp | K::VarExternal | K::VarStat | K::VarInst
            // A new unit begins: the end of the one before is missing.
            | K::Program | K::FunctionBlock | K::Function | K::Type | K::EndType | K::VarGlobal
            | K::OrganizationBlock | K::EndOrganizationBlock | K::DataBlock | K::EndDataBlock
    )
}

/// Keywords that begin a statement.
fn begins_statement(keyword: Keyword) -> bool {
    use Keyword as K;
    matches!(keyword, K::If | K::Case | K::For | K::While | K::Repeat | K::Exit | K::Continue | K::Return)
}

impl Cursor<'_> {
    pub(super) fn statements(&mut self) -> Vec<Statement> {
        self.statements_until(|_| false)
    }

    /// The statements of a branch or loop.
    fn inner_statements(&mut self) -> Vec<Statement> {
        self.statements_until(Self::at_foreign_end)
    }

    pub(super) fn statements_until(&mut self, stop: impl Fn(&Self) -> bool) -> Vec<Statement> {
        let mut list = Vec::new();
        loop {
            match self.peek() {
                None => return list,
                Some(TokenKind::Keyword(keyword)) if closes_list(keyword) => return list,
                _ if stop(self) => return list,
                _ => list.push(self.statement()),
            }
        }
    }

    fn statement(&mut self) -> Statement {
        let start = self.span();
        if let Some(kind) = self.label() {
            let reported = matches!(kind, StatementKind::Error);
            let statement = Statement { kind, span: self.span_from(start) };
            if reported {
                self.recover(self.position());
            }
            return statement;
        }
        let (position, known) = (self.position(), self.reported());
        let kind = self.nested(Self::statement_kind).unwrap_or(StatementKind::Error);
        let span = self.span_from(start);
        // A compound statement that found its end has dealt with the errors inside it.
        let closes = self.previous_closes() || matches!(kind, StatementKind::Try(_));
        let ended = self.position() > position && closes;
        if self.reported() > known && !ended {
            self.recover(position);
        } else if !(self.take_mark(Punctuation::Semicolon)
            || ended && self.dialect().has(Feature::LooseEnds)
            || self.at_end_of_branch() && self.dialect().has(Feature::LooseLast))
        {
            self.missing_semicolon(ended);
        }
        Statement { kind, span }
    }

    fn previous_closes(&self) -> bool {
        matches!(self.previous(), Some(TokenKind::Keyword(keyword)) if ends_statement(keyword))
    }

    /// True before what ends the statements of a branch or loop.
    fn at_end_of_branch(&self) -> bool {
        use Keyword as K;
        matches!(
            self.peek(),
            Some(TokenKind::Keyword(
                K::EndIf | K::Elsif | K::Else | K::EndCase | K::EndFor | K::EndWhile | K::EndRepeat | K::Until
            ))
        )
    }

    fn missing_semicolon(&mut self, behind_end: bool) {
        let before = self.previous_span();
        let span = Span { start: before.end.saturating_sub(1).max(before.start), ..before };
        let message = "`;` expected after this";
        let loose = behind_end.then(|| format!("{} may leave it out: --dialect chooses", Feature::LooseEnds.homes()));
        let help = self.meant_behind().or(loose);
        self.report_syntax(Diagnostic::error(Code::UnexpectedToken, span, message).with_optional_help(help));
        // What follows is most often a good statement; only a stray remainder is skipped.
        let good = match self.peek() {
            // A name with nothing behind it is what remains of the statement before.
            Some(TokenKind::Identifier) => self.peek_ahead(1) != Some(TokenKind::Punctuation(Punctuation::Semicolon)),
            Some(TokenKind::DirectAddress) => self.next_text() != "%",
            None => true,
            Some(TokenKind::Keyword(keyword)) => closes_list(keyword) || begins_statement(keyword),
            _ => false,
        };
        if !good {
            self.recover(self.position());
        }
    }

    /// Goes on behind the next `;` or before the next keyword that the grammar knows here.
    /// `started` is where the broken statement began: recovery always makes progress.
    fn recover(&mut self, started: usize) {
        if self.position() == started {
            if let Some(TokenKind::Keyword(keyword)) = self.peek()
                && closes_list(keyword)
            {
                return;
            }
            if !self.at_mark(Punctuation::Semicolon) {
                self.advance();
            }
        }
        if self.position() > started && self.previous() == Some(TokenKind::Punctuation(Punctuation::Semicolon)) {
            return;
        }
        self.skip_until(|kind| match kind {
            TokenKind::Punctuation(Punctuation::Semicolon) => true,
            TokenKind::Keyword(keyword) => closes_list(keyword) || begins_statement(keyword),
            _ => false,
        });
        self.take_mark(Punctuation::Semicolon);
    }

    pub(super) fn statement_kind(&mut self) -> StatementKind {
        match self.peek() {
            Some(TokenKind::Punctuation(Punctuation::Semicolon)) => StatementKind::Empty,
            Some(TokenKind::Keyword(keyword)) => match keyword {
                Keyword::If => self.if_statement(),
                Keyword::Case => self.case_statement(),
                Keyword::For => self.for_statement(),
                Keyword::While => self.while_statement(),
                Keyword::Repeat => self.repeat_statement(),
                Keyword::Exit => self.single(StatementKind::Exit),
                Keyword::Continue => self.single(StatementKind::Continue),
                Keyword::Return => self.returned(),

                _ => self.assignment_or_call(),
            },
            _ => self.assignment_or_call(),
        }
    }

    fn single(&mut self, kind: StatementKind) -> StatementKind {
        self.advance();
        kind
    }

    fn if_statement(&mut self) -> StatementKind {
        let opened = self.span();
        let mut branches = Vec::new();
        let mut otherwise = Vec::new();
        loop {
            self.advance();
            let condition = self.condition(Keyword::Then);
            let body = self.inner_statements();
            branches.push(IfBranch { condition, body });
            if !self.at_keyword(Keyword::Elsif) {
                break;
            }
        }
        let mut nests = None;
        if self.at_keyword(Keyword::Else) {
            let start = self.span();
            self.advance();
            nests = (self.at_keyword(Keyword::If) && !self.is_line_break(0)).then(|| self.span_from(start));
            otherwise = self.inner_statements();
        }
        match nests {
            Some(place) if !self.at_keyword(Keyword::EndIf) => self.report_else_if(place),
            _ => self.expect_end(Keyword::EndIf, opened),
        }
        StatementKind::If(IfStatement { branches, otherwise })
    }

    /// A condition and the keyword behind it; a slip in either does not cost the body.
    fn condition(&mut self, end: Keyword) -> crate::syntax::ast::Expr {
        let known = self.reported();
        let condition = self.expression_or_assignment();
        if !self.at_keyword(end) {
            if self.reported() == known && !self.foreign_step(end) {
                self.unexpected(&format!("`{}`", end.text()));
            }
            if end == Keyword::Of && self.at_case_label() {
                return condition;
            }
            self.skip_until(|kind| match kind {
                TokenKind::Punctuation(Punctuation::Semicolon) => true,
                TokenKind::Keyword(keyword) => keyword == end || closes_list(keyword) || begins_statement(keyword),
                _ => false,
            });
        }
        self.take_keyword(end);
        condition
    }

    /// The end of the statement that began at `opened`.
    fn expect_end(&mut self, end: Keyword, opened: Span) {
        if !self.take_keyword(end) && !self.pass_foreign_end(end) {
            self.unexpected_end(end, opened);
        }
    }

    fn case_statement(&mut self) -> StatementKind {
        let opened = self.span();
        self.advance();
        let selector = self.condition(Keyword::Of);
        let mut branches = Vec::new();
        while self.at_foreign_label()
            || !matches!(self.peek(), None | Some(TokenKind::Keyword(_))) && !self.at_foreign_end()
        {
            self.pass_foreign_label();
            let position = self.position();
            branches.push(self.case_branch());
            if self.position() == position {
                self.advance();
            }
        }
        let otherwise = if self.take_keyword(Keyword::Else) {
            self.pass_colon_of_else();
            self.inner_statements()
        } else {
            Vec::new()
        };
        self.expect_end(Keyword::EndCase, opened);
        StatementKind::Case(CaseStatement { selector, branches, otherwise })
    }

    fn case_branch(&mut self) -> CaseBranch {
        let mut labels = vec![self.case_label()];
        while self.take_mark(Punctuation::Comma) {
            labels.push(self.case_label());
        }
        if !self.expect_mark(Punctuation::Colon) {
            self.skip_until(|kind| {
                matches!(
                    kind,
                    TokenKind::Punctuation(Punctuation::Colon | Punctuation::Semicolon) | TokenKind::Keyword(_)
                )
            });
            self.take_mark(Punctuation::Colon);
        }
        let body = self
            .statements_until(|cursor| cursor.at_foreign_label() || cursor.at_case_label() || cursor.at_foreign_end());
        CaseBranch { labels, body }
    }

    fn case_label(&mut self) -> CaseLabel {
        let low = self.expression();
        let high = self.take_mark(Punctuation::Range).then(|| self.expression());
        CaseLabel { low, high }
    }

    /// A label is distinguished from a statement by the `:` behind it; a statement has `:=`.
    fn at_case_label(&self) -> bool {
        match self.peek() {
            Some(
                TokenKind::Integer
                | TokenKind::Typed
                | TokenKind::Real
                | TokenKind::String
                | TokenKind::WideString
                | TokenKind::Keyword(Keyword::True | Keyword::False)
                | TokenKind::Punctuation(Punctuation::Minus | Punctuation::Plus | Punctuation::LeftParen),
            ) => true,
            Some(TokenKind::Identifier) => self.identifier_is_label(),
            _ => false,
        }
    }

    fn identifier_is_label(&self) -> bool {
        // A constant expression of names and numbers, then `:`, `,` or `..`.
        let mut ahead = 1;
        loop {
            match self.peek_ahead(ahead) {
                Some(TokenKind::Punctuation(Punctuation::Colon | Punctuation::Comma | Punctuation::Range)) => {
                    return true;
                }
                Some(
                    TokenKind::Integer
                    | TokenKind::Identifier
                    | TokenKind::Typed
                    | TokenKind::Punctuation(
                        Punctuation::Plus | Punctuation::Minus | Punctuation::Star | Punctuation::Dot,
                    ),
                ) => ahead += 1,
                _ => return false,
            }
        }
    }

    fn for_statement(&mut self) -> StatementKind {
        let opened = self.span();
        self.advance();
        if self.peek() != Some(TokenKind::Identifier) {
            self.unexpected("the control variable's name");
            return StatementKind::Error;
        }
        let variable = self.postfix();
        if !matches!(variable.kind, ExprKind::Name(_)) {
            self.require(Feature::ControlParts, variable.span);
        }
        self.assign_of_for();
        let from = self.expression();
        let (to, by) = if !self.expect_keyword(Keyword::To) {
            self.skip_until(|kind| match kind {
                TokenKind::Keyword(word) => word != Keyword::Until && (word == Keyword::Do || closes_list(word)),
                kind => kind == TokenKind::Punctuation(Punctuation::Semicolon),
            });
            self.take_keyword(Keyword::Do);
            (from.clone(), None)
        } else if self.for_has_by() {
            let to = self.condition(Keyword::By);
            (to, Some(self.condition(Keyword::Do)))
        } else {
            (self.condition(Keyword::Do), None)
        };
        let body = self.inner_statements();
        self.expect_end(Keyword::EndFor, opened);
        StatementKind::For(Box::new(ForStatement { variable, from, to, by, body }))
    }

    /// The `:=` of a loop's header.
    fn assign_of_for(&mut self) {
        if self.at_mark(Punctuation::Equal) {
            self.report_equal_for_assign();
            self.advance();
            return;
        }
        self.expect_mark(Punctuation::Assign);
        self.take_mark(Punctuation::Equal);
    }

    /// Looks for `BY` before `DO` on the way to the body.
    fn for_has_by(&self) -> bool {
        let mut ahead = 0;
        loop {
            match self.peek_ahead(ahead) {
                Some(TokenKind::Keyword(Keyword::By)) => return true,
                None | Some(TokenKind::Keyword(Keyword::Do) | TokenKind::Punctuation(Punctuation::Semicolon)) => {
                    return false;
                }
                Some(TokenKind::Keyword(word)) if closes_list(word) || begins_statement(word) => {
                    return false;
                }
                _ => ahead += 1,
            }
        }
    }

    fn while_statement(&mut self) -> StatementKind {
        let opened = self.span();
        self.advance();
        let condition = self.condition(Keyword::Do);
        let body = self.inner_statements();
        self.expect_end(Keyword::EndWhile, opened);
        StatementKind::While(WhileStatement { condition, body })
    }

    fn repeat_statement(&mut self) -> StatementKind {
        self.advance();
        let body = self.statements();
        if !self.take_keyword(Keyword::Until) {
            self.unexpected("`UNTIL`");
            return StatementKind::Error;
        }
        let known = self.reported();
        let until = self.condition(Keyword::EndRepeat);
        if self.reported() > known && self.at_mark(Punctuation::Semicolon) {
            // `UNTIL a; END_REPEAT` ends all the same.
            self.advance();
            self.take_keyword(Keyword::EndRepeat);
        }
        StatementKind::Repeat(RepeatStatement { body, until })
    }
}

/// Keywords that end a compound statement.
fn ends_statement(keyword: Keyword) -> bool {
    use Keyword as K;
    matches!(keyword, K::EndIf | K::EndCase | K::EndFor | K::EndWhile | K::EndRepeat)
}
