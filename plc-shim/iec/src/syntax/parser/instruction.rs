//! Instruction List (2nd ed. 3.2, 3rd ed. 7.2): a body is one if its first instruction is.
//!
//! Line ends count here and nowhere else: an instruction ends with its line, unless parentheses are open.

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{
    Argument, BinaryOp, Call, Expr, ExprKind, Ident, Instruction, ListCall, Statement, StatementKind, When,
    instruction::{INPUTS, OPERATORS},
};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

/// An operator as written, without its modifiers.
enum Word {
    Load(bool),
    Store(bool),
    Set,
    Reset,
    Operate(BinaryOp, bool),
    Not,
    Jump(When),
    Call(When),
    Return(When),
    Input,
}

/// `JMP`, `JMPC`, `JMPCN`
fn when(word: &str, operator: &str) -> Option<When> {
    match word.strip_prefix(operator)? {
        "" => Some(When::Always),
        "C" => Some(When::True),
        "CN" => Some(When::False),
        _ => None,
    }
}

fn word(text: &str) -> Option<Word> {
    let text = text.to_ascii_uppercase();
    match text.as_str() {
        "LD" | "LDN" => return Some(Word::Load(text.ends_with('N'))),
        "ST" | "STN" => return Some(Word::Store(text.ends_with('N'))),
        "S" => return Some(Word::Set),
        "R" => return Some(Word::Reset),
        "NOT" => return Some(Word::Not),
        _ => {}
    }
    let jump = || when(&text, "JMP").map(Word::Jump);
    let call = || when(&text, "CAL").map(Word::Call);
    let leave = || when(&text, "RET").map(Word::Return);
    let operator = || {
        let plain =
            OPERATORS.iter().find(|(name, _)| *name == text).map(|(_, operator)| Word::Operate(*operator, false));
        plain.or_else(|| {
            let base = text.strip_suffix('N').filter(|base| ["AND", "&", "OR", "XOR"].contains(base))?;
            OPERATORS.iter().find(|(name, _)| *name == base).map(|(_, operator)| Word::Operate(*operator, true))
        })
    };
    let input = || INPUTS.contains(&text.as_str()).then_some(Word::Input);
    jump().or_else(call).or_else(leave).or_else(operator).or_else(input)
}

impl Cursor<'_> {
    /// True if the body that begins here is a list of instructions.
    pub(super) fn at_instruction_list(&self) -> bool {
        let mut ahead = 0;
        while self.peek_ahead(ahead) == Some(TokenKind::Identifier)
            && self.peek_ahead(ahead + 1) == Some(TokenKind::Punctuation(Punctuation::Colon))
        {
            ahead += 2;
        }
        let labelled = ahead > 0;
        if self.peek_ahead(ahead) != Some(TokenKind::Identifier) {
            return false;
        }
        let found = word(self.text_ahead(ahead));
        let alone = self.is_line_break(ahead + 1);
        match (found, self.peek_ahead(ahead + 1)) {
            (Some(Word::Return(_)), _) => alone && labelled,
            (Some(Word::Jump(_)), Some(TokenKind::Identifier)) => {
                self.peek_ahead(ahead + 2) != Some(TokenKind::Punctuation(Punctuation::Semicolon))
            }
            // `r REF= x`, `in S= x` and `st ?= x` are statements on variables of these names.
            (Some(_), Some(TokenKind::Identifier)) if self.is_statement_mark(ahead + 2) => false,
            (Some(_), Some(TokenKind::Punctuation(mark))) => {
                !alone && matches!(mark, Punctuation::Minus | Punctuation::Plus)
            }
            (Some(_), Some(_)) => !alone,
            (None, Some(TokenKind::Punctuation(Punctuation::LeftParen))) => self.is_formal_call(ahead + 1),
            _ => false,
        }
    }

    /// True for a mark that an operand of an instruction never has behind it.
    fn is_statement_mark(&self, ahead: usize) -> bool {
        use Punctuation::{Assign, Equal};
        let Some(TokenKind::Punctuation(mark)) = self.peek_ahead(ahead) else { return false };
        matches!(mark, Assign | Equal) && !self.is_line_break(ahead)
    }

    /// True if behind the parentheses that open there no `;` follows and another instruction does.
    fn is_formal_call(&self, open: usize) -> bool {
        let mut depth = 0_u32;
        let mut ahead = open;
        loop {
            match self.peek_ahead(ahead) {
                Some(TokenKind::Punctuation(Punctuation::LeftParen)) => depth += 1,
                Some(TokenKind::Punctuation(Punctuation::RightParen)) => depth -= 1,
                None | Some(TokenKind::Punctuation(Punctuation::Semicolon)) => return false,
                _ => {}
            }
            ahead += 1;
            if depth == 0 {
                break;
            }
        }
        let next = self.peek_ahead(ahead) == Some(TokenKind::Identifier);
        next && self.is_line_break(ahead) && word(self.text_ahead(ahead)).is_some()
    }

    /// The instructions of a body, or up to the `)` that ends those between parentheses.
    pub(super) fn instructions(&mut self) -> Vec<Statement> {
        let mut list = Vec::new();
        loop {
            while self.take_mark(Punctuation::Semicolon) {}
            match self.peek() {
                None | Some(TokenKind::Punctuation(Punctuation::RightParen)) => return list,
                Some(TokenKind::Keyword(keyword))
                    if !matches!(keyword, Keyword::Return) && word(keyword.text()).is_none() =>
                {
                    return list;
                }
                _ => list.push(self.instruction()),
            }
        }
    }

    fn instruction(&mut self) -> Statement {
        let start = self.span();
        let colon = self.peek_ahead(1) == Some(TokenKind::Punctuation(Punctuation::Colon));
        if colon && let Some(name) = self.take_identifier() {
            self.advance();
            return Statement { kind: StatementKind::Label(name), span: self.span_from(start) };
        }
        let known = self.reported();
        let kind = self.nested(Self::instruction_kind).flatten();
        if kind.is_none() && self.reported() == known {
            self.bad_instruction(start);
        }
        if self.reported() > known || !self.at_line_end() {
            if self.reported() == known {
                self.unexpected("the end of the line");
            }
            self.skip_line();
        }
        // What is not an instruction may end its own line: it is passed over all the same.
        if self.peek().is_some() && self.span() == start {
            self.advance();
        }
        let kind = kind.map_or(StatementKind::Error, |kind| StatementKind::Instruction(Box::new(kind)));
        Statement { kind, span: self.span_from(start) }
    }

    fn bad_instruction(&mut self, start: crate::syntax::Span) {
        let text = self.text(start.start, start.end);
        let message = if word(text).is_some() {
            format!("`{text}` lacks its operand")
        } else {
            format!("`{text}` is not an instruction")
        };
        self.report_syntax(Diagnostic::error(Code::UnknownInstruction, start, message));
    }

    /// Goes on with the next line.
    fn skip_line(&mut self) {
        let depth = self.peek().is_some();
        while depth && !self.at_line_end() {
            self.advance();
        }
    }

    fn at_line_end(&self) -> bool {
        let ends = |kind| matches!(kind, TokenKind::Punctuation(Punctuation::RightParen | Punctuation::Semicolon));
        self.is_line_break(0) || self.peek().is_none_or(ends)
    }

    fn instruction_kind(&mut self) -> Option<Instruction> {
        let text = self.next_text();
        let Some(word) = word(text) else { return self.function_instruction() };
        self.advance();
        // `&N`
        let suffixed = text == "&" && !self.at_line_end() && self.at_word("N");
        if suffixed {
            self.advance();
        }
        Some(match word {
            Word::Load(negated) => Instruction::Load { negated, value: self.operand()? },
            Word::Store(negated) => Instruction::Store { negated, target: self.operand()? },
            Word::Set => Instruction::Set(self.operand()?),
            Word::Reset => Instruction::Reset(self.operand()?),
            Word::Not => Instruction::Not,
            Word::Jump(when) => Instruction::Jump(when, self.label_operand()?),
            Word::Return(when) => Instruction::Return(when),
            Word::Call(when) => Instruction::Call(when, self.instance_call()?),
            Word::Input => {
                let span = self.previous_span();
                Instruction::Input(Ident { text: text.to_owned(), span }, self.operand()?)
            }
            Word::Operate(operator, negated) => {
                let negated = negated || suffixed;
                if self.take_mark(Punctuation::LeftParen) {
                    return self.deferred(operator, negated);
                }
                Instruction::Operate { operator, negated, operands: self.operands()? }
            }
        })
    }

    fn operand(&mut self) -> Option<Expr> {
        if self.at_line_end() {
            return None;
        }
        let known = self.reported();
        let operand = self.unary();
        (self.reported() == known).then_some(operand)
    }

    fn operands(&mut self) -> Option<Vec<Expr>> {
        let mut operands = vec![self.operand()?];
        while self.take_mark(Punctuation::Comma) {
            operands.push(self.operand()?);
        }
        Some(operands)
    }

    fn label_operand(&mut self) -> Option<Ident> {
        if self.at_line_end() { None } else { self.expect_identifier("a label") }
    }

    /// What is between `AND(` and `)`.
    fn deferred(&mut self, operator: BinaryOp, negated: bool) -> Option<Instruction> {
        let mut list = Vec::new();
        if !self.at_line_end() {
            let start = self.span();
            let value = self.operand()?;
            let kind = StatementKind::Instruction(Box::new(Instruction::Load { negated: false, value }));
            list.push(Statement { kind, span: self.span_from(start) });
        }
        list.extend(self.instructions());
        if !self.take_mark(Punctuation::RightParen) {
            self.unexpected("`)`");
        }
        Some(Instruction::Deferred { operator, negated, list })
    }

    /// `CAL fb`, `CAL fb(IN := x)`
    fn instance_call(&mut self) -> Option<ListCall> {
        let callee = self.operand_without_call()?;
        let mut call = ListCall {
            call: Call { callee: Box::new(callee), arguments: Vec::new() },
            takes_result: false,
            lists: Vec::new(),
        };
        if self.take_mark(Punctuation::LeftParen) {
            self.formal_arguments(&mut call);
        }
        Some(call)
    }

    /// `LIMIT(MN := 0, IN := x, MX := 10)`, `LIMIT 0, 10`, `ABS`
    fn function_instruction(&mut self) -> Option<Instruction> {
        let name = self.take_identifier()?;
        let span = name.span;
        let callee = Box::new(Expr { kind: ExprKind::Name(name), span, height: 1 });
        let mut call = ListCall { call: Call { callee, arguments: Vec::new() }, takes_result: true, lists: Vec::new() };
        if self.take_mark(Punctuation::LeftParen) {
            call.takes_result = false;
            self.formal_arguments(&mut call);
        } else if !self.at_line_end() {
            call.call.arguments = self.operands()?.into_iter().map(Argument::Positional).collect();
        }
        Some(Instruction::Function(call))
    }

    /// The rest of a list of arguments, over as many lines as it takes.
    fn formal_arguments(&mut self, call: &mut ListCall) {
        while !self.take_mark(Punctuation::RightParen) {
            if self.at_list_argument() {
                let name = self.take_identifier();
                self.advance();
                self.advance();
                let list = self.nested(Self::instructions).unwrap_or_default();
                self.expect_mark(Punctuation::RightParen);
                call.lists.extend(name.map(|name| (name, list)));
            } else {
                call.call.arguments.push(self.argument());
            }
            if !self.take_mark(Punctuation::Comma) && !self.at_mark(Punctuation::RightParen) {
                return self.unexpected("`)`");
            }
        }
    }

    /// `IN := ( LD a ..`
    fn at_list_argument(&self) -> bool {
        let mark = |ahead, mark| self.peek_ahead(ahead) == Some(TokenKind::Punctuation(mark));
        mark(1, Punctuation::Assign)
            && mark(2, Punctuation::LeftParen)
            && self.peek_ahead(3) == Some(TokenKind::Identifier)
            && word(self.text_ahead(3)).is_some()
            && !matches!(self.peek_ahead(4), Some(TokenKind::Punctuation(mark)) if !matches!(mark, Punctuation::Minus | Punctuation::Plus))
    }

    /// A name with members and indices.
    fn operand_without_call(&mut self) -> Option<Expr> {
        if self.at_line_end() {
            return None;
        }
        let name = self.expect_identifier("an instance")?;
        let span = name.span;
        let mut expr = Expr { kind: ExprKind::Name(name), span, height: 1 };
        loop {
            if self.take_mark(Punctuation::Dot) {
                let member = self.expect_identifier("a member's name")?;
                let height = expr.height.saturating_add(1);
                expr = Expr { kind: ExprKind::Member(Box::new(expr), member), span: self.span_from(span), height };
            } else if self.take_mark(Punctuation::LeftBracket) {
                let index = self.expression();
                self.expect_mark(Punctuation::RightBracket);
                let height = expr.height.max(index.height).saturating_add(1);
                expr = Expr { kind: ExprKind::Index(Box::new(expr), vec![index]), span: self.span_from(span), height };
            } else {
                return Some(expr);
            }
        }
    }
}
