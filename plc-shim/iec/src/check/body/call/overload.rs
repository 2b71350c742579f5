//! Which of several functions or methods of one name a call means (SIMATIC AX: overloads).

use crate::check::body::Body;
use crate::check::types::operand::Operand;
use crate::check::types::parameter;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::ir::{ElementaryType, PouId, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Call, Ident};

/// The units that calls mean by the places of the calls, or what is wrong with them: one that is an argument of another
/// is looked at several times.
pub(in crate::check::body) type Meanings = std::collections::BTreeMap<(u32, u32, u32), Result<PouId, Diagnostic>>;

/// How far the arguments are from the parameters, each by itself; behind them how many parameters are left out.
type Distance = Vec<u32>;

/// Between types of different kinds, where there is a conversion all the same.
const OTHER_KIND: u32 = 1000;
/// To a parameter that takes anything.
const GENERIC: u32 = 2 * OTHER_KIND;

/// An argument, and what it has come to by itself; nothing if only its place says that.
struct Given<'e> {
    expr: &'e ast::Expr,
    operand: Option<Operand>,
}

impl Body<'_, '_> {
    /// Of units that have one name, the one whose parameters suit the arguments best.
    pub(in crate::check::body) fn meant(
        &mut self,
        units: &[PouId],
        name: &Ident,
        call: &Call,
        span: Span,
    ) -> Option<PouId> {
        if let [only] = units {
            return Some(*only);
        }
        let place = (span.file.0, span.start, span.end);
        let found = if let Some(known) = self.meanings.get(&place) {
            known.clone()
        } else {
            let found = self.nearest(units, name, call, span);
            self.meanings.insert(place, found.clone());
            found
        };
        found.map_err(|wrong| self.report(wrong)).ok()
    }

    fn nearest(&mut self, units: &[PouId], name: &Ident, call: &Call, span: Span) -> Result<PouId, Diagnostic> {
        // What they are does not depend on who takes them.
        let given: Vec<Given> = call.arguments.iter().filter_map(|argument| self.given(argument)).collect();
        let mut fitting: Vec<(PouId, Distance)> = Vec::new();
        for unit in units {
            fitting.extend(self.fitness(*unit, name, (call, &given), span).map(|distance| (*unit, distance)));
        }
        let is_nearest = |(unit, own): &&(PouId, Distance)| {
            fitting.iter().all(|(other, distance)| other == unit || is_nearer(own, distance))
        };
        match fitting.iter().find(is_nearest) {
            Some((unit, _)) => Ok(*unit),
            None => Err(self.unclear(units, &fitting, name, span)),
        }
    }

    fn unclear(&self, units: &[PouId], fitting: &[(PouId, Distance)], name: &Ident, span: Span) -> Diagnostic {
        let (message, shown, help) = if fitting.is_empty() {
            let message = format!("no `{}` takes these arguments", name.text);
            (message, units.to_vec(), "give it arguments that one of them takes")
        } else {
            let message = format!("several `{}` take these arguments equally well", name.text);
            let help = "say which is meant: give the arguments types, as in `INT#5`";
            (message, fitting.iter().map(|(unit, _)| *unit).collect(), help)
        };
        let found = Diagnostic::error(Code::UnclearOverload, span, message).with_help(help);
        shown.into_iter().fold(found, |found, unit| {
            let parameters = self.declarations.shown_parameters(unit);
            found.with_label(self.declarations.pou(unit).ast().name.span, format!("takes {parameters}"))
        })
    }

    fn given<'e>(&mut self, argument: &'e ast::Argument) -> Option<Given<'e>> {
        let (ast::Argument::Positional(expr)
        | ast::Argument::Input(_, expr)
        | ast::Argument::Output { target: Some(expr), .. }) = argument
        else {
            return None;
        };
        let operand = self.on_trial(|body| body.within(None, |body| body.expression(expr)));
        Some(Given { expr, operand })
    }

    /// How well a unit's parameters suit the arguments; nothing if they do not.
    fn fitness(
        &mut self,
        unit: PouId,
        name: &Ident,
        (call, given): (&Call, &[Given<'_>]),
        span: Span,
    ) -> Option<Distance> {
        let scope = self.declarations.interface(unit, span)?;
        let formal = super::is_formal(call);
        let matched = self.on_trial(|body| {
            let matched = body.matched(&scope, &name.text, call)?;
            body.method_arguments(&scope, &name.text, call, formal, span)?;
            Some(matched)
        })?;
        // By the order in the call: every unit is measured alike.
        let mut distance = Distance::new();
        for Given { expr, operand } in given {
            let is_given = |(_, given): &(&String, &&ast::Expr)| std::ptr::eq(**given, *expr);
            let input = matched.inputs.iter().find(is_given).and_then(|(key, _)| scope.own(key));
            let output = matched.outputs.iter().find(|wanted| std::ptr::eq(wanted.target, *expr));
            distance.push(match (input, output, operand) {
                (Some(parameter), _, Some(operand)) => self.steps(operand, parameter.ty),
                (None, Some(output), _) => {
                    let target = self.on_trial(|body| body.target(expr));
                    target.map_or(0, |target| self.steps_between(output.variable.ty, target.ty))
                }
                _ => 0,
            });
        }
        let outputs = scope.outputs().filter(|output| !parameter::is_control(output)).count();
        let given = matched.inputs.len() + matched.outputs.len();
        distance.push((scope.positional().count() + outputs).saturating_sub(given) as u32);
        Some(distance)
    }

    /// What `check` comes to if it finds nothing wrong. What it reports and the registers that it takes are forgotten.
    fn on_trial<T>(&mut self, check: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        let (mark, scope, wires) = (self.declarations.mark(), self.scope.clone(), self.wires.clone());
        let found = check(self);
        let is_sound = self.declarations.found_since(mark).iter().all(|found| found.severity != Severity::Error);
        self.declarations.forget_since(mark);
        (self.scope, self.wires) = (scope, wires);
        found.filter(|_| is_sound)
    }

    /// How far an argument is from a parameter's type, to which it converts: 0 for one of the same.
    fn steps(&self, operand: &Operand, wanted: TypeId) -> u32 {
        let types = self.declarations.types();
        match operand {
            _ if self.declarations.generic(wanted).is_some() => GENERIC,
            Operand::Typed(expr) => self.steps_between(expr.ty, wanted),
            Operand::Integer { .. } if types.elementary(wanted).is_some_and(ElementaryType::is_integer) => 1,
            Operand::Integer { .. } => OTHER_KIND,
            Operand::Real { .. } => 1,
            Operand::Text { .. } => u32::from(!matches!(types.get(wanted), Type::Text(_))),
        }
    }

    fn steps_between(&self, found: TypeId, wanted: TypeId) -> u32 {
        if self.declarations.generic(wanted).is_some() {
            return GENERIC;
        }
        let types = self.declarations.types();
        match (types.get(found), types.get(wanted)) {
            _ if found == wanted => 0,
            (Type::Elementary(found), Type::Elementary(wanted)) => widened(*found, *wanted),
            (
                Type::FunctionBlock { pou: found, .. } | Type::Interface { pou: found, .. },
                Type::FunctionBlock { pou: wanted, .. } | Type::Interface { pou: wanted, .. },
            ) => self.declarations.generations(*found, *wanted),
            (Type::Text(found), Type::Text(wanted)) => u32::from(found != wanted),
            // Instances go to no array; all else that is taken for one without bounds is an array.
            (found, Type::OpenArray { .. })
                if !matches!(found, Type::FunctionBlock { .. } | Type::Interface { .. }) =>
            {
                1
            }
            _ => OTHER_KIND,
        }
    }
}

/// True if an argument is nearer and none is farther.
fn is_nearer(one: &Distance, other: &Distance) -> bool {
    one.iter().zip(other).all(|(one, other)| one <= other) && one != other
}

/// The bits that a conversion adds; one to another kind of type comes behind all of these.
fn widened(found: ElementaryType, wanted: ElementaryType) -> u32 {
    let is_alike = found.is_integer() == wanted.is_integer() && found.is_real() == wanted.is_real();
    let bits = 1 + 8 * wanted.size().saturating_sub(found.size());
    if is_alike { bits } else { bits + OTHER_KIND }
}
