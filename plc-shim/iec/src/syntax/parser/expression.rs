//! Expressions, by precedence climbing (2nd ed. 3.3.1, Table 52).

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{
    Argument, BinaryOp, CHAIN_HEIGHT, Call, Expr, ExprKind, Ident, Link, Literal, MAX_HEIGHT, Subrange, UnaryOp,
};
use crate::syntax::literal::{missing_unit, parse_integer, parse_real};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// So many operators in a row are nodes above one another; what is behind them makes a chain.
const ROW_OF_NODES: u32 = 64;

/// Unary operators bind tighter than all with this precedence; in SCL `**` has a greater one.
const UNARY_PRECEDENCE: u8 = 8;

impl Cursor<'_> {
    pub(super) fn expression(&mut self) -> Expr {
        self.binary(0)
    }

    /// An expression or, where vendors take its value, an assignment.
    pub(super) fn expression_or_assignment(&mut self) -> Expr {
        let target = self.expression();
        let at = self.span();
        if !self.at_mark(Punctuation::Assign) || !self.dialect().has(Feature::AssignedValues) {
            return target;
        }
        self.require(Feature::AssignedValues, at);
        self.advance();
        let span = target.span;
        let nested = self.nested(Self::expression_or_assignment);
        let value = nested.unwrap_or_else(|| error_at(at));
        let (span, height) = (span.to(value.span), target.height.max(value.height));
        self.node(ExprKind::Assign(Box::new(target), Box::new(value)), span, height)
    }

    /// An expression that ends before `<` and `>`.
    pub(super) fn operand_of_comparison(&mut self) -> Expr {
        self.binary(BinaryOp::Greater.precedence())
    }

    fn binary(&mut self, minimum: u8) -> Expr {
        let span = self.span();
        self.nested(|cursor| cursor.operator_chain(minimum)).unwrap_or_else(|| error_at(span))
    }

    fn operator_chain(&mut self, minimum: u8) -> Expr {
        let mut left = self.unary();
        // Operators so far, all of which have `left` on their left.
        let mut row = 0;
        while let Some(operator) = self.peek_operator() {
            if operator.precedence() <= minimum {
                break;
            }
            self.require_operator(operator);
            self.advance();
            // All operators of a level are left associative (2nd ed. 3.3.1), `**` included.
            let right = self.binary(operator.precedence());
            row += 1;
            left = self.linked(left, Link { operator, operand: right }, row);
        }
        left
    }

    /// `left` with one operator more. A long row grows in length and not in height, so it may have any number.
    fn linked(&mut self, left: Expr, link: Link, row: u32) -> Expr {
        let span = left.span.to(link.operand.span);
        let height = left.height.max(link.operand.height);
        if row <= ROW_OF_NODES {
            let kind = ExprKind::Binary(link.operator, Box::new(left), Box::new(link.operand));
            return self.node(kind, span, height);
        }
        let below = link.operand.height + (CHAIN_HEIGHT - 1);
        match left.kind {
            ExprKind::Chain(first, mut links) if row > ROW_OF_NODES + 1 => {
                links.push(link);
                let kind = ExprKind::Chain(first, links);
                // Its own levels are counted already.
                if below < left.height {
                    return Expr { kind, span, height: left.height };
                }
                self.node(kind, span, below)
            }
            kind => {
                let below = below.max(left.height + (CHAIN_HEIGHT - 1));
                let first = Expr { kind, ..left };
                self.node(ExprKind::Chain(Box::new(first), vec![link]), span, below)
            }
        }
    }

    fn peek_operator(&self) -> Option<BinaryOp> {
        Some(match self.peek()? {
            TokenKind::Keyword(Keyword::Or) => BinaryOp::Or,
            TokenKind::Keyword(Keyword::Xor) => BinaryOp::Xor,
            TokenKind::Keyword(Keyword::And) => BinaryOp::And,
            TokenKind::Keyword(Keyword::Mod) => BinaryOp::Modulo,
            TokenKind::Identifier => return self.peek_word_operator(),
            TokenKind::Punctuation(mark) => match mark {
                Punctuation::Ampersand => BinaryOp::And,
                Punctuation::Equal => BinaryOp::Equal,
                Punctuation::NotEqual => BinaryOp::NotEqual,
                Punctuation::Less => BinaryOp::Less,
                Punctuation::Greater => BinaryOp::Greater,
                Punctuation::LessEqual => BinaryOp::LessEqual,
                Punctuation::GreaterEqual => BinaryOp::GreaterEqual,
                Punctuation::Plus => BinaryOp::Add,
                Punctuation::Minus => BinaryOp::Subtract,
                Punctuation::Star => BinaryOp::Multiply,
                Punctuation::Slash => BinaryOp::Divide,
                Punctuation::Power => BinaryOp::Power,
                _ => return None,
            },
            _ => return None,
        })
    }

    /// Operators that the standard does not reserve: a name stands nowhere behind an operand.
    fn peek_word_operator(&self) -> Option<BinaryOp> {
        let word = self.next_text().to_ascii_uppercase();
        let next = self.peek_ahead(1);
        Some(match word.as_str() {
            "AND_THEN" => BinaryOp::AndThen,
            "OR_ELSE" => BinaryOp::OrElse,
            // As a name it would be followed by `:=` or the like.
            "DIV" if !matches!(next, Some(TokenKind::Punctuation(Punctuation::Assign))) => BinaryOp::Divide,
            _ => return None,
        })
    }

    /// Reports an operator that the dialect lacks.
    fn require_operator(&mut self, operator: BinaryOp) {
        let span = self.span();
        match operator {
            BinaryOp::AndThen | BinaryOp::OrElse => self.require(Feature::ShortCircuit, span),
            BinaryOp::Power => self.require(Feature::Power, span),
            BinaryOp::Divide if self.peek() == Some(TokenKind::Identifier) => {
                self.require(Feature::DivOperator, span);
            }
            _ => {}
        }
    }

    pub(super) fn unary(&mut self) -> Expr {
        let operator = match self.peek() {
            Some(TokenKind::Punctuation(Punctuation::Minus)) => UnaryOp::Negate,
            Some(TokenKind::Punctuation(Punctuation::Plus)) => UnaryOp::Plus,
            Some(TokenKind::Keyword(Keyword::Not)) => UnaryOp::Not,
            _ => return self.postfix(),
        };
        let start = self.span();
        self.advance();
        let operand = self.unary_operand();
        let (span, height) = (start.to(operand.span), operand.height);
        self.node(ExprKind::Unary(operator, Box::new(operand)), span, height)
    }

    /// Both editions have negation bind tighter than `**` (2nd ed. B.3.1, 3rd ed. Table 71), SCL the other way.
    fn unary_operand(&mut self) -> Expr {
        if self.dialect().negates_powers() {
            return self.binary(UNARY_PRECEDENCE);
        }
        let span = self.span();
        self.nested(Self::unary).unwrap_or_else(|| error_at(span))
    }

    /// A primary with its members, indices and calls.
    pub(super) fn postfix(&mut self) -> Expr {
        let mut expr = self.primary();
        self.pass_object_caret(&mut expr);
        loop {
            let (start, height) = (expr.span, expr.height);
            let (kind, below) = if self.take_mark(Punctuation::Dot) {
                if let Some(part) = self.part_name() {
                    let span = self.span_from(start);
                    expr = self.node(ExprKind::Part(Box::new(expr), part), span, height);
                    continue;
                }
                if let Some(literal) = self.qualified_literal(&expr) {
                    let span = self.span_from(start);
                    return Expr { kind: literal, span, height: 1 };
                }
                let Some(member) = self.member_name() else {
                    return expr;
                };
                (ExprKind::Member(Box::new(expr), member), 0)
            } else if self.take_mark(Punctuation::Caret) {
                (ExprKind::Dereference(Box::new(expr)), 0)
            } else if self.take_mark(Punctuation::LeftBracket) {
                let indices = self.indices();
                let below = indices.iter().map(|index| index.height).max().unwrap_or(0);
                (ExprKind::Index(Box::new(expr), indices), below)
            } else if self.at_mark(Punctuation::LeftParen) && is_callable(&expr) {
                let arguments = self.arguments();
                let below = arguments.iter().map(argument_height).max().unwrap_or(0);
                (ExprKind::Call(Call { callee: Box::new(expr), arguments }), below)
            } else {
                return expr;
            };
            let span = self.span_from(start);
            expr = self.node(kind, span, height.max(below));
        }
    }

    /// What stands behind the point for a part of a bit string: `%X3` or a bit's number.
    fn part_name(&mut self) -> Option<Ident> {
        if !matches!(self.peek(), Some(TokenKind::DirectAddress | TokenKind::Integer)) {
            return None;
        }
        let part = Ident { text: self.next_text().to_owned(), span: self.span() };
        self.advance();
        Some(part)
    }

    pub(super) fn member_name(&mut self) -> Option<Ident> {
        self.expect_identifier("a member's name")
    }

    fn indices(&mut self) -> Vec<Expr> {
        let mut indices = vec![self.expression()];
        while self.take_mark(Punctuation::Comma) {
            indices.push(self.expression());
        }
        self.expect_mark(Punctuation::RightBracket);
        indices
    }

    pub(super) fn arguments(&mut self) -> Vec<Argument> {
        self.advance();
        let mut arguments = Vec::new();
        if self.take_mark(Punctuation::RightParen) {
            return arguments;
        }
        loop {
            arguments.extend(self.given_argument());
            if !self.take_mark(Punctuation::Comma) || self.passes_last_comma() {
                break;
            }
        }
        self.expect_mark(Punctuation::RightParen);
        arguments
    }

    /// True behind a comma with nothing after it: what would stand there is left as it is.
    fn passes_last_comma(&mut self) -> bool {
        self.at_mark(Punctuation::RightParen) && self.dialect().has(Feature::EmptyArguments)
    }

    /// `(a := 1)` or, as an error, `(0..10)`.
    pub(super) fn arguments_or_range(&mut self) -> Result<Vec<Argument>, Subrange> {
        self.advance();
        let mut arguments = Vec::new();
        if self.take_mark(Punctuation::RightParen) {
            return Ok(arguments);
        }
        loop {
            let argument = self.argument();
            if arguments.is_empty()
                && let Argument::Positional(low) = argument
            {
                if self.take_mark(Punctuation::Range) {
                    let high = self.expression();
                    self.expect_mark(Punctuation::RightParen);
                    return Err(Subrange { low, high });
                }
                arguments.push(Argument::Positional(low));
            } else {
                arguments.push(argument);
            }
            if !self.take_mark(Punctuation::Comma) || self.passes_last_comma() {
                break;
            }
        }
        self.expect_mark(Punctuation::RightParen);
        Ok(arguments)
    }

    /// Nothing for `name := ,`, an input that is left as it is.
    fn given_argument(&mut self) -> Option<Argument> {
        use Punctuation::{Assign, Comma, RightParen};
        let behind = |mark| Some(TokenKind::Punctuation(mark));
        let is_empty = self.peek() == Some(TokenKind::Identifier)
            && self.peek_ahead(1) == behind(Assign)
            && [behind(Comma), behind(RightParen)].contains(&self.peek_ahead(2));
        if !is_empty {
            return Some(self.argument());
        }
        self.require(Feature::EmptyArguments, self.span());
        self.advance();
        self.advance();
        None
    }

    pub(super) fn argument(&mut self) -> Argument {
        let negated =
            self.at_keyword(Keyword::Not) && self.peek_ahead(2) == Some(TokenKind::Punctuation(Punctuation::Output));
        let after_name = self.peek_ahead(1 + usize::from(negated));
        match after_name {
            Some(TokenKind::Punctuation(Punctuation::Assign)) => {
                let Some(name) = self.take_identifier() else {
                    return Argument::Positional(self.expression());
                };
                self.advance();
                Argument::Input(name, self.expression())
            }
            Some(TokenKind::Punctuation(Punctuation::Output)) => {
                if negated {
                    self.advance();
                }
                let Some(name) = self.take_identifier() else {
                    return Argument::Positional(self.expression());
                };
                self.advance();
                let absent = self.at_mark(Punctuation::Comma) || self.at_mark(Punctuation::RightParen);
                let target = if absent { None } else { Some(self.expression()) };
                Argument::Output { name, negated, target }
            }
            _ => Argument::Positional(self.expression()),
        }
    }

    pub(super) fn primary(&mut self) -> Expr {
        self.pass_hash();
        let span = self.span();
        if self.at_word("POINTER") && self.peek_ahead(1) == Some(TokenKind::Keyword(Keyword::To)) {
            let spec = self.type_spec();
            return Expr { kind: ExprKind::Type(Box::new(spec)), span: self.span_from(span), height: 1 };
        }
        let text = self.next_text();
        let kind = match self.peek() {
            Some(TokenKind::Identifier) => {
                if let Some(value) = self.constant_named(text, span) {
                    self.advance();
                    return value;
                }
                if let Some(literal) = self.place_of_text(span) {
                    self.advance();
                    return Expr { kind: literal, span: self.span_from(span), height: 1 };
                }
                ExprKind::Name(Self::written_name(text, span))
            }
            Some(TokenKind::Integer) if text.contains("__") && self.dialect().has(Feature::LooseUnderscores) => {
                self.literal(span, parse_integer(&text.replace("__", "_")).map(Literal::Integer))
            }
            Some(TokenKind::Integer) => {
                if text.starts_with("10#") {
                    self.require(Feature::DecimalBase, span);
                }
                self.literal(span, parse_integer(text).map(Literal::Integer))
            }
            Some(TokenKind::Real) => self.literal(span, parse_real(text).map(Literal::Real)),
            Some(TokenKind::Typed) => self.typed_literal(text, span),
            Some(TokenKind::String | TokenKind::WideString) => ExprKind::Literal(Literal::String(text.to_owned())),
            Some(TokenKind::DirectAddress) => ExprKind::DirectAddress(text.to_owned()),
            Some(TokenKind::Keyword(Keyword::True)) => ExprKind::Literal(Literal::Bool(true)),
            Some(TokenKind::Keyword(Keyword::False)) => ExprKind::Literal(Literal::Bool(false)),
            Some(TokenKind::Keyword(keyword)) if self.is_function_form(keyword) => {
                ExprKind::Name(Ident { text: text.to_owned(), span })
            }
            Some(TokenKind::Punctuation(Punctuation::LeftParen)) => return self.parenthesised(),
            Some(TokenKind::Punctuation(Punctuation::Dot)) if self.peek_ahead(1) == Some(TokenKind::Identifier) => {
                self.require(Feature::GlobalOperator, span);
                self.advance();
                let span = span.to(self.span());
                ExprKind::Name(Ident { text: format!(".{}", self.next_text()), span })
            }
            _ => {
                self.unexpected_operand();
                return error_at(Span { end: span.start, ..span });
            }
        };
        self.advance();
        if matches!(kind, ExprKind::Literal(Literal::Integer(_) | Literal::Real(_))) && self.pass_unit(span) {
            return error_at(span);
        }
        if matches!(kind, ExprKind::Literal(Literal::String(_))) {
            self.pass_doubled_quote();
        }
        Expr { kind, span, height: 1 }
    }

    /// Reports the letters of `10ms`, a number with a unit.
    fn pass_unit(&mut self, number: Span) -> bool {
        let unit = self.span();
        if unit.start != number.end || self.peek() != Some(TokenKind::Identifier) {
            return false;
        }
        let message = format!("`{}` is not a number", self.text(number.start, unit.end));
        let help = format!("a duration is written `T#{}`", self.text(number.start, unit.end));
        let times = ["d", "h", "m", "s", "ms", "us", "ns"];
        let is_time = times.iter().any(|name| self.at_word(name));
        let help = is_time.then_some(help).or_else(|| self.hexadecimal(number));
        let found = Diagnostic::error(Code::InvalidLiteral, number.to(unit), message);
        self.report(found.with_optional_help(help));
        self.advance();
        true
    }

    /// How the number of `0xFF`, whose letters stand here, is written.
    fn hexadecimal(&self, number: Span) -> Option<String> {
        let digits =
            self.next_text().strip_prefix(['x', 'X']).filter(|_| self.text(number.start, number.end) == "0")?;
        let is_number = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        is_number.then(|| format!("a hexadecimal number is written `16#{digits}`"))
    }

    /// Reports what is not an operand, with a hint for what other languages write.
    fn unexpected_operand(&mut self) {
        let Some(help) = self.meant_operand() else { return self.unexpected("an expression") };
        let found = format!("an expression expected, found `{}`", self.next_text());
        let span = self.span();
        self.report_syntax(Diagnostic::error(Code::UnexpectedToken, span, found).with_help(help));
    }

    /// `AND(a, b)`: operators are functions too (2nd ed. Table 26).
    fn is_function_form(&self, keyword: Keyword) -> bool {
        matches!(keyword, Keyword::And | Keyword::Or | Keyword::Xor | Keyword::Mod)
            && self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::LeftParen))
    }

    pub(super) fn literal(&mut self, span: Span, value: Result<Literal, String>) -> ExprKind {
        match value {
            Ok(literal) => ExprKind::Literal(literal),
            Err(message) => {
                let help = missing_unit(self.text(span.start, span.end));
                let found = Diagnostic::error(Code::InvalidLiteral, span, message);
                self.report(found.with_optional_help(help));
                ExprKind::Error
            }
        }
    }

    pub(super) fn parenthesised(&mut self) -> Expr {
        let start = self.span();
        self.advance();
        let inner = self.expression_or_assignment();
        self.expect_mark(Punctuation::RightParen);
        let (span, height) = (self.span_from(start), inner.height);
        self.node(ExprKind::Paren(Box::new(inner)), span, height)
    }

    /// A node above others of `height`; one that is too high becomes an error, so that no tree
    /// ever is.
    pub(super) fn node(&mut self, kind: ExprKind, span: Span, height: u16) -> Expr {
        if height >= MAX_HEIGHT {
            let message = format!("expression is nested or chained beyond {MAX_HEIGHT} levels");
            let help = "assign parts of it to variables first";
            self.report_too_high(Diagnostic::error(Code::NestingTooDeep, span, message).with_help(help));
            return error_at(span);
        }
        Expr { kind, span, height: height + 1 }
    }
}

pub(super) fn error_at(span: Span) -> Expr {
    Expr { kind: ExprKind::Error, span, height: 1 }
}

fn is_callable(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Name(_) | ExprKind::Member(..) | ExprKind::Index(..) | ExprKind::Dereference(_))
}

fn argument_height(argument: &Argument) -> u16 {
    match argument {
        Argument::Positional(expr) | Argument::Input(_, expr) => expr.height,
        Argument::Output { target, .. } => target.as_ref().map_or(0, |expr| expr.height),
    }
}
