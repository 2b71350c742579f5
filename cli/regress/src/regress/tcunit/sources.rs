//! Which units are suites, which programs run them, and where tests are declared.

use std::collections::BTreeMap;

use onescan_iec::Input;
use onescan_iec::syntax::ast::{Declaration, Pou, PouKind};
use onescan_iec::syntax::token::{Punctuation, Token, TokenKind};
use onescan_iec::syntax::{FileId, parse_in, tokenize_in};
use onescan_server::client::SourcePlace;

use super::super::attributes::Attributes;
use super::super::place::place;

/// The block that all suites extend.
const SUITE: &str = "FB_TESTSUITE";
/// Functions that declare a test.
const DECLARING: [&str; 2] = ["TEST", "TEST_ORDERED"];
/// Functions that run the suites.
const RUNNING: [&str; 2] = ["RUN", "RUN_IN_SEQUENCE"];

/// What the sources say of suites.
#[derive(Debug, Default)]
pub(in crate::regress) struct Sources {
    /// Blocks in capitals, each with the last part of its base's name.
    blocks: BTreeMap<String, Block>,
    runners: Vec<String>,
    /// Where a block declares a test, by both names.
    tests: BTreeMap<(String, String), SourcePlace>,
}

#[derive(Debug)]
struct Block {
    base: Option<String>,
    place: SourcePlace,
    tags: Vec<String>,
}

impl Sources {
    pub(in crate::regress) fn of(inputs: &[Input]) -> Self {
        let mut sources = Self::default();
        for input in inputs {
            sources.file(input);
        }
        sources
    }

    /// True if the block is `FB_TestSuite`, or extends it.
    pub(in crate::regress) fn is_suite(&self, block: &str) -> bool {
        self.line(block).any(|name| name == SUITE)
    }

    /// True for a program that runs the suites.
    pub(in crate::regress) fn is_runner(&self, program: &str) -> bool {
        self.has_suites() && self.runners.iter().any(|runner| runner.eq_ignore_ascii_case(program))
    }

    fn has_suites(&self) -> bool {
        self.blocks.contains_key(SUITE)
    }

    /// The programs that run the suites.
    pub(super) fn runners(&self) -> impl Iterator<Item = &str> {
        self.runners.iter().map(String::as_str)
    }

    /// Where a test of a block is declared: there or in what it extends; else where the block is.
    pub(super) fn place(&self, block: &str, test: &str) -> Option<SourcePlace> {
        let declared = self.line(block).find_map(|name| self.tests.get(&(name, test.to_owned())));
        declared.or_else(|| self.blocks.get(&key(block)).map(|block| &block.place)).cloned()
    }

    /// The tags of a block.
    pub(super) fn tags(&self, block: &str) -> Vec<String> {
        self.blocks.get(&key(block)).map(|block| block.tags.clone()).unwrap_or_default()
    }

    /// A block and all that it extends. A circle is an error elsewhere, and ends here.
    fn line(&self, block: &str) -> impl Iterator<Item = String> {
        let base = |name: &String| self.blocks.get(name)?.base.clone();
        std::iter::successors(Some(key(block)), base).take(self.blocks.len() + 1)
    }

    fn file(&mut self, input: &Input) {
        let file = input.file();
        let unit = parse_in(file.dialect(), FileId(0), file.text()).unit;
        let mut pous = Vec::new();
        gather(&unit.declarations, &mut pous);
        let tokens = tokenize_in(file.dialect(), file.text());
        for pou in &pous {
            let name = &pou.name;
            if pou.kind == PouKind::FunctionBlock {
                let base = pou.object.extends.first().map(|base| key(&base.text));
                let tags = Attributes::of(&tokens, file.text(), name.span.start).tags();
                let place = place(input, name.span.start);
                self.blocks.entry(key(&name.text)).or_insert(Block { base, place, tags });
            }
        }
        let tokens: Vec<Token> = tokens.into_iter().filter(|token| !token.kind.is_trivia()).collect();
        for (at, token) in tokens.iter().enumerate() {
            // What stands behind the end of a block, as methods do, is still that block's.
            let behind = pous.partition_point(|pou| pou.name.span.start <= token.start);
            if let Some(owner) = behind.checked_sub(1).and_then(|last| pous.get(last)) {
                self.call(input, owner, tokens.get(at..).unwrap_or_default());
            }
        }
    }

    /// Notes the call that begins with these tokens.
    fn call(&mut self, input: &Input, owner: &Pou, tokens: &[Token]) {
        let text = |token: &Token| input.file().text().get(token.start as usize..token.end as usize).unwrap_or("");
        let [name, open, rest @ ..] = tokens else { return };
        let open_paren = TokenKind::Punctuation(Punctuation::LeftParen);
        if name.kind != TokenKind::Identifier || open.kind != open_paren {
            return;
        }
        let is_one = |names: &[&str]| names.iter().any(|known| known.eq_ignore_ascii_case(text(name)));
        if owner.kind == PouKind::Program && is_one(&RUNNING) && !self.runners.contains(&owner.name.text) {
            self.runners.push(owner.name.text.clone());
        }
        let title = rest.iter().take(3).find(|token| token.kind == TokenKind::String);
        if let Some(title) = title.filter(|_| is_one(&DECLARING)) {
            let test = (key(&owner.name.text), unquoted(text(title)));
            self.tests.entry(test).or_insert_with(|| place(input, name.start));
        }
    }
}

/// The last part of a name, in capitals.
fn key(name: &str) -> String {
    name.rsplit('.').next().unwrap_or(name).to_ascii_uppercase()
}

/// The name that a literal gives a test, which takes blanks around it and the word for a disabled one away.
fn unquoted(literal: &str) -> String {
    let inner = literal.trim_matches('\'').replace("$'", "'").replace("$$", "$");
    let name = inner.trim();
    let disabled = "disabled_";
    let is_disabled = name.get(..disabled.len()).is_some_and(|start| start.eq_ignore_ascii_case(disabled));
    if is_disabled { name[disabled.len()..].to_owned() } else { name.to_owned() }
}

/// Units outside of namespaces and inside, in the order of the text.
fn gather<'a>(declarations: &'a [Declaration], pous: &mut Vec<&'a Pou>) {
    for declaration in declarations {
        match declaration {
            Declaration::Pou(pou) => pous.push(pou),
            Declaration::Namespace(namespace) => gather(&namespace.declarations, pous),
            _ => {}
        }
    }
}
