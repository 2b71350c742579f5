//! Initial values (2nd ed. 2.4.3.2, 3rd ed. 6.5.1.3).

use super::cursor::Cursor;
use crate::dialect::Feature;
use crate::syntax::ast::{
    Expr, ExprKind, Initialiser, InitialiserKind, Literal, ReferenceKind, StructureInit, TypeSpec, TypeSpecKind,
};
use crate::syntax::token::{Punctuation, TokenKind};

impl Cursor<'_> {
    /// `:= value`, if there is one.
    pub(super) fn optional_initialiser(&mut self) -> Option<Initialiser> {
        if !self.take_mark(Punctuation::Assign) {
            return None;
        }
        let start = self.span();
        let first = self.array_element();
        let repeats = matches!(first.kind, InitialiserKind::Repeat(..));
        if !repeats && !self.at_mark(Punctuation::Comma) {
            return Some(first);
        }
        // CODESYS V2.3 lists an array's values without brackets.
        self.require(Feature::BareArrayValues, start);
        let mut elements = vec![first];
        while self.take_mark(Punctuation::Comma) {
            elements.push(self.array_element());
        }
        Some(Initialiser { kind: InitialiserKind::Array(elements), span: self.span_from(start) })
    }

    /// `REF= variable` behind the type of a reference.
    pub(super) fn reference_initialiser(&mut self, spec: &TypeSpec) -> Option<Initialiser> {
        let is_reference = matches!(spec.kind, TypeSpecKind::Reference(ReferenceKind::Reference, _));
        if !is_reference || !self.at_reference_assignment() {
            return None;
        }
        self.advance();
        self.advance();
        let start = self.span();
        let kind = InitialiserKind::Value(self.expression());
        Some(Initialiser { kind, span: self.span_from(start) })
    }

    pub(super) fn initialiser(&mut self) -> Initialiser {
        let start = self.span();
        let kind = self.nested(Self::initialiser_kind);
        let kind = kind.unwrap_or(InitialiserKind::Array(Vec::new()));
        Initialiser { kind, span: self.span_from(start) }
    }

    fn initialiser_kind(&mut self) -> InitialiserKind {
        if self.take_mark(Punctuation::LeftBracket) {
            return self.array_initialiser();
        }
        let structure = self.at_mark(Punctuation::LeftParen)
            && self.peek_ahead(1) == Some(TokenKind::Identifier)
            && self.peek_ahead(2) == Some(TokenKind::Punctuation(Punctuation::Assign));
        if structure {
            self.advance();
            return self.structure_initialiser();
        }
        if self.at_mark(Punctuation::LeftParen)
            && self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::RightParen))
        {
            self.require(Feature::EmptyArguments, self.span());
            self.advance();
            self.advance();
            return InitialiserKind::Struct(Vec::new());
        }
        InitialiserKind::Value(self.expression())
    }

    fn array_initialiser(&mut self) -> InitialiserKind {
        let mut elements = Vec::new();
        while !self.at_mark(Punctuation::RightBracket) {
            elements.push(self.array_element());
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        self.expect_mark(Punctuation::RightBracket);
        InitialiserKind::Array(elements)
    }

    fn array_element(&mut self) -> Initialiser {
        let start = self.span();
        if !self.at_number_of_elements() && !self.at_named_count() {
            return self.initialiser();
        }
        let mut count = Box::new(self.count());
        self.advance();
        let value = match self.peek() {
            Some(TokenKind::Punctuation(Punctuation::RightParen)) => None,
            // `20(5(1))`, as the 3rd edition writes it for two dimensions (6.5.3), is `100(1)`.
            Some(TokenKind::Integer) if self.at_number_of_elements() => {
                let inner = self.nested(Self::array_element);
                match inner.map(|inner| (inner.kind, inner.span)) {
                    Some((InitialiserKind::Repeat(times, value), _)) => {
                        count = Box::new(product(*count, &times));
                        value
                    }
                    other => other.map(|(kind, span)| Box::new(Initialiser { kind, span })),
                }
            }
            _ => Some(Box::new(self.initialiser())),
        };
        self.expect_mark(Punctuation::RightParen);
        Initialiser { kind: InitialiserKind::Repeat(count, value), span: self.span_from(start) }
    }

    /// `5(`
    fn at_number_of_elements(&self) -> bool {
        self.peek() == Some(TokenKind::Integer)
            && self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::LeftParen))
    }

    /// `count((member := ..))`, `List.count([1, 2])`: a constant says how many structures or arrays there are (CODESYS,
    /// TwinCAT). With any other value, it is written as a call.
    fn at_named_count(&self) -> bool {
        let mark = |mark| Some(TokenKind::Punctuation(mark));
        let name = Some(TokenKind::Identifier);
        if self.peek() != name || !self.dialect().has(Feature::NamedCounts) {
            return false;
        }
        let mut at = 1;
        while self.peek_ahead(at) == mark(Punctuation::Dot) && self.peek_ahead(at + 1) == name {
            at += 2;
        }
        let open = self.peek_ahead(at) == mark(Punctuation::LeftParen);
        let structure = self.peek_ahead(at + 1) == mark(Punctuation::LeftParen)
            && self.peek_ahead(at + 2) == name
            && self.peek_ahead(at + 3) == mark(Punctuation::Assign);
        open && (structure || self.peek_ahead(at + 1) == mark(Punctuation::LeftBracket))
    }

    /// What stands before the parenthesis of a count.
    fn count(&mut self) -> Expr {
        let mut count = self.primary();
        while self.take_mark(Punctuation::Dot) {
            let Some(member) = self.member_name() else { break };
            let (span, height) = (count.span.to(member.span), count.height);
            count = self.node(ExprKind::Member(Box::new(count), member), span, height);
        }
        count
    }

    fn structure_initialiser(&mut self) -> InitialiserKind {
        let mut members = Vec::new();
        while let Some(name) = self.expect_identifier("a member's name") {
            self.expect_mark(Punctuation::Assign);
            members.push(StructureInit { name, value: self.initialiser() });
            if !self.take_mark(Punctuation::Comma) {
                break;
            }
        }
        self.expect_mark(Punctuation::RightParen);
        InitialiserKind::Struct(members)
    }
}

/// A count of counts. A product beyond all numbers is as far too great as the greatest.
fn product(outer: Expr, inner: &Expr) -> Expr {
    let (ExprKind::Literal(Literal::Integer(left)), ExprKind::Literal(Literal::Integer(right))) =
        (&outer.kind, &inner.kind)
    else {
        return outer;
    };
    Expr { kind: ExprKind::Literal(Literal::Integer(left.saturating_mul(*right))), ..outer }
}
