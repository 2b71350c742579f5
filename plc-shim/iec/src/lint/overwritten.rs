//! W0725: a variable is assigned to, and assigned to again before anything reads it. W0728: one is assigned to itself.

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use super::bodies::{Bodies, Body};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::walk::{self, Visitor};
use crate::ir::{ElementaryType, Expr, ExprKind, Place, PlaceUse, Statement, StatementKind, Step, Storage, place_uses};
use crate::syntax::ast::{SectionKind, Variable};
use crate::syntax::direct_address::Area;

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
    let index = Index::of(&body.checked.body, &list, bodies);
    let outputs = LazyCell::new(|| outputs_of(body));
    for (at, first) in list.iter().enumerate() {
        let Some((place, value)) = assigned(first) else { continue };
        let Some((again, next)) = index.overwriting(place, at, &list) else { continue };
        // A value for all cases, before what computes it.
        let is_default = bodies.constant(value).is_some() && bodies.constant(next).is_none();
        if !is_default {
            let is_output = |name: &str| outputs.contains(&name.to_ascii_uppercase());
            report(is_output, (place, again), bodies, findings);
        }
    }
}

/// Where a place lies that may have bytes in common with others: what has another key has none.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Whole {
    Absolute(u32),
    Instance(u32),
    Area(Area),
}

/// Where exactly it begins.
type Begin = (Whole, u32, Option<u8>);

fn whole(storage: Storage) -> Option<Whole> {
    match storage {
        Storage::Absolute(offset) => Some(Whole::Absolute(offset)),
        Storage::Instance(offset) => Some(Whole::Instance(offset)),
        Storage::Located(location) => Some(Whole::Area(location.area)),
        Storage::AbsolutePointer(_)
        | Storage::InstancePointer(_)
        | Storage::Register(_)
        | Storage::RegisterPointer(_)
        | Storage::Referred => None,
    }
}

fn begin(place: &Place) -> Option<Begin> {
    let offset = |step: &Step| if let Step::Offset(offset) = step { Some(*offset) } else { None };
    let inside = place.steps.iter().map(offset).sum::<Option<u32>>()?;
    let (from, bit) = match place.storage {
        Storage::Located(location) => (location.offset, location.bit),
        _ => (0, None),
    };
    Some((whole(place.storage)?, from.checked_add(inside)?, bit))
}

/// What the statements of a list do, by places: found in one walk, however long the list is.
#[derive(Default)]
struct Index {
    /// The statements that may look at a place, in their order.
    looks: BTreeMap<Whole, Vec<usize>>,
    /// Those that may look at any place, or end what follows them.
    anything: Vec<usize>,
    /// Those that assign to a place.
    assigned: BTreeMap<Begin, Vec<usize>>,
    /// Places whose address something else gets.
    shared: BTreeSet<Whole>,
}

impl Index {
    fn of(all: &[Statement], list: &[&Statement], bodies: &Bodies<'_>) -> Self {
        let mut index = Self::default();
        place_uses(all, bodies.types(), &mut |used, how| {
            if how == PlaceUse::Share {
                index.shared.extend(whole(used.storage));
            }
        });
        for (at, statement) in list.iter().enumerate() {
            index.add(at, statement, bodies);
        }
        index
    }

    fn add(&mut self, at: usize, statement: &Statement, bodies: &Bodies<'_>) {
        let mut calls = Opaque { bodies, found: false };
        walk::statements(std::slice::from_ref(statement), &mut calls);
        place_uses(std::slice::from_ref(statement), bodies.types(), &mut |used, how| {
            if how == PlaceUse::Write {
                return;
            }
            // What a reference leads to may be any variable.
            calls.found |= matches!(used.steps.first(), Some(Step::Pointer { .. } | Step::Open { .. }))
                || matches!(
                    used.storage,
                    Storage::InstancePointer(_) | Storage::AbsolutePointer(_) | Storage::Referred
                );
            if let Some(whole) = whole(used.storage) {
                let looking = self.looks.entry(whole).or_default();
                if looking.last() != Some(&at) {
                    looking.push(at);
                }
            }
        });
        if calls.found {
            self.anything.push(at);
        }
        if let Some(begin) = assigned(statement).and_then(|(place, _)| begin(place)) {
            self.assigned.entry(begin).or_default().push(at);
        }
    }

    /// The statement after `at` that assigns to the same place, if nothing between looks at it, and nothing else has its
    /// address.
    fn overwriting<'s>(&self, place: &Place, at: usize, list: &[&'s Statement]) -> Option<(&'s Place, &'s Expr)> {
        let after = |all: &[usize]| all.partition_point(|other| *other <= at);
        let whole = whole(place.storage)?;
        if self.shared.contains(&whole) {
            return None;
        }
        let looks = self.looks.get(&whole).map_or(&[][..], Vec::as_slice);
        let seen = [looks, &self.anything].into_iter().filter_map(|all| all.get(after(all))).min();
        let assigning = self.assigned.get(&begin(place)?)?;
        let unseen = assigning[after(assigning)..].iter().take_while(|next| seen.is_none_or(|seen| *next < seen));
        unseen.filter_map(|next| assigned(list.get(*next)?)).find(|(target, _)| target.is_surely(place))
    }
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

fn report(
    is_output: impl Fn(&str) -> bool,
    (first, again): (&Place, &Place),
    bodies: &Bodies<'_>,
    findings: &mut Vec<Diagnostic>,
) {
    let name = bodies.text(again.span);
    let is_output = matches!(first.storage, Storage::Located(_)) || is_output(name);
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

/// The names of a unit's outputs, in capitals.
fn outputs_of(body: Body<'_>) -> BTreeSet<String> {
    let outputs = body.pou.sections.iter().filter(|section| section.kind == SectionKind::Output);
    let names = outputs.flat_map(|section| &section.variables).flat_map(|each: &Variable| &each.names);
    names.map(|each| each.text.to_ascii_uppercase()).collect()
}
