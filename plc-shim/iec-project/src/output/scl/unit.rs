//! Units: functions, function blocks, and programs, which become function blocks.

use super::body::{self, Body};
use super::layout;
use super::names::{Names, member, quoted};
use super::scope::Scope;
use super::spec::{self, refused};
use super::variables::{self, Kind};
use onescan_iec::diagnostic::Diagnostic;
use onescan_iec::syntax::ast::{Pou, PouKind};
use onescan_iec::syntax::{SourceFile, Span};

/// The attributes of a block whose variables the system places, and its version.
pub(super) const HEAD: &str = "{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\n";

/// The function block of a program; its instance has the program's name.
pub(super) fn block_of_program(program: &str) -> String {
    format!("{program}_Program")
}

/// What of a unit SCL lacks as a whole.
fn unsuited(pou: &Pou) -> Option<Diagnostic> {
    let object = &pou.object;
    let at = pou.name.span;
    if !pou.chart.is_empty() {
        return Some(refused(at, "charts", "draw it in GRAPH of TIA Portal, or write the steps as CASE"));
    }
    if matches!(pou.kind, PouKind::Class | PouKind::Interface | PouKind::Method | PouKind::Action) {
        return Some(refused(at, "classes, interfaces, methods and actions", "write a function block"));
    }
    if let Some(section) = pou.sections.iter().find(|section| section.is_generic()) {
        return Some(refused(section.span, "generic blocks", "write a block for each list of constants"));
    }
    if let Some(member) = object.members.first() {
        let help = "write a function, or a function block of its own";
        return Some(refused(member.pou.name.span, "methods, properties and actions", help));
    }
    if let Some(base) = object.extends.first().or(object.implements.first()) {
        return Some(refused(base.span, "inheritance", "declare an instance of the base in the function block"));
    }
    None
}

/// A unit in SCL, with the comments above it.
pub(super) fn unit<'a>(names: &Names<'a>, pou: &'a Pou, above: &str, findings: &mut Vec<Diagnostic>) -> String {
    let Some(file) = names.sources.get(pou.name.span.file) else { return String::new() };
    if let Some(found) = unsuited(pou) {
        findings.push(found);
        return String::new();
    }
    let scope = Scope::of(pou);
    let mut declarations = variables::declarations(names, &scope, pou, file);
    let mut body = Body::new(names, &scope, file);
    body::statements(&mut body, &pou.body);
    let statements = statements(pou, file, &mut body);
    findings.append(&mut body.findings);
    findings.append(&mut declarations.findings);
    let mut constants: Vec<_> = body.constants.into_values().collect();
    constants.sort_by(|one, other| {
        (&one.of, &one.value.len(), &one.value).cmp(&(&other.of, &other.value.len(), &other.value))
    });
    for constant in constants {
        let name = member(&constant.name);
        let line = format!("      {name} : {} := {}; // {}\n", constant.ty, constant.value, constant.of);
        declarations.add(Kind::Constant, &line);
    }
    let prologue: String = declarations.prologue.iter().map(|line| format!("    {line}\n")).collect();
    let (opening, end) = words(names, pou, &scope, findings);
    let text = declarations.text();
    format!("{above}{opening}\n{HEAD}{text}BEGIN\n{prologue}{statements}{end}\n")
}

/// The first line of a unit, and its last.
fn words<'a>(
    names: &Names<'a>,
    pou: &'a Pou,
    scope: &Scope<'a>,
    findings: &mut Vec<Diagnostic>,
) -> (String, &'static str) {
    match pou.kind {
        PouKind::Function => {
            let result = pou.result.as_ref().map(|spec| spec::written(names, &scope.constants, spec, findings));
            let result = result.unwrap_or_else(|| "Void".to_owned());
            (format!("FUNCTION {} : {result}", names.block(&pou.name.text)), "END_FUNCTION")
        }
        PouKind::Program => {
            (format!("FUNCTION_BLOCK {}", quoted(&block_of_program(&pou.name.text))), "END_FUNCTION_BLOCK")
        }
        _ => (format!("FUNCTION_BLOCK {}", names.block(&pou.name.text)), "END_FUNCTION_BLOCK"),
    }
}

/// The changed text behind the declarations.
fn statements(pou: &Pou, file: &SourceFile, body: &mut Body<'_, '_>) -> String {
    let head = pou.result.as_ref().map_or(pou.name.span.end, |result| result.span.end);
    let start = pou.sections.last().map_or(head, |section| section.span.end);
    let tokens = layout::tokens(file, start, pou.span.end);
    let end = tokens.iter().rev().find(|token| !token.kind.is_trivia()).map_or(pou.span.end, |token| token.start);
    let edits = body.edits.take_within(&(start..end));
    match edits.apply(layout::part(file, start, end)) {
        Ok(edited) => {
            let text = layout::with_comments(&edited.text, file.dialect());
            layout::indented(&text, 4)
        }
        Err(conflict) => {
            body.findings.push(body::conflict(Span::new(pou.name.span.file, start + conflict.at, start + conflict.at)));
            String::new()
        }
    }
}
