//! SCL of Siemens' TIA Portal as external source: what is written in another way there.
//!
//! | in the source | becomes |
//! |---|---|
//! | `t {InstructionName := 'TON_TIME'} : TON_TIME;` | `t : "SDSP_TON_TIME";` |
//! | `t : IEC_TIMER;` and only `#t.TON(..)` | the same |
//! | `#t.TON(IN := ..)`, `"timer".TON(IN := ..)` | `#t(IN := ..)`, `"timer"(IN := ..)` |
//!
//! An `IEC_TIMER` is what it is called as: one that is called as several, or from elsewhere, is told.

use std::collections::{BTreeMap, BTreeSet};

use onescan_base::TimeSpan;

use super::clock::{self, Form};
use super::marks;
use super::survey::Survey;
use onescan_iec::dialect::Dialect;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{
    Call, CompilationUnit, Declaration, Expr, ExprKind, Ident, Pou, Section, SectionKind, TypeSpec, TypeSpecKind,
    Variable,
};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Keyword, Punctuation, Token, TokenKind};
use onescan_iec::syntax::walk::{self, Visitor};
use onescan_iec::syntax::{FileId, SourceFile, Span};
use onescan_iec::task_plan::Task;

/// What a call on an instance may name.
const TIMERS: [&str; 3] = ["TON", "TOF", "TP"];
/// The type of a timer that is called as any of them.
const ANY_TIMER: &str = "IEC_TIMER";

/// A variable: the unit that declares it, nothing for a global one, and its name.
type Place = (String, String);

/// Calls as in `#t.TON(..)`.
#[derive(Debug, Default)]
pub(super) struct TimerCalls {
    calls: Vec<TimerCall>,
    /// What each variable is called as.
    kinds: BTreeMap<Place, BTreeSet<String>>,
}

#[derive(Debug)]
struct TimerCall {
    /// The variable; nothing if it is a part of another.
    place: Option<Place>,
    /// `.TON`
    span: Span,
}

impl TimerCalls {
    /// All calls of a project.
    pub(super) fn of(units: &[(FileId, &CompilationUnit)]) -> Self {
        let mut calls = Self::default();
        for declaration in units.iter().flat_map(|(_, unit)| &unit.declarations) {
            if let Declaration::Pou(pou) = declaration {
                let names = pou.sections.iter().flat_map(|section| &section.variables).flat_map(|each| &each.names);
                let locals = names.map(Ident::key).collect();
                let mut reader = Reader { unit: pou.name.key(), locals, calls: &mut calls };
                walk::statements(&pou.body, &mut reader);
            }
        }
        calls
    }

    /// What takes the place of a variable's `IEC_TIMER`, with the type's name; of a global one, `unit` is empty.
    pub(super) fn replacement<'v>(&self, unit: &str, variable: &'v Variable) -> Option<(&'v Ident, &'static Form)> {
        let name = any_timer(&variable.spec)?;
        let kinds = |name: &Ident| self.kinds.get(&(unit.to_owned(), name.key()));
        let mut called = variable.names.iter().map(kinds);
        let first = called.next()??;
        let same = called.all(|kinds| kinds == Some(first));
        let kind = first.first().filter(|_| first.len() == 1 && same)?;
        clock::timer_of_time(kind).map(|form| (name, form))
    }
}

/// The name in a specification of `IEC_TIMER` or an array of it.
fn any_timer(spec: &TypeSpec) -> Option<&Ident> {
    match &spec.kind {
        TypeSpecKind::Name(name) => (name.key() == ANY_TIMER).then_some(name),
        TypeSpecKind::Array(_, element) => any_timer(element),
        _ => None,
    }
}

struct Reader<'c> {
    unit: String,
    locals: BTreeSet<String>,
    calls: &'c mut TimerCalls,
}

impl Visitor for Reader<'_> {
    fn call(&mut self, call: &Call) {
        let ExprKind::Member(base, kind) = &call.callee.kind else { return };
        if !TIMERS.contains(&kind.key().as_str()) {
            return;
        }
        let place = variable(base).map(|name| {
            let is_local = !name.is_quoted() && self.locals.contains(&name.key());
            (if is_local { self.unit.clone() } else { String::new() }, name.key())
        });
        if let Some(place) = &place {
            self.calls.kinds.entry(place.clone()).or_default().insert(kind.key());
        }
        let span = Span::new(kind.span.file, base.span.end, kind.span.end);
        self.calls.calls.push(TimerCall { place, span });
    }
}

/// The variable that is called, also by an index.
fn variable(expr: &Expr) -> Option<&Ident> {
    match &expr.kind {
        ExprKind::Name(name) => Some(name),
        ExprKind::Index(base, _) => variable(base),
        _ => None,
    }
}

/// Where `IEC_TIMER` is left as it is: its calls stay.
fn left(units: &[(FileId, &CompilationUnit)], survey: &Survey<'_>) -> BTreeSet<Place> {
    let mut left = BTreeSet::new();
    let mut section = |unit: &str, section: &Section| {
        for variable in &section.variables {
            let Some(name) = any_timer(&variable.spec) else { continue };
            if !survey.renames.iter().any(|(renamed, _)| renamed.span == name.span) {
                left.extend(variable.names.iter().map(|each| (unit.to_owned(), each.key())));
            }
        }
    };
    for declaration in units.iter().flat_map(|(_, unit)| &unit.declarations) {
        match declaration {
            Declaration::Pou(pou) => pou.sections.iter().for_each(|each| section(&pou.name.key(), each)),
            Declaration::Globals(globals) => section("", globals),
            _ => {}
        }
    }
    left
}

/// The spans of `.TON` and the like that go with what is replaced.
pub(super) fn cuts(units: &[(FileId, &CompilationUnit)], survey: &Survey<'_>) -> Vec<Span> {
    let left = left(units, survey);
    let is_replaced = |call: &&TimerCall| call.place.as_ref().is_none_or(|place| !left.contains(place));
    survey.timer_calls.calls.iter().filter(is_replaced).map(|call| call.span).collect()
}

/// Takes `.TON` out of `#t.TON(..)`.
pub(super) fn cut(span: Span, file: &SourceFile, edits: &mut Edits) {
    let at = file.shown_range(span.start, span.end);
    let text = file.shown_text().get(at.start as usize..at.end as usize).unwrap_or("");
    edits.replace(at, marks::cut_text(text));
}

/// Puts a block of the shim in the place of a timer; what the portal notes of the timer's version goes with it.
pub(super) fn rename(name: &Ident, new: &str, file: &SourceFile, edits: &mut Edits) {
    let text = file.text();
    let tokens = tokenize_in(file.dialect(), text);
    let before = tokens.iter().rev().skip_while(|token| token.end > name.span.start);
    for note in before.take_while(|token| !begins_declaration(token)).filter(|token| token.kind == TokenKind::Pragma) {
        let written = text.get(note.start as usize..note.end as usize).unwrap_or("");
        if written.contains("InstructionName") {
            edits.replace(note.start..note.end, marks::cut_text(written));
        }
    }
    let written = text.get(name.span.start as usize..name.span.end as usize).unwrap_or("");
    edits.replace(name.span.start..name.span.end, marks::renamed(&format!("\"{new}\""), written));
}

/// True for what stands before the declaration of a variable or behind the words `DATA_BLOCK`.
fn begins_declaration(token: &Token) -> bool {
    match token.kind {
        TokenKind::Punctuation(Punctuation::Semicolon) => true,
        TokenKind::Keyword(keyword) => !matches!(keyword, Keyword::Retain | Keyword::NonRetain),
        _ => false,
    }
}

/// Intervals that STEP 7 gives to OB30 to OB38, ms; the later ones have the higher priority.
const CYCLIC_MS: [u64; 9] = [5000, 2000, 1000, 500, 200, 100, 50, 20, 10];
/// The interval of program cycles.
const CYCLE: TimeSpan = TimeSpan::millis::<10>();

/// The tasks of a project of organization blocks: cyclic interrupts that bear their number, each with the interval and
/// the rank that STEP 7 gives it, and behind them all others as one program cycle.
pub(super) fn tasks(programs: &[&Pou]) -> Vec<Task> {
    let mut tasks = Vec::new();
    let mut cycle = Vec::new();
    for pou in programs {
        let number = pou.name.key().strip_prefix("OB").and_then(|number| number.parse::<usize>().ok());
        let interval = number.and_then(|number| CYCLIC_MS.get(number.checked_sub(30)?).map(|ms| (number - 30, ms)));
        let name = pou.name.text.clone();
        match interval {
            Some((rank, ms)) => {
                let priority = (CYCLIC_MS.len() - 1 - rank) as u32;
                tasks.push(Task {
                    interval: TimeSpan::from_millis(*ms),
                    priority,
                    programs: vec![name.clone()],
                    name,
                    ..Task::default()
                });
            }
            None => cycle.push(name),
        }
    }
    if !cycle.is_empty() {
        let (name, priority) = ("OB1".to_owned(), CYCLIC_MS.len() as u32);
        tasks.push(Task { name, interval: Some(CYCLE), priority, programs: cycle, ..Task::default() });
    }
    tasks
}

/// Adds a block's temporary variables; a block has one section of them.
pub(super) fn declare(pou: &Pou, declarations: &str, file: &SourceFile, edits: &mut Edits) {
    let (text, line_break) = (file.text(), marks::line_break(file.text()));
    let section = pou.sections.iter().find(|section| section.kind == SectionKind::Temp);
    if let Some(end) = section.and_then(|section| keyword(Keyword::EndVar, section.span, file)) {
        let inner: Vec<&str> = declarations.lines().filter(|line| line.contains(':')).collect();
        edits.insert(marks::line_start(text, end.start), marks::lines(&inner.join("\n"), line_break));
    } else if let Some(begin) = begin(pou.span, file) {
        edits.insert(marks::line_start(text, begin.start), marks::lines(declarations, line_break));
    }
}

/// The word `BEGIN` of a block in SCL.
pub(super) fn begin(block: Span, file: &SourceFile) -> Option<Token> {
    keyword(Keyword::Begin, block, file).filter(|_| is_scl(file))
}

/// The first keyword of this kind.
fn keyword(wanted: Keyword, inside: Span, file: &SourceFile) -> Option<Token> {
    let tokens = tokenize_in(file.dialect(), file.text());
    let is_inside = |token: &&Token| inside.start <= token.start && token.end <= inside.end;
    tokens.iter().filter(is_inside).find(|token| token.kind == TokenKind::Keyword(wanted)).copied()
}

/// True for a source in SCL.
pub(super) fn is_scl(file: &SourceFile) -> bool {
    file.dialect() == Dialect::SiemensScl
}
