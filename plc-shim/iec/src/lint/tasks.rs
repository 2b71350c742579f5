//! W0707: a global variable with two writers in different tasks has the value of whichever ran last.

use std::collections::{BTreeMap, BTreeSet};

use super::Unit;
use super::index::Index;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::Span;
use crate::syntax::ast::{Ident, Pou, PouKind, SectionKind};
use crate::task_plan::TaskPlan;

/// Without a plan the configuration says which task runs what; without one of those every program
/// is taken to have a task of its own.
pub(super) fn lint(units: &[Unit<'_>], index: &Index<'_>, plan: Option<&TaskPlan>, findings: &mut Vec<Diagnostic>) {
    let units: BTreeMap<String, &Unit<'_>> = units.iter().map(|unit| (unit.pou.name.key(), unit)).collect();
    // The first write of each task to each global.
    let mut writers: BTreeMap<String, BTreeMap<String, Span>> = BTreeMap::new();
    // What a start runs is over before any task begins.
    let of_tasks = |pou: &Pou| pou.kind == PouKind::Program && !pou.object.runs_at_start;
    for (key, unit) in units.iter().filter(|(_, unit)| of_tasks(unit.pou)) {
        for task in tasks_of(&unit.pou.name, plan, index) {
            for reached in reached(key, &units, index) {
                for (name, span) in global_writes(reached, index) {
                    writers.entry(name.to_owned()).or_default().entry(task.clone()).or_insert(span);
                }
            }
        }
    }
    let declared = index.globals().flat_map(|section| &section.variables).flat_map(|variable| &variable.names);
    for name in declared {
        let Some(tasks) = writers.get(&name.key()).filter(|tasks| tasks.len() > 1) else { continue };
        let kind = if plan.is_some() || index.configured_tasks(name).is_some() { "tasks" } else { "programs" };
        let names: Vec<_> = tasks.keys().map(|task| format!("`{task}`")).collect();
        let message = format!("`{}` is written by {} {kind}: {}", name.text, names.len(), names.join(", "));
        let mut found = Diagnostic::warning(Code::WrittenByTwoTasks, name.span, message)
            .with_help("let one of them write it, and the others ask that one by variables of their own");
        for (task, span) in tasks {
            found = found.with_label(*span, format!("written in `{task}`"));
        }
        findings.push(found);
    }
}

/// The tasks that run a program.
fn tasks_of(program: &Ident, plan: Option<&TaskPlan>, index: &Index<'_>) -> Vec<String> {
    let Some(plan) = plan else {
        return index.configured_tasks(program).unwrap_or_else(|| vec![program.text.clone()]);
    };
    let runs = |name: &String| name.eq_ignore_ascii_case(&program.text);
    plan.tasks.iter().filter(|task| task.programs.iter().any(runs)).map(|task| task.name.clone()).collect()
}

/// A unit and all that it calls, the standard's blocks left out.
fn reached<'a>(start: &str, units: &BTreeMap<String, &'a Unit<'a>>, index: &Index<'_>) -> Vec<&'a Unit<'a>> {
    let mut seen = BTreeSet::from([start.to_owned()]);
    let mut open = vec![start.to_owned()];
    let mut found = Vec::new();
    while let Some(unit) = open.pop().and_then(|key| units.get(&key)) {
        found.push(*unit);
        for (name, _) in unit.usage.iter().filter(|(_, uses)| uses.is_called) {
            let variable = index.declared(unit.pou, name).map(|(_, variable)| variable).or_else(|| index.global(name));
            let callee = variable.and_then(|variable| index.block(&variable.spec)).or_else(|| index.unit(name));
            if let Some(key) = callee.map(|pou| pou.name.key()).filter(|key| units.contains_key(key))
                && seen.insert(key.clone())
            {
                open.push(key);
            }
        }
    }
    found
}

fn global_writes<'a>(unit: &'a Unit<'_>, index: &Index<'_>) -> impl Iterator<Item = (&'a str, Span)> {
    unit.usage.iter().filter_map(|(name, uses)| {
        let is_global = match index.declared(unit.pou, name) {
            Some((section, _)) => section.kind == SectionKind::External,
            None => unit.pou.name.key() != name && index.global(name).is_some(),
        };
        Some((name, uses.written.filter(|_| is_global)?))
    })
}
