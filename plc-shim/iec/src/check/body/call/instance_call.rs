//! Calls of the statements of function blocks (2nd ed. 2.5.2.1).

use std::sync::Arc;

use super::argument::Passing;
use super::{Matched, enable};
use crate::check::body::Body;
use crate::check::body::place::member::member_place;
use crate::check::declare::Scope;
use crate::check::types::parameter::ENO;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{Argument, ElementaryType, InstanceCall, Place, PouId, Statement, StatementKind, Storage, Type};
use crate::syntax::Span;
use crate::syntax::ast::{Call, SectionKind};

impl Body<'_, '_> {
    pub(super) fn instance_call(&mut self, call: &Call, span: Span) -> Option<StatementKind> {
        let callee = self.instance_of(&call.callee);
        let instance = self.place(callee)?.place;
        self.instance_call_at(instance, call, span)
    }

    /// Calls the statements of a function block on the instance at a place.
    pub(in crate::check::body) fn instance_call_at(
        &mut self,
        instance: Place,
        call: &Call,
        span: Span,
    ) -> Option<StatementKind> {
        let Type::FunctionBlock { name, pou } = self.declarations.types().get(instance.ty).clone() else {
            let message = format!("this is {}, which cannot be called", self.type_name(instance.ty));
            self.report(Diagnostic::error(Code::NotCallable, call.callee.span, message));
            return None;
        };
        let dispatch = self.body_dispatch(&instance, pou, call, span)?;
        self.declarations.note_stub(pou, span);
        let scope = self.declarations.interface(pou, span)?;
        let split = enable::split(call, scope.find(ENO).is_some());
        let (enabling, rest) = split.map_or((None, None), |(enabling, rest)| (Some(enabling), Some(rest)));
        let matched = self.matched(&scope, &name, rest.as_ref().unwrap_or(call))?;
        let pointer = self.scope.register(ElementaryType::Udint);
        let base = Place::whole(Storage::RegisterPointer(pointer), instance.ty, instance.span);
        let mut passing = Passing::default();
        self.instance_inputs(&scope, &matched, &base, &mut passing, span)?;
        let outputs = self.outputs(&matched.outputs, |variable, span| member_place(&base, variable, span))?;
        let Passing { before: inputs, after: mut back } = passing;
        back.extend(outputs);
        let call = InstanceCall { instance, pou, dispatch, pointer, inputs, outputs: back };
        self.controlled_instance(&scope, call, enabling)
    }

    /// Calls the body of an instance without arguments.
    pub(in crate::check::body) fn bare_call(&mut self, instance: Place, pou: PouId, span: Span) -> Statement {
        self.note_call(pou, span);
        let pointer = self.scope.register(ElementaryType::Udint);
        Statement { kind: StatementKind::CallInstance(Box::new(InstanceCall::bare(instance, pou, pointer))), span }
    }

    /// Sets the inputs of an instance that are given.
    pub(in crate::check::body) fn instance_inputs(
        &mut self,
        scope: &Arc<Scope>,
        matched: &Matched<'_>,
        base: &Place,
        passing: &mut Passing,
        span: Span,
    ) -> Option<()> {
        let mut sound = true;
        for parameter in scope.inputs() {
            let given = matched.inputs.get(&parameter.name.to_ascii_uppercase()).copied();
            let Some(expr) = given else {
                // An input that is not given keeps its value; a reference must be given again.
                if parameter.section == SectionKind::InOut
                    && !self.declarations.dialect(span).has(Feature::ReadableInOuts)
                {
                    self.missing_argument::<()>(&parameter.name, span);
                    sound = false;
                }
                continue;
            };
            let target = member_place(base, parameter, expr.span);
            let statement = match self.argument(parameter, expr, passing) {
                Some(Argument::Value(value)) => self.assignment(target, value, expr.span),
                Some(Argument::Reference(place)) => {
                    Statement { kind: StatementKind::Bind(target, place), span: expr.span }
                }
                None => {
                    sound = false;
                    continue;
                }
            };
            passing.before.push(statement);
        }
        sound.then_some(())
    }
}
