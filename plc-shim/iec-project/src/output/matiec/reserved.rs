//! Variables with names that MatIEC keeps for itself: its standard functions and function blocks, and words of the
//! language that other tools take for names. Each gets another name wherever it stands.

use std::collections::{BTreeMap, BTreeSet};

use super::{Finding, Page};
use onescan_iec::ir::ElementaryType;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Declaration, Ident, TypeSpec, TypeSpecKind};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Keyword, Punctuation, Token, TokenKind};

/// What can be called in MatIEC's library; only variables must not have these names, not members of structures.
const LIBRARY: &str = "ABS SQRT LN LOG EXP SIN COS TAN ASIN ACOS ATAN ADD MUL SUB DIV EXPT MOVE SHL SHR ROR ROL SEL MAX \
    MIN LIMIT MUX GT GE EQ LE LT NE LEN LEFT RIGHT MID CONCAT INSERT DELETE REPLACE FIND TRUNC ADD_TIME SUB_TIME \
    ADD_TOD_TIME ADD_DT_TIME SUB_DATE_DATE SUB_TOD_TIME SUB_TOD_TOD SUB_DT_TIME SUB_DT_DT MULTIME DIVTIME \
    CONCAT_DATE_TOD TON TOF TP CTU CTD CTUD CTU_DINT CTU_LINT CTU_UDINT CTU_ULINT CTD_DINT CTD_LINT CTD_UDINT \
    CTD_ULINT CTUD_DINT CTUD_LINT CTUD_UDINT CTUD_ULINT SR RS SEMA RTC R_TRIG F_TRIG INTEGRAL DERIVATIVE PID RAMP \
    HYSTERESIS";

/// Words that MatIEC reads as such wherever they stand.
const WORDS: &str = "TIME DATE TOD DT TIME_OF_DAY DATE_AND_TIME TASK WITH ON FROM BY AT ACTION STEP TRANSITION RESOURCE \
    PROGRAM CONFIGURATION READ_ONLY READ_WRITE REF REF_TO DREF NULL";

fn is_word(key: &str) -> bool {
    WORDS.split_whitespace().any(|word| word == key)
}

fn is_of_library(key: &str) -> bool {
    let is_type = |name: &str| ElementaryType::find(name).is_some();
    let is_conversion = key.split_once("_TO_").is_some_and(|(from, to)| is_type(from) && is_type(to));
    is_conversion || LIBRARY.split_whitespace().any(|name| name == key)
}

/// Gives other names to variables, inputs, outputs and members that have such a one.
pub(super) fn rename(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let tokens: Vec<Token> = tokenize_in(page.file.dialect(), page.file.text())
        .into_iter()
        .filter(|token| !token.kind.is_trivia())
        .collect();
    let mut renamed = Renamed { page, edits, names: BTreeMap::new(), findings: Vec::new() };
    renamed.collect(&tokens);
    if !renamed.names.is_empty() {
        for at in 0..tokens.len() {
            renamed.token(&tokens, at);
        }
    }
    renamed.findings
}

struct Renamed<'w, 'a> {
    page: &'w Page<'a>,
    edits: &'w mut Edits,
    /// The new name of each, by the old one in capitals.
    names: BTreeMap<String, String>,
    findings: Vec<Finding>,
}

impl Renamed<'_, '_> {
    fn collect(&mut self, tokens: &[Token]) {
        let mut found: Vec<&Ident> = Vec::new();
        for (pou, section) in self.page.sections() {
            let names = section.variables.iter().flat_map(|variable| &variable.names);
            let taken = names.filter(|name| is_word(&name.key()) || is_of_library(&name.key()));
            match pou {
                Some(_) => found.extend(taken),
                None => self.findings.extend(taken.map(|name| {
                    let what = format!("a global variable of the name `{}`", name.text);
                    Finding::new(name.span, &what, "give it another name: MatIEC keeps this one")
                })),
            }
            section.variables.iter().for_each(|variable| members(&variable.spec, &mut found));
        }
        for declaration in &self.page.unit.declarations {
            if let Declaration::Type(named) = declaration {
                members(&named.spec, &mut found);
            }
        }
        let written: BTreeSet<String> = tokens.iter().map(|token| self.key(token)).collect();
        for name in found {
            let mut new = format!("{}_v", name.text);
            let mut number = 1;
            while written.contains(&new.to_ascii_uppercase()) {
                number += 1;
                new = format!("{}_v{number}", name.text);
            }
            self.names.entry(name.key()).or_insert(new);
        }
    }

    fn key(&self, token: &Token) -> String {
        let text = self.page.file.text().get(token.start as usize..token.end as usize).unwrap_or("");
        text.to_ascii_uppercase()
    }

    fn token(&mut self, tokens: &[Token], at: usize) {
        let Some(token) = tokens.get(at).filter(|token| is_name(token.kind)) else { return };
        let key = self.key(token);
        let Some(new) = self.names.get(&key) else { return };
        let before = at.checked_sub(1).and_then(|before| tokens.get(before)).map(|token| token.kind);
        let behind = tokens.get(at + 1).map(|token| token.kind);
        let is_called = behind == Some(TokenKind::Punctuation(Punctuation::LeftParen));
        let is_member = before == Some(TokenKind::Punctuation(Punctuation::Dot));
        let is_meant = match self.enclosing(token.start) {
            // The name of a type stays one.
            Place::Declaration => !is_typed(before),
            Place::Body { is_own } => !is_called || is_member || is_own(&key),
        };
        if is_meant {
            self.edits.replace(token.start..token.end, new.clone());
        }
    }

    fn enclosing(&self, at: u32) -> Place<'_> {
        let is_in = |span: onescan_iec::syntax::Span| span.start <= at && at < span.end;
        let Some(pou) = self.page.pous().find(|pou| is_in(pou.span)) else { return Place::Declaration };
        let in_result = pou.result.as_ref().is_some_and(|result| is_in(result.span));
        if in_result || pou.sections.iter().any(|section| is_in(section.span)) {
            return Place::Declaration;
        }
        let names = move |key: &str| {
            let mut names = pou.sections.iter().flat_map(|section| &section.variables).flat_map(|each| &each.names);
            names.any(|name| name.key() == key)
        };
        Place::Body { is_own: Box::new(names) }
    }
}

enum Place<'a> {
    /// Types stand here behind a colon.
    Declaration,
    /// Statements: a name in front of a bracket is called, as an instance if the unit declares it.
    Body { is_own: Box<dyn Fn(&str) -> bool + 'a> },
}

fn is_name(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Identifier | TokenKind::Keyword(_))
}

fn is_typed(before: Option<TokenKind>) -> bool {
    matches!(before, Some(TokenKind::Punctuation(Punctuation::Colon) | TokenKind::Keyword(Keyword::Of)))
}

/// The members of a structure that have the name of a word: MatIEC takes functions' names there.
fn members<'a>(spec: &'a TypeSpec, found: &mut Vec<&'a Ident>) {
    match &spec.kind {
        TypeSpecKind::Struct(fields) => {
            for field in fields {
                found.extend(Some(&field.name).filter(|name| is_word(&name.key())));
                members(&field.spec, found);
            }
        }
        TypeSpecKind::Array(_, element) => members(element, found),
        _ => {}
    }
}
