//! Structures as data types of TIA Portal.

use std::collections::BTreeMap;

use super::layout;
use super::names::{Names, Shape, member};
use super::scope::Scope;
use super::spec::{self, refused};
use super::variables::{applied, replace_lines, value};
use onescan_iec::diagnostic::Diagnostic;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::ast::{Field, TypeDeclaration, TypeSpecKind};
use onescan_iec::syntax::constant::Constants;
use onescan_iec::syntax::token::{Keyword, TokenKind};

/// A structure with the comments above it; nothing for a type that its uses are written without.
pub(super) fn structure<'a>(
    names: &Names<'a>,
    named: &'a TypeDeclaration,
    above: &str,
    findings: &mut Vec<Diagnostic>,
) -> Option<String> {
    let file = names.sources.get(named.name.span.file)?;
    if let Some(base) = &named.extends {
        findings.push(refused(base.span, "structures that extend others", "declare a member of that structure"));
    }
    if matches!(named.spec.kind, TypeSpecKind::Union(_) | TypeSpecKind::Overlapping(_)) {
        findings.push(spec::refused_union(named.name.span));
    }
    let TypeSpecKind::Struct(fields) = &named.spec.kind else { return None };
    let mut edits = Edits::default();
    let mut rest = fields.as_slice();
    while let Some(first) = rest.first() {
        // `X, Z : LREAL` are two members of one declaration.
        let count = rest.iter().take_while(|field| field.spec.span == first.spec.span).count();
        let (group, others) = rest.split_at(count.max(1));
        rest = others;
        members(names, file, group, &mut edits, findings);
    }
    let lines = applied(file, inner(file, named), edits, findings);
    let name = names.block(&named.name.text);
    Some(format!("{above}TYPE {name}\nVERSION : 0.1\n   STRUCT\n{lines}   END_STRUCT;\n\nEND_TYPE\n"))
}

fn members<'a>(
    names: &Names<'a>,
    file: &'a SourceFile,
    group: &'a [Field],
    edits: &mut Edits,
    findings: &mut Vec<Diagnostic>,
) {
    let Some(first) = group.first() else { return };
    if let Some(address) = &first.address {
        findings.push(refused(address.span, "addresses of members", "leave the address out"));
    }
    if let Some(Shape::Block(_)) = names.shape(&first.spec) {
        let help = "declare the instance in a function block, or in VAR_GLOBAL";
        findings.push(refused(first.spec.span, "instances of function blocks in structures", help));
    }
    let constants = Constants::new();
    let scope = Scope { locals: BTreeMap::new(), constants: Constants::new() };
    let spec = spec::written(names, &constants, &first.spec, findings);
    let initial = first.initial.as_ref().and_then(|initial| value(names, &scope, file, &first.spec, initial, findings));
    let initial = initial.map_or(String::new(), |value| format!(" := {value}"));
    let lines: Vec<String> =
        group.iter().map(|field| format!("{} : {spec}{initial};", member(&field.name.text))).collect();
    replace_lines(file, first.name.span, &lines, edits);
}

/// What stands between `STRUCT` and `END_STRUCT`.
fn inner(file: &SourceFile, named: &TypeDeclaration) -> (u32, u32) {
    let tokens = layout::tokens(file, named.spec.span.start, named.spec.span.end);
    let of = |keyword| move |token: &&onescan_iec::syntax::token::Token| token.kind == TokenKind::Keyword(keyword);
    let start = tokens.iter().find(of(Keyword::Struct)).map_or(named.spec.span.start, |token| token.end);
    let end = tokens.iter().rev().find(of(Keyword::EndStruct)).map_or(named.spec.span.end, |token| token.start);
    (start, end)
}
