//! Tests as sources declare them.

use std::time::Duration;

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::syntax::ast::{Declaration, Pou, PouKind};
use onescan_iec::syntax::token::Token;
use onescan_iec::syntax::{FileId, parse_in, tokenize_in};
use onescan_server::client::SourcePlace;

use super::attributes::Attributes;
use super::place::place;
use super::tcunit::sources::Sources;

/// What the names of tests begin with.
pub(super) const PREFIX: &str = "TEST_";
/// What the programs that hold instances of test blocks begin with.
const HARNESS: &str = "ONESCAN_RUN_";
/// The name of the instance in them.
const INSTANCE: &str = "it";
/// How long a test of CODESYS' Test Manager may take, if it does not say.
const TIMEOUT: Duration = Duration::from_secs(15);

/// A test as it is declared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Test {
    unit: String,
    is_program: bool,
    pub(super) name: String,
    pub(super) place: SourcePlace,
    pub(super) tags: Vec<String>,
    /// Set for a test of CODESYS' Test Manager.
    pub(super) manager: Option<Manager>,
}

/// True if a test run uses a file, whatever the tasks of its project run.
pub(super) type IsUsed = bool;

/// What `{attribute 'test'}` says of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Manager {
    /// When it has taken too long, if it is started by `xExecute`.
    pub(super) timeout: Duration,
    /// True for a unit with several tests.
    pub(super) is_multiple: bool,
}

impl Test {
    /// The program that a task runs for it.
    pub(super) fn program(&self) -> String {
        if self.is_program { self.unit.clone() } else { format!("{HARNESS}{}", self.unit) }
    }

    /// The path of one of its variables, if it has one of this name.
    pub(super) fn variable(&self, name: &str) -> String {
        if self.is_program { format!("{}.{name}", self.unit) } else { format!("{}.{INSTANCE}.{name}", self.program()) }
    }
}

/// The tests that a file declares: units whose names begin so or that have the attribute. Suites of `TcUnit`, and what
/// runs them, are not tests by themselves; the file that has a program which runs them is used, too.
pub(super) fn tests(input: &Input, sources: &Sources) -> (Vec<Test>, IsUsed) {
    let file = input.file();
    let unit = parse_in(file.dialect(), FileId(0), file.text()).unit;
    let pous = unit.declarations.iter().filter_map(|declaration| match declaration {
        Declaration::Pou(pou) => Some(pou),
        _ => None,
    });
    let runs_suites = pous.clone().any(|pou| pou.kind == PouKind::Program && sources.is_runner(&pou.name.text));
    let is_own = |pou: &&Pou| match pou.kind {
        PouKind::Program => !sources.is_runner(&pou.name.text),
        PouKind::FunctionBlock => !sources.is_suite(&pou.name.text),
        _ => false,
    };
    let tokens = tokenize_in(file.dialect(), file.text());
    let tests: Vec<Test> = pous.filter(is_own).filter_map(|pou| test(input, &tokens, pou)).collect();
    let is_used = runs_suites || !tests.is_empty();
    (tests, is_used)
}

fn test(input: &Input, tokens: &[Token], pou: &Pou) -> Option<Test> {
    let name = &pou.name;
    let attributes = Attributes::of(tokens, input.file().text(), name.span.start);
    let manager = attributes
        .is_test()
        .then(|| Manager { timeout: attributes.timeout().unwrap_or(TIMEOUT), is_multiple: attributes.is_multitest() });
    let is_named = name.text.get(..PREFIX.len()).is_some_and(|start| start.eq_ignore_ascii_case(PREFIX));
    if !is_named && manager.is_none() {
        return None;
    }
    Some(Test {
        unit: name.text.clone(),
        is_program: pou.kind == PouKind::Program,
        name: attributes.case_name().unwrap_or(&name.text).to_owned(),
        place: place(input, name.span.start),
        tags: attributes.tags(),
        manager,
    })
}

/// A program for each test block, which holds its instance.
pub(super) fn harness(tests: &[Test]) -> Option<Input> {
    let blocks = tests.iter().filter(|test| !test.is_program);
    let text: String = blocks
        .map(|test| {
            let (program, unit) = (test.program(), &test.unit);
            format!("PROGRAM {program} VAR {INSTANCE} : {unit}; END_VAR {INSTANCE}(); END_PROGRAM\n")
        })
        .collect();
    (!text.is_empty()).then(|| Input::from_text("(test harness)", SourceKind::Text, text))
}
