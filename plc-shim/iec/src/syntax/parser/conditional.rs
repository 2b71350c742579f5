//! Pragmas that leave out parts of a text: `{IF defined (x)} .. {ELSE} .. {END_IF}` (CODESYS, TwinCAT).
//!
//! Names are defined by `{define x}` before in the file. What a condition asks of the project is not
//! known here, so it is reported.

use std::collections::BTreeSet;

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::pragma::sets_by_c;
use crate::syntax::token::{Token, TokenKind};

/// One `{IF}` that has not ended.
struct Level {
    opened: Span,
    /// The surrounding text counts.
    outer: bool,
    /// One of its branches has counted.
    taken: bool,
    /// The branch that is being read counts.
    active: bool,
}

struct Conditions<'c, 'a> {
    cursor: &'c mut Cursor<'a>,
    levels: Vec<Level>,
    defined: BTreeSet<String>,
}

/// Leaves out of the cursor's tokens what conditional pragmas leave out of the text.
pub(super) fn apply(cursor: &mut Cursor<'_>, tokens: &[Token]) {
    if !tokens.iter().any(|token| token.kind == TokenKind::Pragma) {
        return;
    }
    let mut conditions = Conditions { cursor, levels: Vec::new(), defined: BTreeSet::new() };
    let mut left_out = BTreeSet::new();
    for token in tokens {
        if token.kind == TokenKind::Pragma {
            conditions.pragma(*token);
        } else if !conditions.counts() {
            left_out.insert(token.start);
        }
    }
    if let Some(level) = conditions.levels.pop() {
        let message = "`{IF}` without `{END_IF}`";
        conditions.cursor.report(Diagnostic::error(Code::UnbalancedPragma, level.opened, message));
    }
    if !left_out.is_empty() {
        cursor.keep(|token| !left_out.contains(&token.start));
    }
}

impl Conditions<'_, '_> {
    fn counts(&self) -> bool {
        self.levels.last().is_none_or(|level| level.active)
    }

    fn pragma(&mut self, token: Token) {
        let span = Span::new(self.cursor.file(), token.start, token.end);
        let text = self.cursor.text(token.start, token.end);
        // C code of MatIEC has conditions of its own.
        if text.starts_with("{{") || sets_by_c(text) {
            return;
        }
        let text = text.trim_matches(['{', '}']).trim();
        let (word, rest) = text.split_once(|one: char| one.is_whitespace() || one == '(').unwrap_or((text, ""));
        let rest_with_mark = text.get(word.len()..).unwrap_or(rest);
        match word.to_ascii_uppercase().as_str() {
            "DEFINE" if self.counts() => {
                self.defined.insert(first_word(rest).to_ascii_uppercase());
            }
            "UNDEFINE" if self.counts() => {
                self.defined.remove(&first_word(rest).to_ascii_uppercase());
            }
            "IF" => {
                self.cursor.require(Feature::ConditionalPragmas, span);
                let outer = self.counts();
                let active = outer && self.condition(rest_with_mark, span);
                self.levels.push(Level { opened: span, outer, taken: active, active });
            }
            "ELSIF" => {
                let open = self.levels.last().map(|level| level.outer && !level.taken);
                let holds = open == Some(true) && self.condition(rest_with_mark, span);
                self.branch(holds, span);
            }
            "ELSE" => self.branch(true, span),
            "END_IF" if self.levels.pop().is_none() => self.unbalanced(span),
            _ => {}
        }
    }

    fn branch(&mut self, holds: bool, span: Span) {
        let Some(level) = self.levels.last_mut() else {
            return self.unbalanced(span);
        };
        level.active = level.outer && !level.taken && holds;
        level.taken |= level.active;
    }

    fn unbalanced(&mut self, span: Span) {
        let message = "there is no `{IF}` that this belongs to";
        self.cursor.report(Diagnostic::error(Code::UnbalancedPragma, span, message));
    }

    fn condition(&mut self, text: &str, span: Span) -> bool {
        let mut condition = Condition { rest: text, defined: &self.defined, depth: 0 };
        let value = condition.or();
        if let Some(value) = value
            && condition.rest.trim().is_empty()
        {
            return value;
        }
        let message = "this condition is not evaluated; its branch is left out";
        let found = Diagnostic::error(Code::UnknownCondition, span, message);
        self.cursor.report(found.with_help("`defined (name)` is, with NOT, AND, OR and `{define name}` before"));
        false
    }
}

fn first_word(text: &str) -> &str {
    text.split_whitespace().next().unwrap_or("")
}

/// A condition while it is read. Nothing stands for what is not understood.
struct Condition<'a> {
    rest: &'a str,
    defined: &'a BTreeSet<String>,
    depth: u32,
}

impl Condition<'_> {
    fn or(&mut self) -> Option<bool> {
        let mut value = self.and()?;
        while self.take_word("OR") {
            value |= self.and()?;
        }
        Some(value)
    }

    fn and(&mut self) -> Option<bool> {
        let mut value = self.not()?;
        while self.take_word("AND") {
            value &= self.not()?;
        }
        Some(value)
    }

    fn not(&mut self) -> Option<bool> {
        let mut value = true;
        while self.take_word("NOT") {
            value = !value;
        }
        Some(self.operand()? == value)
    }

    fn operand(&mut self) -> Option<bool> {
        if self.take_mark('(') {
            self.depth += 1;
            let value = if self.depth < 32 { self.or()? } else { return None };
            self.depth -= 1;
            return self.take_mark(')').then_some(value);
        }
        if !self.take_word("DEFINED") || !self.take_mark('(') {
            return None;
        }
        let (name, rest) = self.rest.split_once(')')?;
        self.rest = rest;
        let name = name.trim();
        // `defined (variable: g.x)` and the like ask the project.
        let plain = !name.is_empty() && name.chars().all(|one| one.is_alphanumeric() || one == '_');
        plain.then(|| self.defined.contains(&name.to_ascii_uppercase()))
    }

    fn take_word(&mut self, word: &str) -> bool {
        let rest = self.rest.trim_start();
        let end = rest.find(|one: char| !one.is_alphanumeric() && one != '_').unwrap_or(rest.len());
        let (first, behind) = rest.split_at(end);
        let found = first.eq_ignore_ascii_case(word);
        if found {
            self.rest = behind;
        }
        found
    }

    fn take_mark(&mut self, mark: char) -> bool {
        let behind = self.rest.trim_start().strip_prefix(mark);
        if let Some(behind) = behind {
            self.rest = behind;
        }
        behind.is_some()
    }
}
