//! `FB_init`, `FB_exit` and methods with `call_after_init`, which CODESYS and TwinCAT run for each instance without a call.
//!
//! `FB_init` runs at every start, behind the initial values of the instance's own variables and before
//! the values that its declaration gives; of a derived block the base's runs first. `FB_exit` runs
//! before the next start, that of the base last. `FB_reinit` belongs to a change of the running
//! program, which there is none of here: it is a method like any.

use std::sync::Arc;

use crate::check::body::Body;
use crate::check::body::call::argument::Passing;
use crate::check::body::call::is_formal;
use crate::check::body::object::method_call::{Known, Object};
use crate::check::declare::{EXIT_INPUTS, INIT_INPUTS, INIT_RETAINS_NAME, Occasion, Role, Scope, suits_init};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Expr, ExprKind, Place, PouId, Statement, StatementKind, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Argument, Call, Ident, Literal};

/// An input and what it is given.
type Named = (Ident, ast::Expr);

impl Body<'_, '_> {
    /// The calls of `FB_init` on the instance at a place.
    pub(in crate::check::body) fn init_calls(
        &mut self,
        place: &Place,
        pou: PouId,
        given: &[Argument],
    ) -> Vec<Statement> {
        let mut hooks = self.declarations.hooks(pou, Occasion::Start);
        // That of a stub does nothing, and its inputs may be guessed.
        let last = hooks.last().copied();
        hooks.retain(|hook| Some(*hook) == last || !self.declarations.is_external(*hook));
        let Some(last) = hooks.last() else { return Vec::new() };
        let Some(named) = self.named(*last, given, place.span) else { return Vec::new() };
        if hooks.iter().any(|hook| self.passes_all(*hook, *last, place.span).is_none()) {
            return Vec::new();
        }
        let calls = hooks.iter().map(|hook| self.init_call(place, pou, *hook, &named, hook == last));
        // A call that is wrong has been reported.
        calls.collect::<Option<Vec<_>>>().unwrap_or_default()
    }

    /// Reports an `FB_init` that lacks an input of the base's, which would be given nothing.
    fn passes_all(&mut self, base: PouId, last: PouId, span: Span) -> Option<()> {
        let (wanted, own) = (self.declarations.interface(base, span)?, self.declarations.interface(last, span)?);
        let lacks = |input: &&Variable| own.own(&input.name.to_ascii_uppercase()).is_none();
        let mut missing =
            wanted.inputs().skip(INIT_INPUTS.len()).filter(|input| !self.has_default(base, input)).filter(lacks);
        let Some(first) = missing.next() else { return Some(()) };
        let (name, unit) = (self.declarations.pou(last).ast().name.clone(), self.declarations.display_name(base));
        let message = format!("`{}` lacks `{}`, which `{unit}` wants", name.text, first.name);
        let found = Diagnostic::error(Code::HookInputs, name.span, message).with_label(first.span, "declared here");
        // Reported once, however many instances there are.
        if self.declarations.is_first_hook_fault(last) {
            self.report(found.with_help("what a declaration gives goes to the input of this name in every FB_init"));
        }
        None
    }

    /// True for an input with an initial value of its own.
    fn has_default(&self, init: PouId, input: &Variable) -> bool {
        let sections = &self.declarations.pou(init).ast().sections;
        let mut variables =
            sections.iter().flat_map(|section| &section.variables).filter(|variable| variable.initial.is_some());
        variables.any(|each| each.names.iter().any(|name| name.text.eq_ignore_ascii_case(&input.name)))
    }

    /// The calls of `FB_exit` on the instance at a place, that of the base last.
    pub(in crate::check::body) fn exit_calls(&mut self, place: &Place, pou: PouId) -> Vec<Statement> {
        let hooks = self.declarations.hooks(pou, Occasion::End);
        let copies = [Argument::Input(ident(EXIT_INPUTS[0], place.span), truth(false, place.span))];
        let calls = hooks.into_iter().rev().map(|hook| self.hook_call(place, pou, hook, copies.to_vec()));
        calls.collect::<Option<Vec<_>>>().unwrap_or_default()
    }

    /// The calls of methods with `{attribute 'call_after_init'}` on the instance at a place.
    pub(in crate::check::body) fn after_init_calls(&mut self, place: &Place, pou: PouId) -> Vec<Statement> {
        let hooks = self.declarations.hooks(pou, Occasion::AfterStart);
        let calls = hooks.into_iter().map(|hook| self.hook_call(place, pou, hook, Vec::new()));
        // A call that is wrong has been reported.
        calls.collect::<Option<Vec<_>>>().unwrap_or_default()
    }

    /// The arguments with the names of what they are for.
    fn named(&mut self, init: PouId, given: &[Argument], span: Span) -> Option<Vec<Named>> {
        let scope = self.declarations.interface(init, span)?;
        // With an input whose declaration is wrong nothing can be counted.
        if scope.has_broken() {
            return None;
        }
        let mut own = scope.positional().skip(INIT_INPUTS.len());
        let mut named = Vec::new();
        for argument in given {
            let (name, value) = match argument {
                Argument::Input(name, value) => (name.clone(), value),
                Argument::Positional(value) => {
                    let Some(input) = own.next() else {
                        let wanted = scope.positional().count().saturating_sub(INIT_INPUTS.len());
                        let message = format!("`{}` takes {wanted} arguments", self.declarations.display_name(init));
                        self.report(Diagnostic::error(Code::TooManyArguments, value.span, message));
                        return None;
                    };
                    (ident(&input.name, value.span), value)
                }
                Argument::Output { name, .. } => {
                    let message = "a declaration takes no outputs of FB_init";
                    self.report(Diagnostic::error(Code::UnknownArgument, name.span, message));
                    return None;
                }
            };
            named.push((name, value.clone()));
        }
        Some(named)
    }

    fn init_call(
        &mut self,
        place: &Place,
        pou: PouId,
        init: PouId,
        named: &[Named],
        is_last: bool,
    ) -> Option<Statement> {
        let scope = self.declarations.interface(init, place.span)?;
        if !suits_init(&scope) {
            return None;
        }
        self.all_given(&scope, pou, init, named, place.span)?;
        let span = place.span;
        let [retains, copies] = INIT_INPUTS.map(|name| ident(name, span));
        let name = ast::ExprKind::Name(ident(INIT_RETAINS_NAME, span));
        let retained = ast::Expr { kind: name, span, height: 1 };
        let mut arguments = vec![Argument::Input(retains, retained), Argument::Input(copies, truth(false, span))];
        let wanted = named.iter().filter(|(name, _)| is_last || scope.own(&name.key()).is_some());
        arguments.extend(wanted.map(|(name, value)| Argument::Input(name.clone(), value.clone())));
        self.hook_call(place, pou, init, arguments)
    }

    /// Reports inputs that are given nothing and have no initial value.
    fn all_given(&mut self, scope: &Arc<Scope>, pou: PouId, init: PouId, named: &[Named], span: Span) -> Option<()> {
        // What a stub holds was guessed by what is done with it.
        if self.own_class().is_some_and(|own| self.declarations.is_external(own)) {
            return Some(());
        }
        // A name that is wrong is reported instead.
        if named.iter().any(|(name, _)| scope.own(&name.key()).is_none()) {
            return Some(());
        }
        let is_given = |input: &&Variable| named.iter().any(|(name, _)| name.text.eq_ignore_ascii_case(&input.name));
        let wanted = |input: &&Variable| !is_given(input) && !self.has_default(init, input);
        let mut missing = scope.inputs().skip(INIT_INPUTS.len()).filter(wanted);
        let Some(first) = missing.next() else { return Some(()) };
        let (block, unit) = (&self.declarations.pou(pou).ast().name.text, self.declarations.display_name(init));
        let message = format!("`{unit}` wants `{}`", first.name);
        let found = Diagnostic::error(Code::MissingArgument, span, message).with_label(first.span, "declared here");
        let help = format!("declare the instance as `: {block}({} := ..)`", first.name);
        self.report(found.with_help(help));
        None
    }

    fn hook_call(&mut self, place: &Place, pou: PouId, hook: PouId, arguments: Vec<Argument>) -> Option<Statement> {
        let span = place.span;
        let scope = self.declarations.interface(hook, span)?;
        let unit = self.declarations.display_name(hook);
        let callee = ast::Expr { kind: ast::ExprKind::Name(ident(&unit, span)), span, height: 1 };
        let call = Call { callee: Box::new(callee), arguments };
        let (arguments, passing) = self.method_arguments(&scope, &unit, &call, is_formal(&call), span)?;
        let object = instance_at(place, pou);
        let called = self.on_object(object, Role::Method, hook, arguments, passing, span)?;
        Some(Statement { kind: StatementKind::Evaluate(called), span })
    }

    /// Runs what a unit's variables do at an occasion, on the instance at a place.
    pub(in crate::check::body) fn stage_call(&mut self, place: &Place, stage: PouId, span: Span) -> Option<Statement> {
        let owner = self.declarations.owner_of(stage);
        self.stage_call_on(instance_at(place, owner), stage, span)
    }

    pub(in crate::check::body) fn stage_call_on(
        &mut self,
        object: Object,
        stage: PouId,
        span: Span,
    ) -> Option<Statement> {
        let called = self.on_object(object, Role::Method, stage, Vec::new(), Passing::default(), span)?;
        Some(Statement { kind: StatementKind::Evaluate(called), span })
    }

    /// Sets a property to the value that the declaration of its instance gives.
    pub(super) fn property_begins(
        &mut self,
        place: &Place,
        pou: PouId,
        name: &Ident,
        value: &ast::Expr,
    ) -> Option<Statement> {
        let span = place.span;
        self.set(instance_at(place, pou), name, value, span)
    }
}

fn instance_at(place: &Place, class: PouId) -> Object {
    let (ty, span) = (place.ty, place.span);
    let address = Expr { kind: ExprKind::Load(place.clone()), ty, span };
    Object { address, class, known: Known::Exactly }
}

fn ident(text: &str, span: Span) -> Ident {
    Ident { text: text.to_owned(), span }
}

fn truth(value: bool, span: Span) -> ast::Expr {
    ast::Expr { kind: ast::ExprKind::Literal(Literal::Bool(value)), span, height: 1 }
}
