//! What a unit does with each name.

use std::collections::BTreeMap;

use super::index::Index;

use crate::syntax::Span;
use crate::syntax::ast::{
    Argument, Call, Expr, ExprKind, Ident, Initialiser, InitialiserKind, Pou, Section, TypeSpec, TypeSpecKind,
};
use crate::syntax::walk::{self, Visitor, root};

/// What is done with the variables of each name, whatever they are.
#[derive(Debug, Default)]
pub(super) struct Usage {
    names: BTreeMap<String, Uses>,
    /// A direct address of an output is written: any that is located there may be meant.
    pub(super) writes_outputs: bool,
}

/// What is done with one name.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Uses {
    pub(super) is_read: bool,
    /// Where it is written first.
    pub(super) written: Option<Span>,
    pub(super) is_called: bool,
    /// It is an argument of a call, which may do anything with it.
    pub(super) is_passed: bool,
}

impl Uses {
    pub(super) fn is_used(self) -> bool {
        self.is_read || self.written.is_some() || self.is_called || self.is_passed
    }
}

impl Usage {
    pub(super) fn of<'a>(pou: &'a Pou, index: &Index<'a>) -> Self {
        let mut collector = Collector { index, usage: Self::default() };
        for each in index.users(pou) {
            for section in &each.sections {
                collector.section(section);
            }
            walk::unit(each, &mut collector);
            index.constants_given(Some(each)).for_each(|value| walk::expression(value, &mut collector));
        }
        collector.usage
    }

    /// What declarations outside of units do: constants in bounds and initial values.
    pub(super) fn of_globals(index: &Index<'_>) -> Self {
        let mut collector = Collector { index, usage: Self::default() };
        for section in index.globals() {
            collector.section(section);
        }
        for spec in index.type_specs() {
            collector.spec(spec);
        }
        index.constants_given(None).for_each(|value| walk::expression(value, &mut collector));
        let (read, written) = index.configured();
        for expr in read {
            walk::expression(expr, &mut collector);
        }
        for expr in written {
            collector.target(expr);
        }
        collector.usage
    }

    pub(super) fn get(&self, key: &str) -> Uses {
        self.names.get(key).copied().unwrap_or_default()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, Uses)> {
        self.names.iter().map(|(key, uses)| (key.as_str(), *uses))
    }
}

struct Collector<'a> {
    index: &'a Index<'a>,
    usage: Usage,
}

impl Collector<'_> {
    fn uses(&mut self, name: &Ident) -> &mut Uses {
        self.usage.names.entry(name.key()).or_default()
    }

    fn section(&mut self, section: &Section) {
        for variable in &section.variables {
            self.spec(&variable.spec);
            variable.initial.iter().for_each(|initial| self.initialiser(initial));
        }
    }

    fn spec(&mut self, spec: &TypeSpec) {
        match &spec.kind {
            TypeSpecKind::Array(dimensions, element) => {
                for dimension in dimensions {
                    walk::expression(&dimension.low, self);
                    walk::expression(&dimension.high, self);
                }
                self.spec(element);
            }
            TypeSpecKind::Reference(_, target) | TypeSpecKind::OpenArray(_, target) => self.spec(target),
            TypeSpecKind::String(_, Some(length)) => walk::expression(length, self),
            TypeSpecKind::Instance(_, arguments) => {
                arguments.values().for_each(|value| walk::expression(value, self));
            }
            TypeSpecKind::Subrange(_, bounds) => {
                walk::expression(&bounds.low, self);
                walk::expression(&bounds.high, self);
            }
            TypeSpecKind::Struct(fields) | TypeSpecKind::Overlapping(fields) | TypeSpecKind::Union(fields) => {
                for field in fields {
                    self.spec(&field.spec);
                    field.initial.iter().for_each(|initial| self.initialiser(initial));
                }
            }
            TypeSpecKind::Enumeration(values, _) => {
                values.iter().filter_map(|value| value.value.as_ref()).for_each(|value| walk::expression(value, self));
            }
            _ => {}
        }
    }

    fn initialiser(&mut self, initialiser: &Initialiser) {
        match &initialiser.kind {
            InitialiserKind::Value(value) => walk::expression(value, self),
            InitialiserKind::Array(values) => values.iter().for_each(|value| self.initialiser(value)),
            InitialiserKind::Repeat(times, value) => {
                walk::expression(times, self);
                if let Some(value) = value {
                    self.initialiser(value);
                }
            }
            InitialiserKind::Struct(members) => members.iter().for_each(|member| self.initialiser(&member.value)),
            InitialiserKind::Elements(elements) => elements.iter().for_each(|each| self.initialiser(&each.value)),
        }
    }

    fn written(&mut self, name: &Ident) {
        let uses = self.uses(name);
        uses.written = uses.written.or(Some(name.span));
    }
}

/// True for a part of `%Q`.
fn writes_output(target: &Expr) -> bool {
    match &target.kind {
        ExprKind::DirectAddress(text) => text.to_ascii_uppercase().starts_with("%Q"),
        ExprKind::Part(inner, _) | ExprKind::Paren(inner) => writes_output(inner),
        _ => false,
    }
}

impl Visitor for Collector<'_> {
    fn target(&mut self, target: &Expr) {
        for name in self.index.variables_of(target) {
            self.written(name);
        }
        self.usage.writes_outputs |= writes_output(target);
    }

    fn control(&mut self, name: &Ident) {
        self.written(name);
    }

    fn call(&mut self, call: &Call) {
        for name in self.index.variables_of(&call.callee) {
            self.uses(name).is_called = true;
        }
        for argument in &call.arguments {
            let (value, may_write) = match argument {
                Argument::Positional(value) => (value, true),
                Argument::Input(name, value) => (value, self.index.is_in_out(&name.key())),
                Argument::Output { .. } => continue,
            };
            for name in self.index.variables_of(value).into_iter().filter(|_| may_write) {
                self.uses(name).is_passed = true;
            }
        }
    }

    fn referred(&mut self, place: &Expr) {
        if let Some(name) = root(place) {
            self.uses(name).is_passed = true;
        }
    }

    fn expression(&mut self, expr: &Expr) {
        if let ExprKind::Name(name) | ExprKind::Member(_, name) = &expr.kind
            && (matches!(expr.kind, ExprKind::Name(_)) || self.index.is_in_namespace(expr))
        {
            self.uses(name).is_read = true;
        }
    }
}
