//! Calls: inputs by their names, functions with all of them, standard functions as SCL has them.

use onescan_base::elementary::Kind;

use super::body::Body;
use super::names::{Shape, member};
use super::scope::{Scope, values};
use super::standard::{self, Function};
use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::ast::{
    Argument, Call, Expr, ExprKind, Ident, InitialiserKind, Pou, PouKind, SectionKind, Variable,
};
use onescan_iec::syntax::token::{Punctuation, TokenKind};

/// What a call can give to or take from a unit.
struct Parameter<'a> {
    name: &'a Ident,
    kind: SectionKind,
    variable: &'a Variable,
}

fn parameters(pou: &Pou) -> Vec<Parameter<'_>> {
    let is_one = |kind| matches!(kind, SectionKind::Input | SectionKind::Output | SectionKind::InOut);
    let sections = pou.sections.iter().filter(|section| is_one(section.kind));
    let each = sections.flat_map(|section| section.variables.iter().map(move |variable| (section.kind, variable)));
    each.flat_map(|(kind, variable)| variable.names.iter().map(move |name| Parameter { name, kind, variable }))
        .collect()
}

impl<'a> Body<'_, 'a> {
    /// A call, except the values of its arguments.
    pub(super) fn called(&mut self, call: &Call) {
        for argument in &call.arguments {
            match argument {
                Argument::Output { negated: true, name, .. } => {
                    self.refuse(name.span, "NOT at an output", "assign NOT of the output behind the call");
                }
                Argument::Input(name, _) | Argument::Output { name, .. }
                    if matches!(name.key().as_str(), "EN" | "ENO") =>
                {
                    self.refuse(name.span, "EN and ENO in this form", "write IF .. THEN around the call");
                }
                _ => {}
            }
        }
        let ExprKind::Name(name) = &call.callee.kind else { return self.instance(call) };
        let key = name.key();
        if self.scope.locals.contains_key(&key) || self.names.globals.contains_key(&key) {
            return self.instance(call);
        }
        match self.names.units.get(&key).copied() {
            Some(pou) if pou.kind == PouKind::Function => self.function(call, name, pou),
            Some(_) => self.instance(call),
            None => self.standard(call, name),
        }
    }

    fn instance(&mut self, call: &Call) {
        onescan_iec::syntax::walk::Visitor::target(self, &call.callee);
        let Some(Shape::Block(pou)) = self.scope.place(self.names, &call.callee) else { return };
        self.positional(call, pou);
    }

    fn function(&mut self, call: &Call, name: &Ident, pou: &'a Pou) {
        let written = self.names.block(&name.text);
        self.replace(name.span, written);
        self.positional(call, pou);
        // A function of TIA Portal has no initial values: a call gives it everything.
        let given = |parameter: &Parameter<'_>| {
            call.arguments.iter().any(|argument| match argument {
                Argument::Input(name, _) | Argument::Output { name, .. } => name.key() == parameter.name.key(),
                Argument::Positional(_) => false,
            })
        };
        let is_positional = call.arguments.iter().any(|argument| matches!(argument, Argument::Positional(_)));
        let missing: Vec<_> = parameters(pou).into_iter().filter(|each| !is_positional && !given(each)).collect();
        let mut added = Vec::new();
        for parameter in missing {
            if let (SectionKind::Input, Some(value)) = (parameter.kind, self.default(&parameter)) {
                added.push(format!("{} := {value}", member(&parameter.name.text)));
                continue;
            }
            let what = format!("calls of functions that leave out `{}`", parameter.name.text);
            self.refuse(name.span, &what, "give it a variable");
        }
        if let Some(end) = self.closing(call).filter(|_| !added.is_empty()) {
            let comma = if call.arguments.is_empty() { "" } else { ", " };
            self.edits.insert(end, format!("{comma}{}", added.join(", ")));
        }
    }

    /// What an input of a function begins with.
    fn default(&self, parameter: &Parameter<'a>) -> Option<String> {
        if let Some(initial) = &parameter.variable.initial {
            let InitialiserKind::Value(value) = &initial.kind else { return None };
            let is_plain = matches!(value.kind, ExprKind::Literal(_));
            return is_plain.then(|| self.names.sources.text(value.span).to_owned());
        }
        match self.names.shape(&parameter.variable.spec)? {
            Shape::Elementary(ty) => zero(ty),
            Shape::Enumeration(_) => Some("0".to_owned()),
            Shape::Text { wide: false } => Some("''".to_owned()),
            _ => None,
        }
    }

    /// Names the arguments that are given by their position.
    fn positional(&mut self, call: &Call, pou: &Pou) {
        let parameters = parameters(pou);
        for (argument, parameter) in call.arguments.iter().zip(&parameters) {
            if let Argument::Positional(value) = argument {
                let arrow = if parameter.kind == SectionKind::Output { "=>" } else { ":=" };
                self.edits.insert(value.span.start, format!("{} {arrow} ", member(&parameter.name.text)));
            }
        }
    }

    fn standard(&mut self, call: &Call, name: &Ident) {
        let values = values(call);
        let first = values.first().and_then(|value| Scope::type_of(self.scope, self.names, value));
        match standard::function(&name.key(), values.len(), first) {
            Function::Same(inputs) => {
                for (argument, input) in call.arguments.iter().zip(inputs) {
                    if let Argument::Positional(value) = argument {
                        self.edits.insert(value.span.start, format!("{input} := "));
                    }
                }
            }
            Function::Named(new) => {
                let nested = new.matches('(').count();
                self.replace(name.span, new);
                if let Some(end) = self.closing(call).filter(|_| nested > 0) {
                    self.edits.insert(end, ")".repeat(nested));
                }
            }
            Function::Operator(operator) => self.operator(call, operator, &values),
            Function::Missing(help) => {
                self.refuse(name.span, &format!("function `{}`", name.text), help);
            }
        }
    }

    /// `EXPT(a, b)` becomes `((a) ** (b))`.
    fn operator(&mut self, call: &Call, operator: &str, values: &[&Expr]) {
        let (Some(first), Some(end)) = (values.first(), self.closing(call)) else { return };
        self.edits.replace(call.callee.span.start..first.span.start, "((");
        for (left, right) in values.iter().zip(values.iter().skip(1)) {
            self.edits.replace(left.span.end..right.span.start, format!(") {operator} ("));
        }
        self.edits.insert(end, ")");
    }

    /// Where the parenthesis is that ends a call.
    fn closing(&self, call: &Call) -> Option<u32> {
        let ends = call.arguments.iter().map(|argument| match argument {
            Argument::Positional(value) | Argument::Input(_, value) => value.span.end,
            Argument::Output { name, target, .. } => target.as_ref().map_or(name.span.end, |target| target.span.end),
        });
        let from = ends.max().unwrap_or(call.callee.span.end);
        let rest = self.file.text().get(from as usize..)?;
        let tokens = onescan_iec::syntax::tokenize_in(self.file.dialect(), rest);
        let is_end = |kind| kind == TokenKind::Punctuation(Punctuation::RightParen);
        Some(from + tokens.iter().find(|token| is_end(token.kind))?.start)
    }
}

/// The literal of a type's initial value.
fn zero(ty: ElementaryType) -> Option<String> {
    Some(match ty.kind() {
        Kind::Bool => "FALSE".to_owned(),
        Kind::Signed | Kind::Unsigned | Kind::Bits => "0".to_owned(),
        Kind::Real => "0.0".to_owned(),
        Kind::Duration if ty == ElementaryType::Ltime => "LT#0s".to_owned(),
        Kind::Duration => "T#0s".to_owned(),
        Kind::Date | Kind::TimeOfDay | Kind::DateTime | Kind::Character => return None,
    })
}
