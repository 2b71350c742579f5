//! Timers of SCL that are called as methods of their variable, as in `#t.TON(..)`.
//!
//! | in the source | becomes |
//! |---|---|
//! | `t : IEC_TIMER;` and only `#t.TON(..)` | `t : "SDSP_TON_TIME";` |
//! | `#t.TON(IN := ..)`, `"timer".TON(IN := ..)` | `#t(IN := ..)`, `"timer"(IN := ..)` |
//!
//! An `IEC_TIMER` is what it is called as: one that is called as several, or from elsewhere, is reported.

use std::collections::{BTreeMap, BTreeSet};

use super::clock::{self, Form};
use onescan_iec::syntax::ast::{
    Call, CompilationUnit, Declaration, Expr, ExprKind, Ident, Section, TypeSpec, TypeSpecKind, Variable,
};
use onescan_iec::syntax::walk::{self, Visitor};
use onescan_iec::syntax::{FileId, Span};

/// What a call on an instance may name.
const TIMERS: [&str; 4] = ["TON", "TOF", "TP", "TONR"];
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

    /// The spans of `.TON` and the like that go with what is replaced: all but those of variables that no one of
    /// `renames` stands at.
    pub(super) fn cuts(&self, units: &[(FileId, &CompilationUnit)], renames: &[(Ident, &'static Form)]) -> Vec<Span> {
        let left = left(units, renames);
        let is_replaced = |call: &&TimerCall| call.place.as_ref().is_none_or(|place| !left.contains(place));
        self.calls.iter().filter(is_replaced).map(|call| call.span).collect()
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
            let is_local = !name.is_global() && self.locals.contains(&name.key());
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
fn left(units: &[(FileId, &CompilationUnit)], renames: &[(Ident, &'static Form)]) -> BTreeSet<Place> {
    let mut left = BTreeSet::new();
    let mut section = |unit: &str, section: &Section| {
        for variable in &section.variables {
            let Some(name) = any_timer(&variable.spec) else { continue };
            if !renames.iter().any(|(renamed, _)| renamed.span == name.span) {
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
