//! What is legal and seldom meant: warnings on programs that have no errors.
//!
//! | module | subject |
//! |---|---|
//! | [`inspect`] | errors and warnings of files |
//! | [`index`] | what the files declare, by name |
//! | [`usage`] | what a unit does with each name |
//! | [`types`] | the type of an expression, as far as a warning needs it |
//! | [`outputs`] | W0701 |
//! | [`instances`] | W0702, W0704 |
//! | [`equality`] | W0703 |
//! | [`reachability`] | W0705 |
//! | [`unused`] | W0706 |
//! | [`tasks`] | W0707 |
//! | [`endless`] | W0709 |
//! | [`attributes`] | W0714 |
//! | [`bodies`] | the checked units: expressions with types, names with places |
//! | [`zero_divisors`] | W0720 |
//! | [`counting`] | W0722, W0723 |
//! | [`decided`] | W0724, W0727 |
//! | [`overwritten`] | W0725, W0728 |
//! | [`shared_outputs`] | W0726 |
//! | [`wrapping`] | W0729 |
//!
//! A warning that is wrong costs more trust than one that is missing: where names alone do not
//! decide, nothing is said.

mod attributes;
mod bodies;
mod counting;
mod decided;
mod endless;
mod equality;
mod index;
mod inspect;
mod instances;
mod outputs;
mod overwritten;
mod reachability;
mod shared_outputs;
mod tasks;
mod types;
mod unused;
mod usage;
mod wrapping;
mod zero_divisors;

use self::bodies::Bodies;
use self::index::Index;
use self::usage::Usage;
use crate::diagnostic::Diagnostic;
use crate::front::Front;
use crate::task_plan::TaskPlan;

pub use inspect::{add_warnings, inspect, inspect_within};

/// All warnings; `plan` says which programs run in one task.
fn lint(front: &Front, plan: Option<&TaskPlan>) -> Vec<Diagnostic> {
    let index = Index::new(front);
    let units: Vec<Unit<'_>> = index.own().map(|pou| Unit { usage: Usage::of(pou, &index), pou }).collect();
    let mut findings = Vec::new();
    for unit in &units {
        outputs::lint(unit, &units, &mut findings);
        instances::lint(unit, &index, &mut findings);
        equality::lint(unit, &index, &mut findings);
        reachability::lint(unit, &mut findings);
        endless::lint(unit, &mut findings);
        decided::lint_conditions(unit, &mut findings);
        unused::lint(unit, &index, &mut findings);
        attributes::lint_methods(unit, &units, &mut findings);
    }
    for pou in index.own_members() {
        let unit = Unit { usage: Usage::of(pou, &index), pou };
        outputs::lint(&unit, &units, &mut findings);
        equality::lint(&unit, &index, &mut findings);
        reachability::lint(&unit, &mut findings);
        endless::lint(&unit, &mut findings);
        decided::lint_conditions(&unit, &mut findings);
        unused::lint(&unit, &index, &mut findings);
    }
    outputs::lint_globals(&units, &index, &mut findings);
    unused::lint_globals(&units, &index, &mut findings);
    tasks::lint(&units, &index, plan, &mut findings);
    attributes::lint(front, &mut findings);
    shared_outputs::lint(&units, &index, &front.sources, &mut findings);
    lint_bodies((front, plan), &units, &index, &mut findings);
    findings
}

/// Warnings that need types and places.
fn lint_bodies<'a>(
    (front, plan): (&'a Front, Option<&TaskPlan>),
    units: &[Unit<'a>],
    index: &Index<'a>,
    findings: &mut Vec<Diagnostic>,
) {
    let bodies = Bodies::new(front, index);
    zero_divisors::lint(&bodies, findings);
    counting::lint(&bodies, findings);
    decided::lint_comparisons(&bodies, findings);
    overwritten::lint(&bodies, findings);
    shared_outputs::lint_programs(&bodies, findings);
    wrapping::lint(front, units, &bodies, plan, findings);
}

/// A unit of the user's and what it does with names.
struct Unit<'a> {
    pou: &'a crate::syntax::ast::Pou,
    usage: Usage,
}
