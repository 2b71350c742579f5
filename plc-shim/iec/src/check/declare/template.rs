//! Generic blocks (CODESYS, TwinCAT: `VAR_GENERIC CONSTANT`): each list of constants that a text gives one makes a block of
//! its own, `List<8>`, whose constants have these values.
//!
//! What is made must be known before bases are linked, and the constants are expressions that see those of the unit
//! that gives them. So the declarations are read once for each level of blocks in one another, as far as constants
//! need, and what is made of them is declared like any other unit beside its template.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::demand::Resolve;
use super::namespace::{Home, joined};
use super::start::Stages;
use super::{Declarations, MAX_DEPTH, Overrides};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{MemoryLimit, PouId};
use crate::syntax::ast::{
    CompilationUnit, Expr, ExprKind, Ident, Initialiser, InitialiserKind, Literal, Pou, TemplateUse, Variable,
};
use crate::syntax::{FileId, Span};

/// More blocks than these made of generic ones are a circle that grows.
const MAX_MADE: usize = 4096;

/// What generic blocks are made into.
#[derive(Debug, Default)]
pub(in crate::check) struct Templates {
    /// What is made, with its full key, in the order in which it was found.
    made: Vec<(String, Pou)>,
    /// Full keys of what is made, by the full key of the unit that names it and by where.
    named: BTreeMap<(String, FileId, u32), String>,
    /// Where the constants given are wrong.
    wrong: BTreeSet<(FileId, u32)>,
    /// What is wrong with them.
    findings: Vec<Diagnostic>,
}

impl Templates {
    pub(in crate::check) fn of(
        units: &[(FileId, &CompilationUnit)],
        (library, stages): (&BTreeSet<FileId>, &Stages),
        (overrides, limit): (&Overrides, MemoryLimit),
        resolver: &'static dyn Resolve,
    ) -> Self {
        let mut all = Self::default();
        let uses: Vec<&TemplateUse> = units.iter().flat_map(|(_, unit)| &unit.templates).collect();
        if uses.is_empty() {
            return all;
        }
        for depth in 0..=MAX_DEPTH {
            let mut found = {
                let mut declarations = Declarations::new(library, (stages, &all), (overrides, limit), resolver);
                declarations.collect(units);
                declarations.made_by(&uses)
            };
            let before = all.made.len();
            let is_circle = depth == MAX_DEPTH || before + found.made.len() > MAX_MADE;
            if let (true, Some((_, first))) = (is_circle, found.made.first()) {
                let message = format!("`{}` is a generic block that is made of ever more", first.name.text);
                all.wrong.extend(found.named.keys().map(|(_, file, start)| (*file, *start)));
                all.findings.push(Diagnostic::error(Code::NestingTooDeep, first.name.span, message));
                return all;
            }
            all.named.append(&mut found.named);
            (all.findings, all.wrong) = (found.findings, found.wrong);
            all.made.append(&mut found.made);
            if all.made.len() == before {
                break;
            }
        }
        all
    }

    /// What is made of a generic block.
    pub(super) fn made_of(&self, template: &Pou) -> impl Iterator<Item = &Pou> {
        let place = template.name.span;
        self.made.iter().map(|(_, pou)| pou).filter(move |pou| pou.name.span == place)
    }

    fn has(&self, key: &str) -> bool {
        self.made.iter().any(|(known, _)| known == key)
    }

    /// What is wrong with the constants given.
    pub(in crate::check) fn findings(&self) -> &[Diagnostic] {
        &self.findings
    }

    pub(in crate::check) fn is_empty(&self) -> bool {
        self.made.is_empty()
    }
}

impl Declarations<'_> {
    /// The unit that a name means in a unit: what is made of a generic block, or any other.
    pub(in crate::check) fn unit_meant(&self, unit: Option<PouId>, name: &Ident) -> Option<PouId> {
        if !name.text.contains('<') {
            return self.pou_named(&name.key());
        }
        let place = (self.context(unit), name.span.file, name.span.start);
        self.unit_of_key(self.templates.named.get(&place)?)
    }

    /// True if a generic block is named there with constants that are wrong, which has been reported.
    pub(in crate::check) fn is_wrong_template(&self, name: &Ident) -> bool {
        self.templates.wrong.contains(&(name.span.file, name.span.start))
    }

    /// The full key of the unit whose text names something: that of a method is its owner's.
    fn context(&self, unit: Option<PouId>) -> String {
        unit.map_or_else(String::new, |id| self.key_of(self.owner_of(id)))
    }

    pub(super) fn key_of(&self, id: PouId) -> String {
        let entry = self.pou(id);
        entry.home.key(&entry.ast.name)
    }

    /// True for a generic block that nothing can be said of by itself: its constants have no values.
    pub(super) fn lacks_constants(&self, id: PouId) -> bool {
        let ast = self.pou(self.owner_of(id)).ast;
        ast.sections
            .iter()
            .any(|section| section.is_generic() && section.variables.iter().any(|variable| variable.initial.is_none()))
    }
}

impl<'a> Declarations<'a> {
    /// What the texts make of generic blocks that is not made yet.
    fn made_by(&mut self, uses: &[&'a TemplateUse]) -> Templates {
        let mut found = Templates::default();
        for each in uses {
            let units = self.units_around(each.span);
            for (unit, home) in units {
                self.at_home(home, |declarations| declarations.make(each, unit, &mut found));
            }
        }
        found
    }

    /// The units in whose text a place lies, a generic block and all that is made of it, and from where names are seen.
    fn units_around(&self, span: Span) -> Vec<(Option<PouId>, Arc<Home>)> {
        let inside = |pou: &Pou| pou.span.file == span.file && pou.span.start <= span.start && span.end <= pou.span.end;
        let around = |id: &PouId| {
            let ast = self.pou(*id).ast;
            self.pou(*id).membership.is_none()
                && (inside(ast) || ast.object.members.iter().any(|member| inside(&member.pou)))
        };
        let units: Vec<_> = self.unit_ids().filter(around).map(|id| (Some(id), self.pou(id).home.clone())).collect();
        if !units.is_empty() {
            return units;
        }
        let holds = |whole: Span| whole.file == span.file && whole.start <= span.start && span.end <= whole.end;
        let ty = self.type_names.values().find(|entry| holds(entry.ast.spec.span)).map(|entry| &entry.home);
        let globals = self.globals.values().filter(|entry| entry.ast.is_some_and(|(ast, _)| holds(ast.spec.span)));
        let home = ty.or(globals.map(|entry| &entry.seen_from).next()).cloned();
        vec![(None, home.unwrap_or_default())]
    }

    fn make(&mut self, used: &TemplateUse, unit: Option<PouId>, found: &mut Templates) {
        let Some(template) = self.pou_named(&used.template.key()) else { return };
        let ast = self.pou(template).ast;
        let wanted: Vec<&Variable> = generic_variables(ast).collect();
        let count: usize = wanted.iter().map(|variable| variable.names.len()).sum();
        if count != used.arguments.len() {
            let (name, given) = (&ast.name.text, used.arguments.len());
            let message = match count {
                0 => format!("`{name}` is not a generic block"),
                1 => format!("`{name}` has one generic constant, {given} are given"),
                _ => format!("`{name}` has {count} generic constants, {given} are given"),
            };
            return found.report(used, Diagnostic::error(Code::TooManyArguments, used.span, message));
        }
        let mark = self.mark();
        let resolver = self.resolver;
        let values: Option<Vec<i128>> =
            used.arguments.iter().map(|argument| resolver.template_argument(self, unit, argument)).collect();
        // What is wrong with the declarations themselves is reported when they are checked.
        let wrong = self.found_since(mark).iter().filter(|each| {
            let (all, part) = (used.span, each.span);
            part.file == all.file && all.start <= part.start && part.end <= all.end
        });
        wrong.cloned().for_each(|each| found.report(used, each));
        let Some(values) = values else { return };
        let text: Vec<String> = values.iter().map(i128::to_string).collect();
        let name = format!("{}<{}>", ast.name.text, text.join(","));
        let name = Ident { text: name, span: ast.name.span };
        let key = joined(&self.pou(template).home.namespace, &name.key());
        let place = (self.context(unit), used.span.file, used.span.start);
        found.named.insert(place, key.clone());
        if !self.templates.has(&key) && !found.has(&key) {
            found.made.push((key, with_values(ast, name, &used.arguments, &values)));
        }
    }
}

impl Templates {
    fn report(&mut self, used: &TemplateUse, found: Diagnostic) {
        self.wrong.insert((used.span.file, used.span.start));
        let known = |each: &Diagnostic| each.code == found.code && each.span == found.span;
        if !self.findings.iter().any(known) {
            self.findings.push(found);
        }
    }
}

/// The constants of a generic block.
fn generic_variables(ast: &Pou) -> impl Iterator<Item = &Variable> {
    ast.sections.iter().filter(|section| section.is_generic()).flat_map(|section| &section.variables)
}

/// A generic block whose constants have these values.
fn with_values(ast: &Pou, name: Ident, arguments: &[Expr], values: &[i128]) -> Pou {
    let mut made = Pou { name, ..ast.clone() };
    let mut given = arguments.iter().zip(values);
    for section in made.sections.iter_mut().filter(|section| section.is_generic()) {
        let mut variables = Vec::new();
        for variable in &section.variables {
            for (name, (argument, value)) in variable.names.iter().zip(&mut given) {
                let literal = ExprKind::Literal(Literal::Integer(*value));
                let value = Expr { kind: literal, span: argument.span, height: 1 };
                let initial = Initialiser { kind: InitialiserKind::Value(value), span: argument.span };
                variables.push(Variable { names: vec![name.clone()], initial: Some(initial), ..variable.clone() });
            }
        }
        section.variables = variables;
    }
    made
}
