//! What names mean inside of a unit, and the types of its expressions.

use std::collections::BTreeMap;

use super::names::{Names, Shape};
use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::ast::{
    Argument, BinaryOp, Call, Edge, Expr, ExprKind, Ident, Literal, Pou, Qualifier, SectionKind, TypeSpec, UnaryOp,
};
use onescan_iec::syntax::constant::{self, Constants};

/// A variable of a unit, or a function's result.
#[derive(Clone, Copy)]
pub(in crate::output) struct Local<'a> {
    pub(in crate::output) name: &'a Ident,
    pub(in crate::output) spec: &'a TypeSpec,
    pub(in crate::output) edge: Option<Edge>,
    /// True for a function's result, which has the function's name.
    pub(in crate::output) is_result: bool,
}

/// The names of a unit.
pub(in crate::output) struct Scope<'a> {
    pub(in crate::output) locals: BTreeMap<String, Local<'a>>,
    /// The constants that it declares.
    pub(in crate::output) constants: Constants<'a>,
}

impl<'a> Scope<'a> {
    pub(in crate::output) fn of(pou: &'a Pou) -> Self {
        let mut scope = Self { locals: BTreeMap::new(), constants: Constants::new() };
        for section in pou.sections.iter().filter(|section| section.kind != SectionKind::External) {
            if section.qualifiers.contains(&Qualifier::Constant) {
                constant::note(section, &mut scope.constants);
            }
            for variable in &section.variables {
                let local = |name| Local { name, spec: &variable.spec, edge: variable.edge, is_result: false };
                scope.locals.extend(variable.names.iter().map(|name| (name.key(), local(name))));
            }
        }
        if let Some(spec) = &pou.result {
            scope.locals.insert(pou.name.key(), Local { name: &pou.name, spec, edge: None, is_result: true });
        }
        scope
    }

    /// What a place comes to.
    pub(in crate::output) fn place(&self, names: &Names<'a>, expr: &Expr) -> Option<Shape<'a>> {
        match &expr.kind {
            ExprKind::Name(name) => {
                let key = name.key();
                if let Some(local) = self.locals.get(&key) {
                    return names.shape(local.spec);
                }
                if let Some(global) = names.globals.get(&key) {
                    return names.shape(&global.variable.spec);
                }
                names.program(&key).map(Shape::Block)
            }
            ExprKind::Paren(inner) => self.place(names, inner),
            ExprKind::Index(base, _) => match self.place(names, base)? {
                Shape::Array(element) => names.shape(element),
                _ => None,
            },
            ExprKind::Member(base, name) => member(names, self.place(names, base)?, &name.key()),
            _ => None,
        }
    }

    /// The elementary type of a value; nothing if the text does not say it.
    pub(in crate::output) fn type_of(&self, names: &Names<'a>, expr: &Expr) -> Option<ElementaryType> {
        match &expr.kind {
            ExprKind::Literal(literal) => of_literal(literal),
            ExprKind::Name(name) if !self.locals.contains_key(&name.key()) => {
                let value = names.value(&name.key(), None).filter(|_| !names.globals.contains_key(&name.key()));
                value.map(|value| value.base).or_else(|| self.place(names, expr)?.elementary())
            }
            ExprKind::Name(_) | ExprKind::Member(..) | ExprKind::Index(..) => self.place(names, expr)?.elementary(),
            ExprKind::Part(_, part) => Some(of_part(&part.text)),
            ExprKind::Paren(inner) | ExprKind::Unary(UnaryOp::Negate | UnaryOp::Plus, inner) => {
                self.type_of(names, inner)
            }
            ExprKind::Unary(UnaryOp::Not, inner) => self.type_of(names, inner),
            ExprKind::Binary(op, ..) if op.is_comparison() => Some(ElementaryType::Bool),
            ExprKind::Binary(BinaryOp::Power, base, _) => self.type_of(names, base),
            ExprKind::Binary(_, left, right) => wider(self.type_of(names, left), self.type_of(names, right)),
            ExprKind::Chain(first, links) => {
                links.iter().fold(self.type_of(names, first), |left, link| match link.operator {
                    op if op.is_comparison() => Some(ElementaryType::Bool),
                    BinaryOp::Power => left,
                    _ => wider(left, self.type_of(names, &link.operand)),
                })
            }
            ExprKind::Call(call) => self.result(names, call),
            _ => None,
        }
    }

    fn result(&self, names: &Names<'a>, call: &Call) -> Option<ElementaryType> {
        let ExprKind::Name(name) = &call.callee.kind else { return None };
        let key = name.key();
        if let Some(pou) = names.units.get(&key) {
            return names.shape(pou.result.as_ref()?)?.elementary();
        }
        let to = key.split_once("_TO_").map(|(_, to)| to).or_else(|| key.strip_prefix("TO_"));
        if let Some(to) = to {
            return ElementaryType::find(to);
        }
        let inputs = values(call);
        let value = |at: usize| self.type_of(names, inputs.get(at)?);
        match key.as_str() {
            "LEN" | "FIND" => Some(ElementaryType::Int),
            "TRUNC" => Some(ElementaryType::Dint),
            "SEL" | "MUX" | "LIMIT" => wider(value(1), value(2)),
            "MAX" | "MIN" => wider(value(0), value(1)),
            _ => value(0),
        }
    }
}

/// What a part of a structure or instance comes to.
fn member<'a>(names: &Names<'a>, of: Shape<'a>, key: &str) -> Option<Shape<'a>> {
    match of {
        Shape::Structure(fields) => names.shape(&fields.iter().find(|field| field.name.key() == key)?.spec),
        Shape::Block(pou) => {
            let mut variables = pou.sections.iter().flat_map(|section| &section.variables);
            let variable = variables.find(|variable| variable.names.iter().any(|name| name.key() == key))?;
            names.shape(&variable.spec)
        }
        _ => None,
    }
}

fn of_literal(literal: &Literal) -> Option<ElementaryType> {
    match literal {
        Literal::Bool(_) => Some(ElementaryType::Bool),
        Literal::Typed { prefix, .. } => ElementaryType::find(prefix),
        Literal::LongDuration(_) => Some(ElementaryType::Ltime),
        Literal::Duration { long, .. } => Some(if *long { ElementaryType::Ltime } else { ElementaryType::Time }),
        // They take the type of what they stand beside.
        _ => None,
    }
}

fn of_part(part: &str) -> ElementaryType {
    match part.strip_prefix('%').and_then(|part| part.chars().next()).map(|one| one.to_ascii_uppercase()) {
        Some('B') => ElementaryType::Byte,
        Some('W') => ElementaryType::Word,
        Some('D') => ElementaryType::Dword,
        _ => ElementaryType::Bool,
    }
}

fn wider(left: Option<ElementaryType>, right: Option<ElementaryType>) -> Option<ElementaryType> {
    match (left, right) {
        (Some(left), Some(right)) => {
            let is_wider =
                right.is_real() && !left.is_real() || right.size() > left.size() && right.is_real() == left.is_real();
            Some(if is_wider { right } else { left })
        }
        (left, right) => left.or(right),
    }
}

/// The values that a call gives, in their order.
pub(super) fn values(call: &Call) -> Vec<&Expr> {
    let mut values = Vec::new();
    for argument in &call.arguments {
        if let Argument::Positional(value) | Argument::Input(_, value) = argument {
            values.push(value);
        }
    }
    values
}
