//! Steps and transitions of a Sequential Function Chart (2nd ed. 2.6 and B.1.6, 3rd ed. 6.7).

use super::cursor::Cursor;
use super::declaration::ends_unit;
use super::expression::error_at;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::syntax::ast::{
    ActionQualifier, Association, Chart, ChartStep, Ident, Priority, Transition, TransitionCondition,
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// Keywords that no recovery inside of a step or transition passes.
fn ends_chart_part(kind: TokenKind) -> bool {
    let TokenKind::Keyword(keyword) = kind else { return false };
    matches!(keyword, Keyword::EndStep | Keyword::EndTransition) || keyword.is_of_chart() || ends_unit(kind)
}

impl Cursor<'_> {
    /// Takes a step or transition, if one begins here.
    pub(super) fn chart_part(&mut self, chart: &mut Chart) -> bool {
        match self.peek() {
            Some(TokenKind::Keyword(Keyword::InitialStep)) => self.step(true, chart),
            Some(TokenKind::Keyword(Keyword::Step)) => self.step(false, chart),
            Some(TokenKind::Keyword(Keyword::Transition)) => self.transition(chart),
            _ => return false,
        }
        self.take_semicolons();
        true
    }

    /// `STEP name: action(N); END_STEP`
    fn step(&mut self, is_initial: bool, chart: &mut Chart) {
        let start = self.span();
        self.advance();
        let Some(name) = self.expect_identifier("the step's name") else {
            return self.end_of_part(Keyword::EndStep);
        };
        self.expect_mark(Punctuation::Colon);
        let mut associations = Vec::new();
        while self.peek() == Some(TokenKind::Identifier) {
            let known = self.reported();
            associations.extend(self.association());
            if self.reported() == known && self.take_mark(Punctuation::Semicolon) {
                continue;
            }
            if self.reported() == known {
                self.unexpected("`;`");
            }
            self.skip_until(|kind| kind == TokenKind::Punctuation(Punctuation::Semicolon) || ends_chart_part(kind));
            self.take_mark(Punctuation::Semicolon);
        }
        self.end_of_part(Keyword::EndStep);
        chart.steps.push(ChartStep { is_initial, name, associations, span: self.span_from(start) });
    }

    /// The keyword that ends a step or transition; what stands before it is skipped.
    fn end_of_part(&mut self, end: Keyword) {
        if !self.take_keyword(end) {
            self.unexpected(&format!("`{}`", end.text()));
            self.skip_until(ends_chart_part);
            self.take_keyword(end);
        }
    }

    /// `action(D, T#5s, Done)`
    fn association(&mut self) -> Option<Association> {
        let start = self.span();
        let action = self.take_identifier()?;
        let mut found = Association { action, qualifier: None, time: None, indicators: Vec::new(), span: start };
        if self.expect_mark(Punctuation::LeftParen) {
            if self.peek() == Some(TokenKind::Identifier) {
                found.qualifier = self.action_qualifier();
            }
            while self.take_mark(Punctuation::Comma) {
                self.time_or_indicator(&mut found);
            }
            self.expect_mark(Punctuation::RightParen);
        }
        found.span = self.span_from(start);
        Some(found)
    }

    fn action_qualifier(&mut self) -> Option<ActionQualifier> {
        let (text, span) = (self.next_text(), self.span());
        self.advance();
        let found = ActionQualifier::find(text);
        if found.is_none() {
            let known = ActionQualifier::ALL.map(ActionQualifier::text);
            let list = format!("one of {}", known.join(", "));
            let help = did_you_mean(text, known).unwrap_or(list);
            let message = format!("`{text}` is not an action qualifier");
            self.report(Diagnostic::error(Code::UnknownQualifier, span, message).with_help(help));
        }
        found
    }

    /// The first of them is the time where the qualifier has one, and where it looks like one.
    fn time_or_indicator(&mut self, association: &mut Association) {
        let timed = association.effective_qualifier().is_timed() || self.peek() != Some(TokenKind::Identifier);
        let value = self.expression();
        if timed && association.time.is_none() && association.indicators.is_empty() {
            association.time = Some(value);
        } else {
            association.indicators.push(value);
        }
    }

    /// `TRANSITION name (PRIORITY := 1) FROM a TO (b, c) := x; END_TRANSITION`
    fn transition(&mut self, chart: &mut Chart) {
        let (start, known) = (self.span(), self.reported());
        self.advance();
        let mut name = if self.at_word("FROM") { None } else { self.take_identifier() };
        let priority = self.at_mark(Punctuation::LeftParen).then(|| self.priority()).flatten();
        let from = if self.take_word("FROM") {
            self.step_names()
        } else {
            self.unexpected("`FROM`");
            // What was taken for the transition's name is the step's.
            name.take().into_iter().collect()
        };
        self.expect_keyword(Keyword::To);
        let to = self.step_names();
        let lost = !self.at_mark(Punctuation::Assign) && !self.at_mark(Punctuation::Colon);
        let condition = if self.reported() > known && lost {
            let nothing = error_at(self.span());
            self.skip_until(ends_chart_part);
            TransitionCondition::Expression(nothing)
        } else {
            self.transition_condition()
        };
        self.end_of_part(Keyword::EndTransition);
        chart.transitions.push(Transition { name, priority, from, to, condition, span: self.span_from(start) });
    }

    /// `(PRIORITY := 1)`
    fn priority(&mut self) -> Option<Priority> {
        self.advance();
        if !self.take_word("PRIORITY") {
            self.unexpected("`PRIORITY`");
            return None;
        }
        self.expect_mark(Punctuation::Assign);
        let span = self.span();
        let rank = self.next_text().replace('_', "").parse().ok().filter(|_| self.peek() == Some(TokenKind::Integer));
        if rank.is_some() {
            self.advance();
        } else {
            self.unexpected("a number that is not negative");
            self.skip_until(|kind| kind == TokenKind::Punctuation(Punctuation::RightParen) || ends_chart_part(kind));
        }
        self.expect_mark(Punctuation::RightParen);
        rank.map(|rank| Priority { rank, span })
    }

    /// `a` or `(a, b)`
    fn step_names(&mut self) -> Vec<Ident> {
        if !self.take_mark(Punctuation::LeftParen) {
            return self.expect_identifier("a step's name").into_iter().collect();
        }
        let names = self.identifier_list("a step's name");
        self.expect_mark(Punctuation::RightParen);
        names
    }

    fn transition_condition(&mut self) -> TransitionCondition {
        if self.take_mark(Punctuation::Colon) {
            return TransitionCondition::Network(self.body_statements());
        }
        self.expect_mark(Punctuation::Assign);
        let known = self.reported();
        let condition = self.expression();
        if self.reported() > known {
            self.skip_until(|kind| kind == TokenKind::Punctuation(Punctuation::Semicolon) || ends_chart_part(kind));
        }
        // The standard wants the semicolon; several tools leave it out.
        self.take_mark(Punctuation::Semicolon);
        TransitionCondition::Expression(condition)
    }
}
