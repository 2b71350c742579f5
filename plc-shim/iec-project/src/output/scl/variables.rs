//! Sections of variables: one of each kind, in the order that TIA Portal exports, one variable per line.

use std::collections::BTreeMap;

use super::body::{self, Body, edge_name};
use super::layout;
use super::names::{Names, Shape, member};
use super::scope::Scope;
use super::spec::{self, refused};
use onescan_iec::diagnostic::Diagnostic;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{
    Edge, Expr, ExprKind, Initialiser, InitialiserKind, Literal, Pou, PouKind, Qualifier, Section, SectionKind,
    TypeSpec, TypeSpecKind, TypedValue, UnaryOp, Variable,
};
use onescan_iec::syntax::token::{Keyword, Punctuation, TokenKind};
use onescan_iec::syntax::{SourceFile, Span};

/// A section of SCL.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Input,
    Output,
    InOut,
    Static,
    Retained,
    Temporary,
    Constant,
}

impl Kind {
    const ALL: [(Self, &'static str); 7] = [
        (Self::Input, "VAR_INPUT"),
        (Self::Output, "VAR_OUTPUT"),
        (Self::InOut, "VAR_IN_OUT"),
        (Self::Static, "VAR"),
        (Self::Retained, "VAR RETAIN"),
        (Self::Temporary, "VAR_TEMP"),
        (Self::Constant, "VAR CONSTANT"),
    ];
}

/// The declarations of a unit, and what its body has to begin with on their behalf.
#[derive(Default)]
pub(super) struct Declarations {
    sections: BTreeMap<Kind, String>,
    pub(super) prologue: Vec<String>,
    pub(super) findings: Vec<Diagnostic>,
}

impl Declarations {
    pub(super) fn add(&mut self, kind: Kind, lines: &str) {
        self.sections.entry(kind).or_default().push_str(lines);
    }

    pub(super) fn text(&self) -> String {
        let sections = Kind::ALL.iter().filter_map(|(kind, words)| {
            let lines = self.sections.get(kind).filter(|lines| !lines.trim().is_empty())?;
            Some(format!("   {words}\n{lines}   END_VAR\n"))
        });
        sections.collect()
    }
}

/// All sections of a unit.
pub(super) fn declarations<'a>(
    names: &Names<'a>,
    scope: &Scope<'a>,
    pou: &'a Pou,
    file: &'a SourceFile,
) -> Declarations {
    let mut all = Declarations::default();
    let mut behind = pou.result.as_ref().map_or(pou.name.span.end, |result| result.span.end);
    for section in &pou.sections {
        let above = layout::comments(file, behind, section.span.start);
        behind = section.span.end;
        let Some(kind) = kind(names, pou, section, &mut all.findings) else { continue };
        let mut writer = Writer { names, scope, file, keeps_nothing: pou.kind.keeps_nothing(), all: &mut all };
        let lines = writer.section(section, kind);
        all.add(kind, &layout::indented(&format!("\n{above}"), 6));
        all.add(kind, &lines);
    }
    all
}

/// What a section becomes; nothing for what SCL does without.
fn kind<'a>(names: &Names<'a>, pou: &Pou, section: &'a Section, findings: &mut Vec<Diagnostic>) -> Option<Kind> {
    let keeps_nothing = pou.kind == PouKind::Function;
    let has = |wanted| section.qualifiers.contains(&wanted);
    let is_elementary =
        |variable: &'a Variable| names.shape(&variable.spec).is_some_and(|shape| shape.elementary().is_some());
    Some(match section.kind {
        SectionKind::External => return None,
        SectionKind::Input => Kind::Input,
        SectionKind::Output => Kind::Output,
        SectionKind::InOut => Kind::InOut,
        SectionKind::Temp => Kind::Temporary,
        SectionKind::Local if has(Qualifier::Constant) => {
            if section.variables.iter().all(is_elementary) {
                Kind::Constant
            } else if keeps_nothing {
                findings.push(refused(section.span, "constant arrays in functions", "declare them in VAR_GLOBAL"));
                return None;
            } else {
                Kind::Static
            }
        }
        SectionKind::Local if keeps_nothing => Kind::Temporary,
        SectionKind::Local if has(Qualifier::Retain) || has(Qualifier::Persistent) => Kind::Retained,
        SectionKind::Local => Kind::Static,
        SectionKind::Static | SectionKind::Instance | SectionKind::Global => {
            findings.push(refused(section.span, "section of this kind", "declare the variables in VAR or VAR_GLOBAL"));
            return None;
        }
    })
}

struct Writer<'w, 'a> {
    names: &'w Names<'a>,
    scope: &'w Scope<'a>,
    file: &'a SourceFile,
    keeps_nothing: bool,
    all: &'w mut Declarations,
}

impl<'a> Writer<'_, 'a> {
    fn section(&mut self, section: &'a Section, kind: Kind) -> String {
        let Some(inner) = inner(self.file, section) else { return String::new() };
        let mut edits = Edits::default();
        for variable in &section.variables {
            self.variable(variable, kind, &mut edits);
        }
        applied(self.file, inner, edits, &mut self.all.findings)
    }

    fn variable(&mut self, variable: &'a Variable, kind: Kind, edits: &mut Edits) {
        let (Some(first), Some(last)) = (variable.names.first(), variable.names.last()) else { return };
        if let Some(address) = &variable.address {
            let help = "declare it without AT, and connect it in the PLC's tag table";
            self.all.findings.push(refused(address.span, "addresses in declarations", help));
        }
        let spec = spec::written(self.names, &self.scope.constants, &variable.spec, &mut self.all.findings);
        let value = self.value(variable, kind);
        for name in &variable.names {
            self.edge(&name.text, variable.edge, kind);
            if let Some(value) = value.as_ref().filter(|_| self.is_assigned(kind)) {
                self.all.prologue.push(format!("#{} := {value};", member(&name.text)));
            }
        }
        let value = value.filter(|_| !self.is_assigned(kind)).map_or(String::new(), |value| format!(" := {value}"));
        let span = first.span.to(last.span);
        replace_declaration(self.file, span, variable, &|name| format!("{name} : {spec}{value};"), edits);
    }

    /// True for what starts over in each call, for which SCL has no initial values.
    fn is_assigned(&self, kind: Kind) -> bool {
        kind == Kind::Temporary || self.keeps_nothing && kind == Kind::Output
    }

    fn edge(&mut self, name: &str, edge: Option<Edge>, kind: Kind) {
        let Some(edge) = edge.filter(|_| kind == Kind::Input) else { return };
        let trigger = edge_name(name, edge);
        let block = if edge == Edge::Rising { "R_TRIG" } else { "F_TRIG" };
        self.all.add(Kind::Static, &format!("      {trigger} : {block};\n"));
        self.all.prologue.push(format!("#{trigger}(CLK := #{});", member(name)));
    }

    /// An initial value that a declaration can have; of others a data block has start values.
    fn value(&mut self, variable: &'a Variable, kind: Kind) -> Option<String> {
        let initial = variable.initial.as_ref()?;
        let own = Scope { locals: BTreeMap::new(), constants: self.scope.constants.clone() };
        let known = self.all.findings.len();
        let found = value(self.names, &own, self.file, &variable.spec, initial, &mut self.all.findings);
        if self.all.findings.len() > known {
            return None;
        }
        if found.is_none() && (kind == Kind::Constant || self.is_assigned(kind) || self.keeps_nothing) {
            let help = "write a literal, or assign it in the body";
            self.all.findings.push(refused(initial.span, "initial value like this here", help));
        }
        found
    }
}

/// The text of a variable's initial value: literals and lists of them.
pub(super) fn value<'a>(
    names: &Names<'a>,
    scope: &Scope<'a>,
    file: &'a SourceFile,
    of: &'a TypeSpec,
    initial: &'a Initialiser,
    findings: &mut Vec<Diagnostic>,
) -> Option<String> {
    match &initial.kind {
        InitialiserKind::Value(expr) => {
            let shape = names.shape(of)?;
            if matches!(shape, Shape::Elementary(_) | Shape::Text { .. }) && is_plain(expr) {
                return literal(names, scope, file, expr, findings);
            }
            // The name of an enumeration's value, or of another constant.
            match (&expr.kind, shape) {
                (ExprKind::Name(name), Shape::Enumeration(_)) => {
                    let value = names.value(&name.key(), enumeration(names, of).as_deref())?;
                    Some(format!("{} (*{}*)", value.number, value.name.text))
                }
                (_, Shape::Elementary(ty)) if ty.is_integer() => {
                    names.integer_with(expr, &scope.constants).map(|value| value.to_string())
                }
                _ => None,
            }
        }
        InitialiserKind::Array(values) => {
            let Some(Shape::Array(element)) = names.shape(of) else { return None };
            let is_plain = |each: &Initialiser| match &each.kind {
                InitialiserKind::Value(expr) => is_plain(expr),
                _ => false,
            };
            if !values.iter().all(is_plain) || names.shape(element)?.elementary().is_none() {
                return None;
            }
            let values: Option<Vec<String>> =
                values.iter().map(|each| value(names, scope, file, element, each, findings)).collect();
            Some(format!("[{}]", values?.join(", ")))
        }
        _ => None,
    }
}

/// The key of the enumeration that a type comes to.
fn enumeration(names: &Names<'_>, of: &TypeSpec) -> Option<String> {
    let TypeSpecKind::Name(name) = &of.kind else { return None };
    let named = names.types.get(&name.key())?;
    match &named.spec.kind {
        TypeSpecKind::Enumeration(..) => Some(name.key()),
        _ => enumeration(names, &named.spec),
    }
}

/// A literal, also with a sign.
fn is_plain(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(Literal::Typed { value: TypedValue::Name(_), .. }) => false,
        ExprKind::Literal(_) => true,
        ExprKind::Unary(UnaryOp::Negate, inner) => is_plain(inner),
        _ => false,
    }
}

fn literal<'a>(
    names: &Names<'a>,
    scope: &Scope<'a>,
    file: &'a SourceFile,
    expr: &Expr,
    findings: &mut Vec<Diagnostic>,
) -> Option<String> {
    let mut body = Body::new(names, scope, file);
    body::expression(&mut body, expr);
    findings.append(&mut body.findings);
    let place = expr.span.start..expr.span.end;
    let edited = body.edits.take_within(&place).apply(layout::part(file, place.start, place.end)).ok()?;
    Some(edited.text)
}

/// What stands between the words of a section.
fn inner(file: &SourceFile, section: &Section) -> Option<(u32, u32)> {
    let first = section.variables.first()?.names.first()?.span.start;
    let tokens = layout::tokens(file, section.span.start, section.span.end);
    let before = tokens.iter().rev().find(|token| token.end <= first && !token.kind.is_trivia())?;
    let end = tokens.iter().rev().find(|token| token.kind == TokenKind::Keyword(Keyword::EndVar))?;
    Some((before.end, end.start))
}

/// Puts `written` in the place of a declaration, once for each of its names, a line each.
pub(super) fn replace_declaration(
    file: &SourceFile,
    names: Span,
    variable: &Variable,
    written: &dyn Fn(&str) -> String,
    edits: &mut Edits,
) {
    let all: Vec<String> = variable.names.iter().map(|name| written(&member(&name.text))).collect();
    replace_lines(file, names, &all, edits);
}

/// Puts `lines` in the place of what begins at `begin` and ends with a semicolon.
pub(super) fn replace_lines(file: &SourceFile, begin: Span, lines: &[String], edits: &mut Edits) {
    let text = file.text();
    let before = text.get(..begin.start as usize).unwrap_or("");
    let line = before.rsplit('\n').next().unwrap_or("");
    let is_first = line.trim().is_empty();
    let indent: String = line.chars().take_while(|one| one.is_whitespace()).collect();
    let next = format!("\n{indent}");
    let mut written = lines.join(&next);
    if !is_first {
        written.insert_str(0, &next);
    }
    edits.replace(begin.start..semicolon(file, begin.start), written);
}

/// Where a declaration ends, its semicolon included.
pub(super) fn semicolon(file: &SourceFile, from: u32) -> u32 {
    let rest = file.text().get(from as usize..).unwrap_or("");
    let is_end = |kind| kind == TokenKind::Punctuation(Punctuation::Semicolon);
    let tokens = onescan_iec::syntax::tokenize_in(file.dialect(), rest);
    tokens.iter().find(|token| is_end(token.kind)).map_or(from, |token| from + token.end)
}

/// A changed part of a file, indented as a section's lines are.
pub(super) fn applied(
    file: &SourceFile,
    (start, end): (u32, u32),
    mut edits: Edits,
    findings: &mut Vec<Diagnostic>,
) -> String {
    match edits.take_within(&(start..end)).apply(layout::part(file, start, end)) {
        Ok(edited) => layout::indented(&layout::with_comments(&edited.text, file.dialect()), 6),
        Err(conflict) => {
            findings.push(body::conflict(Span::new(onescan_iec::syntax::FileId(0), conflict.at, conflict.at)));
            String::new()
        }
    }
}
