//! Execution control: EN and ENO (2nd ed. 2.5.1.2 Table 20, 2.5.2.1; 3rd ed. 6.6.1.5).
//!
//! Every call takes `EN := condition` and `ENO => variable`, whether its unit declares them or not.
//!
//! | | EN is TRUE | EN is FALSE |
//! |---|---|---|
//! | other arguments | evaluated | not evaluated |
//! | unit | runs | does not run |
//! | function's result | its own | its type's initial value |
//! | instance | its own | as it was |
//! | other outputs | assigned | not assigned |
//! | ENO | TRUE unless the unit or an error makes it FALSE | FALSE |
//!
//! An `EN` that a function block declares is kept between calls, like any other input. ENO of a
//! standard function reports errors, see [`super::enable_error`].

use crate::check::body::Body;
use crate::check::declare::Scope;
use crate::check::types::constant::decode;
use crate::check::types::operand::{Operand, constant};
use crate::check::types::parameter::{EN, ENO, is_control};
use crate::ir::{
    ElementaryType, Expr, ExprKind, IfBranch, InstanceCall, Place, Statement, StatementKind, Storage, TypeId,
    TypeTable, Unary, Value, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, Argument, Call};

/// What a call says about its execution.
pub(super) struct Enabling<'e> {
    pub(in crate::check::body) enable: Option<&'e ast::Expr>,
    /// Where ENO goes, and whether negated.
    pub(in crate::check::body) outcome: Option<(&'e ast::Expr, bool)>,
    pub(in crate::check::body) span: Span,
}

/// The call without EN and, unless the unit itself has it, ENO; nothing if neither is there.
pub(super) fn split(call: &Call, declares_outcome: bool) -> Option<(Enabling<'_>, Call)> {
    let mut enabling = Enabling { enable: None, outcome: None, span: call.callee.span };
    let mut rest = Vec::new();
    for argument in &call.arguments {
        match argument {
            Argument::Input(name, value) if name.key() == EN && enabling.enable.is_none() => {
                enabling.enable = Some(value);
            }
            Argument::Output { name, negated, target } if name.key() == ENO && enabling.outcome.is_none() => {
                enabling.outcome = target.as_ref().map(|target| (target, *negated));
                if declares_outcome {
                    rest.push(argument.clone());
                }
            }
            other => rest.push(other.clone()),
        }
    }
    is_controlled(call).then(|| (enabling, Call { callee: call.callee.clone(), arguments: rest }))
}

/// True if EN or ENO is an argument of the call.
pub(in crate::check::body) fn is_controlled(call: &Call) -> bool {
    call.arguments.iter().any(|argument| match argument {
        Argument::Input(name, _) => name.key() == EN,
        Argument::Output { name, .. } => name.key() == ENO,
        Argument::Positional(_) => false,
    })
}

pub(in crate::check::body) fn boolean(value: bool, span: Span) -> Expr {
    constant(Value::Bool(value), ElementaryType::Bool, span)
}

fn load(place: Place, ty: TypeId, span: Span) -> Expr {
    Expr { kind: ExprKind::Load(place), ty, span }
}

/// One statement of both ways.
fn decide(condition: Expr, body: Vec<Statement>, otherwise: Vec<Statement>) -> Statement {
    let span = condition.span;
    Statement { kind: StatementKind::If(vec![IfBranch { condition, body }], otherwise), span }
}

impl Body<'_, '_> {
    /// A call of a function with EN or ENO.
    pub(super) fn controlled_call(&mut self, call: &Call, span: Span) -> Option<Operand> {
        let own = self.declares_outcome(call, span);
        self.controlled(call, own, span, |body, rest| body.plain_call(rest, true, span)).map(Operand::Typed)
    }

    /// A call that EN may forbid and ENO reports; `own` is true if what is called has an ENO itself.
    pub(in crate::check) fn controlled(
        &mut self,
        call: &Call,
        own: bool,
        span: Span,
        make: impl FnOnce(&mut Self, &Call) -> Option<Operand>,
    ) -> Option<Expr> {
        let (enabling, rest) = split(call, own)?;
        let context = self.context;
        let enable = enabling.enable.map(|enable| self.expression_of(enable, ElementaryType::Bool));
        let called = make(self, &rest)?;
        let called = match context.filter(|ty| Self::adapts(&called, *ty)) {
            Some(ty) => self.coerce(called, ty.into())?,
            None => self.settle(called)?,
        };
        let ty = called.ty;
        let result = if ty == TypeTable::nothing() { None } else { Some(self.kept(ty, span)?) };
        let outcome = if own { None } else { enabling.outcome };
        let mut body = match outcome {
            Some(_) => self.observed(called, result.as_ref(), &enabling)?,
            None => vec![self.carried_out(called, result.as_ref())],
        };
        if let Some(enable) = enable {
            let otherwise = self.not_carried_out(result.as_ref(), &enabling, span)?;
            body = vec![decide(enable?, body, otherwise)];
        }
        let value = result.map(|place| Box::new(load(place, ty, span)));
        Some(Expr { kind: ExprKind::After(body, value), ty, span })
    }

    /// True if the called function has an ENO of its own.
    fn declares_outcome(&mut self, call: &Call, span: Span) -> bool {
        let ast::ExprKind::Name(name) = &call.callee.kind else {
            return false;
        };
        let scope = self.function_named(name).and_then(|id| self.declarations.interface(id, span));
        scope.is_some_and(|scope| scope.find(ENO).is_some())
    }

    /// Where the result of a call is kept until it is used.
    pub(in crate::check) fn kept(&mut self, ty: TypeId, span: Span) -> Option<Place> {
        match self.elementary(ty) {
            Some(elementary) => {
                let register = self.scope.register(elementary);
                Some(Place::whole(Storage::Register(register), ty, span))
            }
            None => self.temporary(ty, span),
        }
    }

    fn carried_out(&self, called: Expr, result: Option<&Place>) -> Statement {
        let span = called.span;
        match result {
            Some(place) => self.assignment(place.clone(), called, span),
            None => Statement { kind: StatementKind::Evaluate(called), span },
        }
    }

    /// A call that reports by ENO whether it succeeded.
    fn observed(&mut self, called: Expr, result: Option<&Place>, enabling: &Enabling<'_>) -> Option<Vec<Statement>> {
        let span = called.span;
        let guard = self.error_guard(called, result);
        let mut body = guard.before;
        let mut done = vec![self.carried_out(guard.called, result)];
        done.extend(self.outcome(enabling, guard.after.unwrap_or_else(|| boolean(true, span)))?);
        match guard.sound {
            Some(sound) => {
                let failed = self.not_carried_out(result, enabling, span)?;
                body.push(decide(sound, done, failed));
            }
            None => body.extend(done),
        }
        Some(body)
    }

    /// The result's initial value, and ENO FALSE.
    fn not_carried_out(
        &mut self,
        result: Option<&Place>,
        enabling: &Enabling<'_>,
        span: Span,
    ) -> Option<Vec<Statement>> {
        let mut statements = Vec::new();
        if let Some(place) = result {
            let image = self.declarations.types().image(place.ty).clone();
            let kind = match self.elementary(place.ty) {
                Some(ty) => {
                    let value = constant(decode(ty, &image), ty, span);
                    StatementKind::Assign(place.clone(), Expr { ty: place.ty, ..value })
                }
                None => StatementKind::Initialise(place.clone(), image),
            };
            statements.push(Statement { kind, span });
        }
        statements.extend(self.outcome(enabling, boolean(false, span))?);
        Some(statements)
    }

    /// `ENO => variable`, if it is there.
    fn outcome(&mut self, enabling: &Enabling<'_>, value: Expr) -> Option<Vec<Statement>> {
        let Some((target, negated)) = enabling.outcome else {
            return Some(Vec::new());
        };
        let place = match self.new_wire(target) {
            Some(name) => self.wire(name, ElementaryType::Bool.into(), target.span)?,
            None => self.target(target)?,
        };
        let (ty, span) = (value.ty, target.span);
        let value = if negated { Expr { kind: ExprKind::Unary(Unary::Not, Box::new(value)), ty, span } } else { value };
        let value = Expr { span, ..value };
        let value = self.coerce(Operand::Typed(value), place.ty)?;
        Some(vec![self.assignment(place, value, span)])
    }

    /// An instance's call, which EN may keep from being carried out.
    pub(super) fn controlled_instance(
        &mut self,
        scope: &Scope,
        call: InstanceCall,
        enabling: Option<Enabling<'_>>,
    ) -> Option<StatementKind> {
        let declared = |name| scope.find(name).filter(|variable| is_control(variable));
        let (own_enable, own_outcome) = (declared(EN), declared(ENO));
        if own_enable.is_none() && enabling.is_none() {
            return Some(StatementKind::CallInstance(Box::new(call)));
        }
        let span = enabling.as_ref().map_or(call.instance.span, |enabling| enabling.span);
        let enabling = enabling.unwrap_or(Enabling { enable: None, outcome: None, span });
        let given = match enabling.enable {
            Some(expr) => Some(self.expression_of(expr, ElementaryType::Bool)?),
            None => None,
        };
        // The address is found once, before EN is looked at.
        let pointer = Place::whole(Storage::Register(call.pointer), ElementaryType::Udint.into(), span);
        let base = Place::whole(Storage::RegisterPointer(call.pointer), call.instance.ty, call.instance.span);
        let find = Statement { kind: StatementKind::Bind(pointer, call.instance.clone()), span };
        let call = InstanceCall { instance: base.clone(), ..call };
        let (own_enable, own_outcome) =
            (own_enable.map(|en| member(&base, en, span)), own_outcome.map(|eno| member(&base, eno, span)));
        let mut body = vec![Statement { kind: StatementKind::CallInstance(Box::new(call)), span }];
        if own_outcome.is_none() {
            body.extend(self.outcome(&enabling, boolean(true, span))?);
        }
        let mut before = vec![find];
        let condition = match (own_enable, given) {
            (Some(place), given) => {
                before.extend(given.map(|value| self.assignment(place.clone(), value, span)));
                load(place, ElementaryType::Bool.into(), span)
            }
            (None, Some(given)) => given,
            (None, None) => boolean(true, span),
        };
        let mut otherwise: Vec<_> =
            own_outcome.map(|place| self.assignment(place, boolean(false, span), span)).into_iter().collect();
        otherwise.extend(self.outcome(&enabling, boolean(false, span))?);
        let condition =
            Expr { kind: ExprKind::After(before, Some(Box::new(condition))), ty: ElementaryType::Bool.into(), span };
        Some(StatementKind::If(vec![IfBranch { condition, body }], otherwise))
    }
}

/// A variable inside of the instance at `base`.
fn member(base: &Place, variable: &Variable, span: Span) -> Place {
    let offset = if let Storage::Instance(offset) = variable.storage { offset } else { 0 };
    Place { span, ..base.clone().member(offset, variable.ty) }
}
