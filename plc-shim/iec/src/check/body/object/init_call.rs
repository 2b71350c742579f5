//! Calls of `FB_init` by a program (CODESYS, TwinCAT): the instance begins again, with its initial values and with what
//! its variables do at a start, and then runs its own `FB_init`, if it declares one.

use super::method_call::{Known, Object};
use crate::check::body::Body;
use crate::check::declare::{INIT_INPUTS, Occasion, is_init};
use crate::check::types::operand::constant;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Expr, ExprKind, Retention, Statement, Storage, Value};
use crate::syntax::Span;
use crate::syntax::ast::{self, Argument, Call, Ident, Literal};

impl Body<'_, '_> {
    /// True for the name of the method that every block has, declared or not.
    pub(super) fn is_init(&self, name: &Ident) -> bool {
        is_init(&name.text) && self.declarations.dialect(name.span).has(Feature::ImplicitInit)
    }

    /// The call of the `FB_init` that nobody declares.
    pub(super) fn implicit_init(&mut self, object: &Object, call: &Call, span: Span) -> Option<Expr> {
        self.check_init_inputs(call, span)?;
        let statements = self.begun_again(object, call, span);
        let result = Box::new(constant(Value::Bool(false), ElementaryType::Bool, span));
        Some(Expr { kind: ExprKind::After(statements, Some(result)), ty: ElementaryType::Bool.into(), span })
    }

    /// It takes what the runtime gives it, and nothing else.
    fn check_init_inputs(&mut self, call: &Call, span: Span) -> Option<()> {
        let mut given = [false; INIT_INPUTS.len()];
        for (at, argument) in call.arguments.iter().enumerate() {
            let (input, value) = match argument {
                Argument::Positional(value) => (Some(at).filter(|at| *at < given.len()), value),
                Argument::Input(name, value) => {
                    (INIT_INPUTS.iter().position(|input| input.eq_ignore_ascii_case(&name.text)), value)
                }
                Argument::Output { name, .. } => {
                    let message = format!("FB_init has no output `{}`", name.text);
                    self.report(Diagnostic::error(Code::UnknownArgument, name.span, message));
                    return None;
                }
            };
            let Some(given) = input.and_then(|input| given.get_mut(input)) else {
                let message = "FB_init takes bInitRetains and bInCopyCode where the block declares none";
                self.report(Diagnostic::error(Code::TooManyArguments, value.span, message));
                return None;
            };
            self.expression_for(value, ElementaryType::Bool.into())?;
            *given = true;
        }
        match INIT_INPUTS.iter().zip(given).find(|(_, given)| !given) {
            Some((input, _)) => self.missing_argument(input, span),
            None => Some(()),
        }
    }

    /// Gives the variables of an instance what they begin with; what outlasts a restart only if `bInitRetains` is TRUE.
    /// Of an instance that is not a variable nothing remains.
    pub(super) fn begun_again(&mut self, object: &Object, call: &Call, span: Span) -> Vec<Statement> {
        let ExprKind::Load(place) = &object.address.kind else { return Vec::new() };
        let Some(scope) = self.declarations.interface(object.class, span) else { return Vec::new() };
        let all = clears_retained(call);
        let begins = |retention| all || !matches!(retention, Some(Retention::Retain | Retention::Persistent));
        let mut statements = Vec::new();
        for variable in scope.variables().iter().filter(|variable| begins(variable.retention)) {
            if let Storage::Instance(offset) = variable.storage {
                let part = place.clone().member(offset, variable.ty);
                statements.push(self.given_bytes(part, &variable.image));
            }
        }
        if let Some(stage) = self.declarations.stage(object.class, Occasion::Start) {
            let whole = Object { known: Known::Exactly, ..object.clone() };
            statements.extend(self.stage_call_on(whole, stage, span));
        }
        statements
    }
}

fn clears_retained(call: &Call) -> bool {
    let value = match call.arguments.first() {
        Some(Argument::Positional(value)) => Some(value),
        _ => call.arguments.iter().find_map(|argument| match argument {
            Argument::Input(name, value) if name.text.eq_ignore_ascii_case(INIT_INPUTS[0]) => Some(value),
            _ => None,
        }),
    };
    value.is_some_and(|value| matches!(value.kind, ast::ExprKind::Literal(Literal::Bool(true))))
}
