//! W0725: a variable is assigned to, and assigned to again before anything reads it. W0728: one is assigned to itself.

use super::bodies::{Bodies, Body};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::walk::{self, Visitor};
use crate::ir::{ElementaryType, Expr, ExprKind, Place, PlaceUse, Statement, StatementKind, Step, Storage, place_uses};
use crate::syntax::ast::{SectionKind, Variable};

pub(super) fn lint(bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    for body in bodies.iter() {
        walk::statements(&body.checked.body, &mut Itself { bodies, findings });
        // What a chart makes of its steps is not a list that runs from its beginning to its end.
        let viewed =
            body.pou.sections.iter().flat_map(|section| &section.variables).any(|each| each.viewed().is_some());
        if body.pou.chart.is_empty() && !viewed {
            twice(body, bodies, findings);
        }
    }
}

struct Itself<'a, 'f> {
    bodies: &'a Bodies<'a>,
    findings: &'f mut Vec<Diagnostic>,
}

impl Visitor for Itself<'_, '_> {
    fn statement(&mut self, statement: &Statement) {
        let (StatementKind::Assign(target, value) | StatementKind::Copy(target, value)) = &statement.kind else {
            return;
        };
        let (ExprKind::Load(source) | ExprKind::Address(source)) = &value.kind else { return };
        let text = |span| self.bodies.text(span).trim();
        let (to, from) = (text(target.span), text(source.span));
        // What a call gives may be another each time.
        let is_same = target.storage == source.storage && to.eq_ignore_ascii_case(from) && !to.contains('(');
        if is_same && target.span != source.span {
            let message = format!("`{to}` is assigned to itself, which does nothing");
            let found = Diagnostic::warning(Code::AssignedToItself, statement.span, message);
            self.findings.push(found.with_help("write what it should become, or delete the statement"));
        }
    }
}

/// A statement of the list itself that assigns to a whole variable or member.
fn assigned(statement: &Statement) -> Option<(&Place, &Expr)> {
    let StatementKind::Assign(target, value) = &statement.kind else { return None };
    let is_kept = matches!(target.storage, Storage::Absolute(_) | Storage::Located(_) | Storage::Instance(_));
    let is_fixed = target.steps.iter().all(|step| matches!(step, Step::Offset(_)));
    (is_kept && is_fixed).then_some((target, value))
}

fn twice(body: Body<'_>, bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    let Some(begin) = body.pou.body.first().map(|first| first.span) else { return };
    // What a call begins with, as the first value of a VAR_TEMP, stands in a declaration.
    let is_written = |each: &&Statement| each.span.file == begin.file && each.span.start >= begin.start;
    let list: Vec<&Statement> = body.checked.body.iter().filter(is_written).collect();
    for (at, first) in list.iter().enumerate() {
        let Some((place, value)) = assigned(first) else { continue };
        if is_shared(&body.checked.body, place, bodies) {
            continue;
        }
        let Some((again, next)) = overwriting(place, &list[at + 1..], bodies) else { continue };
        // A value for all cases, before what computes it.
        let is_default = bodies.constant(value).is_some() && bodies.constant(next).is_none();
        if !is_default {
            report(body, (place, again), bodies, findings);
        }
    }
}

/// The statement that assigns to the same place, if nothing between looks at it.
fn overwriting<'s>(place: &Place, list: &[&'s Statement], bodies: &Bodies<'_>) -> Option<(&'s Place, &'s Expr)> {
    for statement in list {
        if may_look_at(statement, place, bodies) {
            return None;
        }
        match assigned(statement) {
            Some((target, value)) if target.is_surely(place) => return Some((target, value)),
            // What neither looks at the place nor writes it changes nothing.
            _ => {}
        }
    }
    None
}

/// True if both may have bytes in common.
fn may_meet(one: &Place, other: &Place) -> bool {
    match (one.storage, other.storage) {
        (Storage::Located(one), Storage::Located(other)) => one.area == other.area,
        (one, other) => one == other,
    }
}

/// True if the statement may read the place, or end what follows it.
fn may_look_at(statement: &Statement, place: &Place, bodies: &Bodies<'_>) -> bool {
    let mut looks = false;
    place_uses(std::slice::from_ref(statement), bodies.types(), &mut |used, how| {
        // What a reference leads to may be this very variable.
        let is_elsewhere = matches!(used.steps.first(), Some(Step::Pointer { .. } | Step::Open { .. }))
            || matches!(used.storage, Storage::InstancePointer(_) | Storage::AbsolutePointer(_) | Storage::Referred);
        looks |= how != PlaceUse::Write && (is_elsewhere || may_meet(used, place));
    });
    let mut calls = Opaque { bodies, found: false };
    walk::statements(std::slice::from_ref(statement), &mut calls);
    looks || calls.found
}

/// Looks for what may read anything, and for what may leave the list.
struct Opaque<'a> {
    bodies: &'a Bodies<'a>,
    found: bool,
}

impl Opaque<'_> {
    fn calls(&mut self, unit: crate::ir::PouId) {
        // The standard's blocks know their own variables only.
        let is_known = self.bodies.unit(unit).is_some_and(|unit| self.bodies.is_of_library(unit));
        self.found |= !is_known;
    }
}

impl Visitor for Opaque<'_> {
    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::CallInstance(call) => self.calls(call.pou),
            StatementKind::Return | StatementKind::Jump(_) | StatementKind::Labelled(_) | StatementKind::Exit => {
                self.found = true;
            }
            // The others name all that they read.
            _ => {}
        }
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Call(call) => self.calls(call.pou),
            ExprKind::Intrinsic(crate::ir::Intrinsic::Memory(_), _) => self.found = true,
            // The others name all that they read.
            _ => {}
        }
    }
}

/// True if something else gets the address of the variable.
fn is_shared(statements: &[Statement], place: &Place, bodies: &Bodies<'_>) -> bool {
    let mut shared = false;
    place_uses(statements, bodies.types(), &mut |used, how| {
        shared |= how == PlaceUse::Share && may_meet(used, place);
    });
    shared
}

fn report(body: Body<'_>, (first, again): (&Place, &Place), bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    let name = bodies.text(again.span);
    let is_output = matches!(first.storage, Storage::Located(_)) || is_output(body, name);
    let what = if is_output { "output " } else { "" };
    let message = format!("{what}`{name}` is assigned to twice, and nothing reads the first value");
    let is_bool = bodies.types().elementary(first.ty) == Some(ElementaryType::Bool);
    let help = if is_bool {
        "join both conditions in one assignment, as in `lamp := a OR b`"
    } else {
        "delete one of the two assignments, or give it a variable of its own"
    };
    let found = Diagnostic::warning(Code::Overwritten, again.span, message)
        .with_label(first.span, "this value is lost")
        .with_help(help);
    findings.push(found);
}

fn is_output(body: Body<'_>, name: &str) -> bool {
    let outputs = body.pou.sections.iter().filter(|section| section.kind == SectionKind::Output);
    let mut names = outputs.flat_map(|section| &section.variables).flat_map(|each: &Variable| &each.names);
    names.any(|each| each.text.eq_ignore_ascii_case(name))
}
