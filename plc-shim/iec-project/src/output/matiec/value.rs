//! Enumerations as integers, and conversions by the names that the second edition has for them.

use std::collections::BTreeSet;

use super::{Finding, Page};
use crate::output::scl::names::{EnumeratedValue, Shape};
use crate::output::scl::scope::Scope;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{
    Argument, Call, Declaration, Expr, ExprKind, Initialiser, InitialiserKind, Literal, TypeSpec, TypeSpecKind,
    TypedValue,
};
use onescan_iec::syntax::walk::{self, Visitor};

/// Writes numbers for values, integers for enumerations, and both types of a conversion.
pub(super) fn lower(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut writer = Writer { page, scope: None, edits, done: BTreeSet::new(), findings: Vec::new() };
    for declaration in &page.unit.declarations {
        match declaration {
            Declaration::Type(named) if !matches!(named.spec.kind, TypeSpecKind::Enumeration(..)) => {
                writer.spec(&named.spec);
                named.initial.iter().for_each(|initial| writer.initial(initial));
            }
            Declaration::Pou(pou) => {
                writer.scope = Some(Scope::of(pou));
                pou.result.iter().for_each(|result| writer.spec(result));
                walk::with_members(pou, &mut writer);
                writer.scope = None;
            }
            _ => {}
        }
    }
    for (pou, section) in page.sections() {
        writer.scope = pou.map(Scope::of);
        for variable in &section.variables {
            writer.first_value(&variable.spec, variable.initial.is_some());
            writer.spec(&variable.spec);
            variable.initial.iter().for_each(|initial| writer.initial(initial));
        }
    }
    writer.findings
}

struct Writer<'w, 'a> {
    page: &'w Page<'a>,
    scope: Option<Scope<'a>>,
    edits: &'w mut Edits,
    /// Where something was written: several names share one type, several fields one initial value.
    done: BTreeSet<(u32, u32)>,
    findings: Vec<Finding>,
}

impl<'a> Writer<'_, 'a> {
    fn replace(&mut self, span: Span, text: String) {
        if self.done.insert((span.start, span.end)) {
            self.edits.replace(span.start..span.end, text);
        }
    }

    fn is_variable(&self, key: &str) -> bool {
        let is_local = self.scope.as_ref().is_some_and(|scope| scope.locals.contains_key(key));
        is_local || self.page.names.globals.contains_key(key)
    }

    fn value(&mut self, span: Span, value: EnumeratedValue<'a>) {
        self.replace(span, value.number.to_string());
    }

    /// An enumeration begins with its first value, or the one it says; an integer with 0.
    fn first_value(&mut self, spec: &'a TypeSpec, has_initial: bool) {
        let TypeSpecKind::Name(name) = &spec.kind else { return };
        let Some(named) = self.page.names.types.get(&name.key()).copied().filter(|_| !has_initial) else { return };
        let TypeSpecKind::Enumeration(values, _) = &named.spec.kind else { return };
        let said = named.initial.as_ref().and_then(|initial| match &initial.kind {
            InitialiserKind::Value(Expr { kind: ExprKind::Name(value), .. }) => Some(value.key()),
            _ => None,
        });
        let first = said.or_else(|| values.first().map(|value| value.name.key()));
        let value = first.and_then(|first| self.page.names.value(&first, Some(&named.name.key())));
        if let Some(value) = value.filter(|value| value.number != 0) {
            self.edits.insert(spec.span.end, format!(" := {}", value.number));
        }
    }

    fn spec(&mut self, spec: &'a TypeSpec) {
        match &spec.kind {
            TypeSpecKind::Name(name) => {
                let named = self.page.names.types.get(&name.key());
                if named.is_some_and(|named| matches!(named.spec.kind, TypeSpecKind::Enumeration(..)))
                    && let Some(Shape::Enumeration(base)) = self.page.names.shape(spec)
                {
                    self.replace(name.span, base.name().to_owned());
                }
            }
            TypeSpecKind::Array(_, element) => self.spec(element),
            TypeSpecKind::Struct(fields) => {
                for field in fields {
                    self.spec(&field.spec);
                    field.initial.iter().for_each(|initial| self.initial(initial));
                }
            }
            _ => {}
        }
    }

    fn initial(&mut self, initial: &'a Initialiser) {
        match &initial.kind {
            InitialiserKind::Value(value) => walk::expression(value, self),
            InitialiserKind::Array(values) => values.iter().for_each(|value| self.initial(value)),
            InitialiserKind::Repeat(_, value) => value.iter().for_each(|value| self.initial(value)),
            InitialiserKind::Struct(members) => members.iter().for_each(|member| self.initial(&member.value)),
            InitialiserKind::Elements(_) => {}
        }
    }

    /// `TO_DINT(x)`
    fn conversion(&mut self, call: &Call) {
        let ExprKind::Name(name) = &call.callee.kind else { return };
        let key = name.key();
        let Some(to) = key.strip_prefix("TO_").filter(|_| !self.page.names.units.contains_key(&key)) else { return };
        let [Argument::Positional(value)] = call.arguments.as_slice() else { return };
        let from = self.scope.as_ref().and_then(|scope| scope.type_of(self.page.names, value));
        match from {
            Some(from) if from.name() == to => self.replace(name.span, String::new()),
            Some(from) => self.replace(name.span, format!("{}_TO_{to}", from.name())),
            None => self.findings.push(Finding::new(
                name.span,
                &format!("`{}` of a value whose type the text does not say", name.text),
                "write INT_TO_DINT or the like",
            )),
        }
    }
}

impl Visitor for Writer<'_, '_> {
    fn call(&mut self, call: &Call) {
        self.conversion(call);
    }

    fn expression(&mut self, expr: &Expr) {
        let names = self.page.names;
        match &expr.kind {
            ExprKind::Literal(Literal::Typed { prefix, value: TypedValue::Name(name) }) => {
                let value = names.value(&name.to_ascii_uppercase(), Some(&prefix.to_ascii_uppercase()));
                if let Some(value) = value {
                    self.value(expr.span, value);
                }
            }
            ExprKind::Name(name) if !self.is_variable(&name.key()) => {
                if let Some(value) = names.value(&name.key(), None) {
                    self.value(expr.span, value);
                }
            }
            ExprKind::Member(base, name) => {
                if let ExprKind::Name(of) = &base.kind
                    && !self.is_variable(&of.key())
                    && let Some(value) = names.value(&name.key(), Some(&of.key()))
                {
                    self.value(expr.span, value);
                }
            }
            _ => {}
        }
    }
}
