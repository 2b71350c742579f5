//! W0729: a counter that grows in each scan, is compared, and is never set back.

use std::collections::BTreeMap;

use super::Unit;
use super::bodies::{Bodies, Body};
use crate::diagnostic::{Code, Diagnostic};
use crate::front::Front;
use crate::ir::walk::{self, Visitor};
use crate::ir::{
    Binary, ElementaryType, Expr, ExprKind, Place, PlaceUse, Statement, StatementKind, Storage, Type, TypeId, Value,
    place_uses,
};
use crate::syntax::ast::PouKind;
use crate::task_plan::TaskPlan;
use onescan_base::TimeSpan;

/// What goes on for longer is somebody else's machine.
const A_YEAR_S: u64 = 365 * 24 * 3600;

pub(super) fn lint(
    front: &Front,
    units: &[Unit<'_>],
    bodies: &Bodies<'_>,
    plan: Option<&TaskPlan>,
    findings: &mut Vec<Diagnostic>,
) {
    for body in bodies.iter().filter(|body| is_plain_program(body, units)) {
        let Some(interval) = interval_of(&body.pou.name.text, front, plan) else { continue };
        // All counters of a program are looked up in one walk, which a program without one does not need.
        let mut counters: Option<Counters> = None;
        for statement in &body.checked.body {
            if leaves(statement) {
                break;
            }
            if let Some((place, step)) = growth(statement, bodies)
                && counters.get_or_insert_with(|| Counters::of(&body, bodies)).is_for_ever(place)
            {
                report(place, step, interval, bodies, findings);
            }
        }
    }
}

/// True for a program whose variables nobody else writes.
fn is_plain_program(body: &Body<'_>, units: &[Unit<'_>]) -> bool {
    let key = body.pou.name.key();
    let is_reached = || units.iter().any(|unit| unit.usage.get(&key).written.is_some());
    body.pou.kind == PouKind::Program
        && body.pou.chart.is_empty()
        && body.pou.object.members.is_empty()
        && !is_reached()
}

/// The shortest time between two calls by a task.
fn interval_of(program: &str, front: &Front, plan: Option<&TaskPlan>) -> Option<TimeSpan> {
    if let Some(plan) = plan {
        let runs = |name: &String| name.eq_ignore_ascii_case(program);
        let tasks = plan.tasks.iter().filter(|task| task.programs.iter().any(runs));
        return tasks.filter_map(|task| task.interval).min();
    }
    let checked = &front.checked;
    let resources = checked.configuration.iter().flat_map(|configuration| &configuration.resources);
    // The entries of programs come first, in the order of the programs.
    let runs = |at: &usize| {
        let unit = checked.programs.get(*at).and_then(|instance| checked.pous.get(&instance.pou));
        unit.is_some_and(|unit| unit.name.eq_ignore_ascii_case(program))
    };
    let tasks = resources.flat_map(|resource| &resource.tasks).filter(|task| task.entries.iter().any(runs));
    tasks.filter_map(|task| task.interval).min()
}

/// True if what follows is not reached in each call.
fn leaves(statement: &Statement) -> bool {
    struct Ends(bool);
    impl Visitor for Ends {
        fn statement(&mut self, statement: &Statement) {
            let kind = &statement.kind;
            self.0 |= matches!(kind, StatementKind::Return | StatementKind::Jump(_) | StatementKind::Labelled(_));
        }
    }
    let mut ends = Ends(false);
    walk::statements(std::slice::from_ref(statement), &mut ends);
    ends.0
}

/// The variable and the number of `n := n + 1`, where `n` has a sign: one without goes round on purpose more often.
fn growth<'s>(statement: &'s Statement, bodies: &Bodies<'_>) -> Option<(&'s Place, i128)> {
    let StatementKind::Assign(place, value) = &statement.kind else { return None };
    let Type::Elementary(ty) = bodies.types().get(place.ty) else { return None };
    let is_counter = ty.is_integer() && ty.is_signed() && ty.size() < ElementaryType::Lint.size();
    let ExprKind::Binary(Binary::Add, left, right) = &bare(value).kind else { return None };
    let is_own = |expr: &Expr| matches!(&bare(expr).kind, ExprKind::Load(from) if from.is_surely(place));
    let step = match (is_own(left), is_own(right)) {
        (true, false) => bodies.constant(right),
        (false, true) => bodies.constant(left),
        _ => None,
    };
    let step = step.and_then(Value::as_int).filter(|step| *step > 0)?;
    let is_kept = matches!(place.storage, Storage::Instance(_)) && place.steps.is_empty() && place.part.is_none();
    (is_counter && is_kept).then_some((place, step))
}

/// The value whatever its type.
fn bare(expr: &Expr) -> &Expr {
    match &expr.kind {
        ExprKind::Convert(_, operand) | ExprKind::FromRegister(operand) => bare(operand),
        _ => expr,
    }
}

/// What a program does with the variables of its instance, by their offsets.
#[derive(Default)]
struct Counters {
    /// How often each is written.
    writes: BTreeMap<u32, u32>,
    /// The types as which each is compared by its size, or selects by its value.
    compared: BTreeMap<u32, Vec<TypeId>>,
}

impl Counters {
    fn of(body: &Body<'_>, bodies: &Bodies<'_>) -> Self {
        let mut counters = Self::default();
        walk::statements(&body.checked.body, &mut counters);
        place_uses(&body.checked.body, bodies.types(), &mut |place, how| {
            if let (Storage::Instance(offset), PlaceUse::Write | PlaceUse::Share) = (place.storage, how) {
                *counters.writes.entry(offset).or_default() += 1;
            }
        });
        counters
    }

    /// True if nothing else writes the variable, and something compares its size or selects by it.
    fn is_for_ever(&self, counter: &Place) -> bool {
        let Storage::Instance(offset) = counter.storage else { return false };
        let is_compared = self.compared.get(&offset).is_some_and(|types| types.contains(&counter.ty));
        self.writes.get(&offset) == Some(&1) && is_compared
    }

    /// A whole variable, not one that is in it.
    fn compare(&mut self, expr: &Expr) {
        let ExprKind::Load(from) = &bare(expr).kind else { return };
        if let (Storage::Instance(offset), true) = (from.storage, from.is_surely(&whole(from))) {
            let types = self.compared.entry(offset).or_default();
            if !types.contains(&from.ty) {
                types.push(from.ty);
            }
        }
    }
}

/// The variable that a place is in, seen as the place's type.
fn whole(place: &Place) -> Place {
    Place { steps: Vec::new(), part: None, ..place.clone() }
}

impl Visitor for Counters {
    fn statement(&mut self, statement: &Statement) {
        if let StatementKind::Case(case) = &statement.kind {
            self.compare(&case.selector);
        }
    }

    fn expression(&mut self, expr: &Expr) {
        let ExprKind::Binary(Binary::Less | Binary::LessEqual | Binary::Greater | Binary::GreaterEqual, left, right) =
            &expr.kind
        else {
            return;
        };
        self.compare(left);
        self.compare(right);
    }
}

fn report(place: &Place, step: i128, interval: TimeSpan, bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    let Some(ty) = bodies.types().elementary(place.ty) else { return };
    let Some((low, high)) = ty.range() else { return };
    let turns = u64::try_from(high / step + 1).ok();
    let Some(seconds) = turns.and_then(|turns| interval.times(turns)).map(|span| span.as_nanos() / 1_000_000_000)
    else {
        return;
    };
    if seconds > A_YEAR_S {
        return;
    }
    let name = bodies.text(place.span);
    let after = long(seconds);
    let message =
        format!("`{name}` grows in each scan and is never set back: after {after} it goes from {high} to {low}");
    let found = Diagnostic::warning(Code::CounterWraps, place.span, message);
    findings.push(found.with_help(format!(
        "set it back, or let it grow only while it is below its limit: `IF {name} < limit THEN {name} := {name} + {step};`"
    )));
}

/// A time in two units.
fn long(seconds: u64) -> String {
    let (days, hours, minutes) = (seconds / 86_400, seconds / 3600 % 24, seconds / 60 % 60);
    match (days, hours, minutes) {
        (1.., ..) => format!("{days} d {hours} h"),
        (_, 1.., _) => format!("{hours} h {minutes} min"),
        (.., 1..) => format!("{minutes} min {} s", seconds % 60),
        _ => format!("{seconds} s"),
    }
}
