//! The whole file: types, functions, function blocks, programs and a CONFIGURATION, in which all programs are in one
//! task, in the order of the line.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::Page;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Declaration, Pou, PouKind, Qualifier, Section, TypeDeclaration, TypeSpecKind};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::TokenKind;

/// The one task, and the instances of programs in it, each with its program.
pub(crate) struct Cycle {
    /// As a literal of the standard.
    pub(crate) interval: String,
    pub(crate) programs: Vec<(String, String)>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Global {
    pub(crate) name: String,
    /// Its type as written.
    pub(crate) ty: String,
    /// Its address, if the text gives it one.
    pub(crate) address: Option<String>,
}

/// The global variables of a text, and all names and addresses in it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Globals {
    pub(crate) variables: Vec<Global>,
    /// Every name that stands in the text, in capitals.
    pub(crate) names: BTreeSet<String>,
    /// Every direct address in it, in capitals.
    pub(crate) addresses: BTreeSet<String>,
}

pub(super) fn globals(page: &Page<'_>) -> Globals {
    let mut found = Globals::default();
    for (_, section) in page.sections().into_iter().filter(|(pou, _)| pou.is_none()) {
        for variable in &section.variables {
            let address = variable.address.as_ref().map(|address| address.text.clone());
            let ty = page.text(variable.spec.span).to_owned();
            let global = |name: &str| Global { name: name.to_owned(), ty: ty.clone(), address: address.clone() };
            found.variables.extend(variable.names.iter().map(|name| global(&name.text)));
        }
    }
    for token in tokenize_in(page.file.dialect(), page.file.text()) {
        let written = || page.file.text().get(token.start as usize..token.end as usize).unwrap_or("").to_uppercase();
        match token.kind {
            TokenKind::Identifier | TokenKind::Keyword(_) => {
                found.names.insert(written());
            }
            TokenKind::DirectAddress => {
                found.addresses.insert(written());
            }
            _ => {}
        }
    }
    found
}

pub(super) fn whole(page: &Page<'_>, addresses: &BTreeMap<String, String>, cycle: &Cycle) -> String {
    let mut parts = types(page);
    for kind in [PouKind::Function, PouKind::FunctionBlock, PouKind::Program] {
        parts.extend(page.pous().filter(|pou| pou.kind == kind).map(|pou| with_comment(page, pou)));
    }
    parts.push(configuration(page, addresses, cycle));
    parts.join("\n\n") + "\n"
}

/// A unit with the comment that stands right before it.
fn with_comment(page: &Page<'_>, pou: &Pou) -> String {
    let tokens = tokenize_in(page.file.dialect(), page.file.text());
    let before: Vec<_> = tokens.iter().filter(|token| token.end <= pou.span.start).collect();
    let mut start = pou.span.start;
    for token in before.iter().rev() {
        let written = page.file.text().get(token.start as usize..token.end as usize).unwrap_or("");
        match token.kind {
            TokenKind::Whitespace if written.matches('\n').count() <= 2 => {}
            TokenKind::BlockComment => start = token.start,
            _ => break,
        }
    }
    page.text(Span { start, ..pou.span }).to_owned()
}

/// The types, each behind those that it is made of; enumerations have become integers.
fn types(page: &Page<'_>) -> Vec<String> {
    let named = page.unit.declarations.iter().filter_map(|declaration| match declaration {
        Declaration::Type(named) => Some(named),
        _ => None,
    });
    let mut left: Vec<&TypeDeclaration> =
        named.filter(|named| !matches!(named.spec.kind, TypeSpecKind::Enumeration(..))).collect();
    let mut written = Vec::new();
    while !left.is_empty() {
        let names: BTreeSet<String> = left.iter().map(|named| named.name.key()).collect();
        let is_ready = |named: &&&TypeDeclaration| {
            let own = named.name.key();
            !words(page, named.spec.span).iter().any(|word| *word != own && names.contains(word))
        };
        // A checked project has no circles; one that has stays as it is.
        let ready = left.iter().find(is_ready).or(left.first()).copied();
        let Some(ready) = ready else { break };
        written.push(declaration(page, ready));
        left.retain(|named| !std::ptr::eq(*named, ready));
    }
    written
}

fn words(page: &Page<'_>, span: Span) -> BTreeSet<String> {
    let text = page.text(span);
    let tokens = tokenize_in(page.file.dialect(), text);
    let names = tokens.iter().filter(|token| token.kind == TokenKind::Identifier);
    names.map(|token| text.get(token.start as usize..token.end as usize).unwrap_or("").to_uppercase()).collect()
}

fn declaration(page: &Page<'_>, named: &TypeDeclaration) -> String {
    let initial = named.initial.as_ref().map(|initial| format!(" := {}", page.text(initial.span))).unwrap_or_default();
    let spec = match &named.spec.kind {
        TypeSpecKind::Struct(fields) => {
            let field = |field: &onescan_iec::syntax::ast::Field| {
                let initial = field
                    .initial
                    .as_ref()
                    .map(|initial| format!(" := {}", page.text(initial.span)))
                    .unwrap_or_default();
                format!("        {} : {}{initial};\n", field.name.text, page.text(field.spec.span))
            };
            let fields: String = fields.iter().map(field).collect();
            format!("STRUCT\n{fields}    END_STRUCT")
        }
        _ => page.text(named.spec.span).to_owned(),
    };
    format!("TYPE\n    {} : {spec}{initial};\nEND_TYPE", named.name.text)
}

fn configuration(page: &Page<'_>, addresses: &BTreeMap<String, String>, cycle: &Cycle) -> String {
    let mut text = String::from("CONFIGURATION Config0\n");
    for (_, section) in page.sections().into_iter().filter(|(pou, _)| pou.is_none()) {
        text += &variables(page, section, addresses);
    }
    text += "    RESOURCE Res0 ON PLC\n";
    let _ = writeln!(text, "        TASK SDSP_Cycle(INTERVAL := {}, PRIORITY := 0);", cycle.interval);
    for (instance, program) in &cycle.programs {
        let _ = writeln!(text, "        PROGRAM {instance} WITH SDSP_Cycle : {program};");
    }
    text + "    END_RESOURCE\nEND_CONFIGURATION"
}

fn variables(page: &Page<'_>, section: &Section, addresses: &BTreeMap<String, String>) -> String {
    let qualifier = section.qualifiers.iter().find_map(|qualifier| match qualifier {
        Qualifier::Constant => Some(" CONSTANT"),
        Qualifier::Retain | Qualifier::Persistent => Some(" RETAIN"),
        _ => None,
    });
    if section.variables.is_empty() {
        return String::new();
    }
    let mut text = format!("    VAR_GLOBAL{}\n", qualifier.unwrap_or(""));
    for variable in &section.variables {
        for name in &variable.names {
            let chosen = addresses.get(&name.key()).cloned();
            let address = variable.address.as_ref().map(|address| address.text.clone()).or(chosen);
            let at = address.map(|address| format!(" AT {address}")).unwrap_or_default();
            let initial =
                variable.initial.as_ref().map(|initial| format!(" := {}", page.text(initial.span))).unwrap_or_default();
            let _ = writeln!(text, "        {}{at} : {}{initial};", name.text, page.text(variable.spec.span));
        }
    }
    text + "    END_VAR\n"
}
