//! Data blocks, and the organization blocks that call programs.

use std::collections::BTreeMap;

use super::layout;
use super::names::{Global, Names, RETAINED_GLOBALS, Shape, member, quoted};
use super::scope::Scope;
use super::spec;
use super::unit::HEAD;
use super::variables::{semicolon, value};
use onescan_iec::diagnostic::Diagnostic;
use onescan_iec::syntax::constant::Constants;
use onescan_iec::task_plan::Task;

/// Start values by data block: paths within it, and literals.
pub(crate) type StartValues = BTreeMap<String, Vec<(String, String)>>;

/// What stands behind the declarations of a data block.
fn start_values(block: &str, values: &StartValues) -> String {
    let lines = values.get(block).into_iter().flatten();
    let lines: String = lines.map(|(path, value)| format!("   {path} := {value};\n")).collect();
    format!("\nBEGIN\n{lines}END_DATA_BLOCK\n")
}

/// A data block of a type, as an instance or as a structure.
pub(super) fn of_type(name: &str, ty: &str, is_retained: bool, values: &StartValues) -> String {
    let retention = if is_retained { "" } else { "NON_RETAIN\n" };
    format!("DATA_BLOCK {}\n{HEAD}{retention}{ty}\n{}", quoted(name), start_values(name, values))
}

/// The data block of the global variables that are members of `home`; nothing if there are none.
pub(super) fn globals<'a>(
    names: &Names<'a>,
    home: &str,
    values: &StartValues,
    findings: &mut Vec<Diagnostic>,
) -> Option<String> {
    let mut members: Vec<&Global<'a>> =
        names.globals.values().filter(|global| is_member(names, global, home)).collect();
    members.sort_by_key(|global| (global.name.span.file, global.name.span.start));
    if members.is_empty() {
        return None;
    }
    let lines: String = members.into_iter().map(|global| declaration(names, global, findings)).collect();
    let retention = if home == RETAINED_GLOBALS { "" } else { "NON_RETAIN\n" };
    let head = format!("DATA_BLOCK {}\n{HEAD}{retention}   STRUCT\n", quoted(home));
    Some(format!("{head}{lines}   END_STRUCT;\n{}", start_values(home, values)))
}

fn is_member<'a>(names: &Names<'a>, global: &Global<'a>, home: &str) -> bool {
    let is_constant = global.is_constant
        && names
            .shape(&global.variable.spec)
            .is_some_and(|shape| matches!(shape, Shape::Elementary(_) | Shape::Enumeration(_)));
    names.is_own(global.name.span.file) && names.home(global) == Some(home) && !is_constant
}

fn declaration<'a>(names: &Names<'a>, global: &Global<'a>, findings: &mut Vec<Diagnostic>) -> String {
    if let Some(address) = &global.variable.address {
        let help = "declare it without AT, and connect it in the PLC's tag table";
        findings.push(spec::refused(address.span, "addresses in declarations", help));
    }
    let Some(file) = names.sources.get(global.name.span.file) else { return String::new() };
    let constants = Constants::new();
    let spec = spec::written(names, &constants, &global.variable.spec, findings);
    let scope = Scope { locals: BTreeMap::new(), constants };
    let initial = global.variable.initial.as_ref();
    let initial = initial.and_then(|initial| value(names, &scope, file, &global.variable.spec, initial, findings));
    let initial = initial.map_or(String::new(), |value| format!(" := {value}"));
    let is_last = global.variable.names.last().is_some_and(|last| last.span == global.name.span);
    let end = semicolon(file, global.name.span.end);
    let comment = if is_last { layout::comment_behind(file, end) } else { String::new() };
    format!("      {} : {spec}{initial};{comment}\n", member(&global.name.text))
}

/// The organization block of a task.
pub(crate) fn block_of_task(task: &str) -> String {
    format!("OB_{task}")
}

/// An organization block that calls a task's programs in their order.
pub(super) fn task(task: &Task) -> String {
    let calls: String = task.programs.iter().map(|program| format!("    {}();\n", quoted(program))).collect();
    let interval = task.interval.map_or_else(|| "cycle".to_owned(), |interval| interval.to_string());
    format!(
        "// Task {}: every {interval}, which is set in the block's properties.\nORGANIZATION_BLOCK {}\n{HEAD}BEGIN\n\
         {calls}END_ORGANIZATION_BLOCK\n",
        task.name,
        quoted(&block_of_task(&task.name)),
    )
}
