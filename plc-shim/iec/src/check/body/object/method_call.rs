//! Calls of methods and actions (3rd ed. 6.6.5.4 and 6.6.5.5).

use crate::check::body::call::argument::Passing;
use crate::check::body::call::{enable, is_formal};
use crate::check::body::place::member::member_place;
use crate::check::body::{Body, Meant};
use crate::check::declare::{Role, Scope};
use crate::check::standard;
use crate::check::types::operand::Operand;
use crate::check::types::parameter::{self, ENO};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{
    Argument, Dispatch, ElementaryType, Expr, ExprKind, FunctionCall, Place, PouId, Receiver, Storage, Type, TypeTable,
    Value, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, Call, Ident, PouKind};

/// How much is known of the instance that a method is called on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check::body) enum Known {
    /// Its type: it is a variable.
    Exactly,
    /// It is the running instance, which may be of a derived type.
    This,
    /// It is the running instance, and the method is the base's.
    Super,
    /// It came by `VAR_IN_OUT` and may be of a derived type.
    Reference,
    /// An interface refers to it, or to nothing.
    Interface,
}

/// The instance that a method is called on.
#[derive(Debug, Clone)]
pub(in crate::check) struct Object {
    pub(in crate::check::body) address: Expr,
    pub(in crate::check::body) class: PouId,
    pub(in crate::check::body) known: Known,
}

impl Body<'_, '_> {
    /// The call, if it is one of a method; nothing inside if it is wrong.
    pub(in crate::check::body) fn method_call(&mut self, call: &Call, span: Span) -> Meant<Expr> {
        let (object, name) = match &call.callee.kind {
            ast::ExprKind::Name(name) => {
                if self.scope.declares(&name.key()) && !self.is_own_result(name) {
                    return None;
                }
                let class = self.own_class()?;
                if !self.declarations.has_member(class, Role::Method, &name.text) || self.means_function(name) {
                    return None;
                }
                (self.this_object(class, name.span), name)
            }
            ast::ExprKind::Member(base, name) => {
                if !self.is_super(base) && !self.declarations.has_method_named(&name.key()) && !self.is_init(name) {
                    return None;
                }
                match self.object(base)? {
                    Some(object) => (object, name),
                    None => return Some(None),
                }
            }
            _ => return None,
        };
        let methods = self.declarations.methods_named(object.class, &name.text);
        if methods.is_empty() {
            if self.is_init(name) && object.known != Known::Interface && !self.declarations.may_inherit(object.class) {
                return Some(self.implicit_init(&object, call, span));
            }
            // A variable of the name may be an instance to call.
            let is_variable = |scope: std::sync::Arc<Scope>| scope.find(&name.key()).is_some();
            let is_unknown = object.known == Known::Super
                && !self.declarations.interface(object.class, span).is_some_and(is_variable);
            return is_unknown.then(|| self.unknown_method(object.class, name));
        }
        let Some(method) = self.meant(&methods, name, call, span) else { return Some(None) };
        Some(self.called(object, method, name, call, span))
    }

    /// True for the name of the method that runs, where methods do not call themselves and a function has it: by its bare
    /// name it calls that (SIMATIC AX).
    fn means_function(&self, name: &Ident) -> bool {
        let may_recur = self.declarations.dialect(name.span).has(Feature::Recursion);
        let has_function = || self.function_named(name).is_some() || standard::exists(&name.key());
        !may_recur && self.is_own_result(name) && has_function()
    }

    fn called(&mut self, object: Object, method: PouId, name: &Ident, call: &Call, span: Span) -> Option<Expr> {
        self.check_method_access(method, name.span)?;
        if self.declarations.pou(method).ast().kind == PouKind::Action && !call.arguments.is_empty() {
            return self.called_action(object, method, name, call, span);
        }
        let scope = self.declarations.interface(method, span)?;
        let formal = is_formal(call);
        let make = |body: &mut Self, call: &Call| {
            let (arguments, mut passing) = body.method_arguments(&scope, &name.text, call, formal, span)?;
            if body.is_init(name) && object.known != Known::Super {
                passing.before.extend(body.begun_again(&object, call, span));
            }
            body.on_object(object, Role::Method, method, arguments, passing, span)
        };
        if !enable::is_controlled(call) {
            return make(self, call);
        }
        let own = scope.own(ENO).is_some_and(parameter::is_control);
        self.controlled(call, own, span, |body, rest| make(body, rest).map(Operand::Typed))
    }

    /// An action has the inputs and outputs of its unit (CODESYS, TwinCAT: calling of actions).
    fn called_action(&mut self, object: Object, action: PouId, name: &Ident, call: &Call, span: Span) -> Option<Expr> {
        let instance = match &call.callee.kind {
            ast::ExprKind::Member(base, _) => self.place(base)?.place,
            _ => self.this(object.class, span),
        };
        let scope = self.declarations.interface(object.class, span)?;
        let matched = self.matched(&scope, &name.text, call)?;
        let mut passing = Passing::default();
        self.instance_inputs(&scope, &matched, &instance, &mut passing, span)?;
        let outputs = self.outputs(&matched.outputs, |variable, span| member_place(&instance, variable, span))?;
        passing.after.extend(outputs);
        self.on_object(object, Role::Method, action, Vec::new(), passing, span)
    }

    fn unknown_method<T>(&mut self, class: PouId, name: &Ident) -> Option<T> {
        if self.declarations.may_inherit(class) {
            return None;
        }
        let names = self.declarations.member_names(class);
        let help = crate::diagnostic::did_you_mean(&name.text, names.iter().map(String::as_str));
        let message = format!("{} has no method `{}`", self.declarations.pou(class).ast().name.text, name.text);
        let found = Diagnostic::error(Code::UnknownMember, name.span, message);
        self.report(found.with_optional_help(help));
        None
    }

    pub(in crate::check::body) fn this_object(&mut self, class: PouId, span: Span) -> Object {
        let place = self.this(class, span);
        let address = Expr { ty: place.ty, kind: ExprKind::Load(place), span };
        Object { address, class, known: Known::This }
    }

    /// The instance that an expression stands for; nothing at all if it stands for something else.
    pub(in crate::check) fn object(&mut self, expr: &ast::Expr) -> Meant<Object> {
        if self.is_super(expr) {
            let base = self.own_class().and_then(|class| self.declarations.base_of(class));
            let Some(class) = base else { return Some(self.no_object("SUPER", expr.span)) };
            let object = self.this_object(class, expr.span);
            return Some(Some(Object { known: Known::Super, ..object }));
        }
        if let ast::ExprKind::Name(name) = &expr.kind {
            if self.is_this(name) {
                let class =
                    self.own_class().filter(|class| self.declarations.pou(*class).ast().kind != PouKind::Function);
                let Some(class) = class else { return Some(self.no_object("THIS", name.span)) };
                return Some(Some(self.this_object(class, name.span)));
            }
            if self.is_namespace(name) {
                return None;
            }
            if let Some(program) = self.program_object(name) {
                return Some(Some(program));
            }
        }
        if self.qualified_name(expr).is_some_and(|name| !self.is_global(&name)) {
            return None;
        }
        let Some(operand) = self.expression(expr) else { return Some(None) };
        let Operand::Typed(address) = operand else { return None };
        let (class, known) = match (self.declarations.types().get(address.ty), &address.kind) {
            (Type::Interface { pou, .. }, _) => (*pou, Known::Interface),
            (Type::FunctionBlock { pou, .. }, ExprKind::Load(place)) => {
                (*pou, if may_be_derived(place) { Known::Reference } else { Known::Exactly })
            }
            // What a property or function gives is a copy, of its own type.
            (Type::FunctionBlock { pou, .. }, ExprKind::Call(_) | ExprKind::After(..)) => (*pou, Known::Exactly),
            _ => return None,
        };
        Some(Some(Object { address, class, known }))
    }

    /// A program has one instance, under its own name.
    fn program_object(&mut self, name: &Ident) -> Option<Object> {
        let key = name.key();
        if self.scope.declares(&key) || self.declarations.global_key(&key).is_some() {
            return None;
        }
        let class = self.declarations.pou_named(&key)?;
        let offset = self.declarations.programs().iter().find(|program| program.pou == class)?.offset;
        let (kind, ty) = (ExprKind::Constant(Value::Int(i128::from(offset))), ElementaryType::Udint.into());
        Some(Object { address: Expr { kind, ty, span: name.span }, class, known: Known::Exactly })
    }

    pub(in crate::check::body) fn method_arguments(
        &mut self,
        scope: &Scope,
        name: &str,
        call: &Call,
        formal: bool,
        span: Span,
    ) -> Option<(Vec<Argument>, Passing)> {
        let matched = self.matched(scope, name, call)?;
        let (mut passing, mut arguments, mut sound) = (Passing::default(), Vec::new(), true);
        for parameter in scope.inputs() {
            let given = matched.inputs.get(&parameter.name.to_ascii_uppercase()).copied();
            let argument = match given {
                // The call is carried out, or the method would not read it.
                _ if parameter::is_control(parameter) => Some(Argument::Value(enable::boolean(true, span))),
                Some(expr) => self.argument(parameter, expr, &mut passing),
                None => self.left_out(parameter, call, formal, span),
            };
            sound &= argument.is_some();
            arguments.extend(argument);
        }
        // The caller owns what the outputs are written to: which method runs may not be known.
        let mut places = Vec::new();
        for output in scope.outputs() {
            if self.is_open(output.ty) {
                let argument = self.open_output(output, &matched, &mut passing, span);
                sound &= argument.is_some();
                arguments.extend(argument);
                continue;
            }
            let place = self.temporary(output.ty, span)?;
            arguments.push(Argument::Reference(place.clone()));
            places.push((output.name.clone(), place));
        }
        let place_of = |variable: &Variable, span: Span| {
            let found = places.iter().find(|(name, _)| *name == variable.name);
            let place =
                found.map_or_else(|| Place::whole(variable.storage, variable.ty, span), |(_, place)| place.clone());
            Place { span, ..place }
        };
        let outputs = self.outputs(&matched.outputs, place_of)?;
        passing.after.extend(outputs);
        sound.then_some((arguments, passing))
    }

    /// The call of a member whose arguments are known.
    pub(in crate::check::body) fn on_object(
        &mut self,
        object: Object,
        role: Role,
        method: PouId,
        arguments: Vec<Argument>,
        passing: Passing,
        span: Span,
    ) -> Option<Expr> {
        let scope = self.declarations.interface(method, span)?;
        let name = self.declarations.member_key(method);
        self.declarations.note_stub(method, span);
        let (pou, dispatch) = self.dispatch(object.class, object.known, role, &name, method, span)?;
        if self.declarations.lacks_result(method) {
            return None;
        }
        let ty = scope.result().map_or(TypeTable::nothing(), |result| result.ty);
        let aggregate = scope.result().is_some() && self.elementary(ty).is_none();
        let result = if aggregate { Some(self.temporary(ty, span)?) } else { None };
        let pointer = self.scope.register(ElementaryType::Udint);
        let may_be_null = object.known == Known::Interface;
        let receiver = Some(Receiver { instance: object.address, pointer, may_be_null, dispatch });
        let Passing { before, after: outputs } = passing;
        let call = FunctionCall { pou, before, arguments, receiver, outputs, result };
        let ty = self.declarations.types().of_value(ty);
        Some(Expr { kind: ExprKind::Call(Box::new(call)), ty, span })
    }

    /// What runs, and how it is found. Whatever may run is compiled.
    fn dispatch(
        &mut self,
        class: PouId,
        known: Known,
        role: Role,
        name: &str,
        method: PouId,
        span: Span,
    ) -> Option<(PouId, Dispatch)> {
        if matches!(known, Known::Exactly | Known::Super) {
            if self.declarations.is_prototype(method) && !self.declarations.rests_on_stub(class) {
                if self.declarations.may_inherit(class) {
                    return None;
                }
                let message = format!("`{}` is ABSTRACT and has no statements", self.declarations.display_name(method));
                self.report(Diagnostic::error(Code::AbstractInstance, span, message));
                return None;
            }
            self.note_call(method, span);
            return Some((method, Dispatch::Direct));
        }
        if self.declarations.is_private(method) {
            self.note_call(method, span);
            return Some((method, Dispatch::Direct));
        }
        let targets = self.declarations.targets(class, role, name);
        let first = targets.first().map(|(_, target)| *target);
        let only = first.filter(|first| targets.iter().all(|(_, target)| target == first));
        if let Some(only) = only.filter(|_| known == Known::This) {
            self.note_call(only, span);
            return Some((only, Dispatch::Direct));
        }
        self.note_dynamic(targets.iter().map(|(_, target)| *target));
        match (first, only) {
            // Nothing implements the interface: it refers to nothing.
            (None, _) => Some((method, Dispatch::Direct)),
            (_, Some(only)) => Some((only, Dispatch::Direct)),
            _ => Some((method, Dispatch::Row(self.declarations.row(class, role, name, method)?))),
        }
    }

    fn note_dynamic(&mut self, targets: impl Iterator<Item = PouId>) {
        for target in targets {
            self.declarations.note_dynamic_call(self.pou, target);
        }
    }

    /// How the statements of a function block are called on an instance at a place.
    pub(in crate::check::body) fn body_dispatch(
        &mut self,
        place: &Place,
        pou: PouId,
        call: &Call,
        span: Span,
    ) -> Option<Dispatch> {
        if self.declarations.pou(pou).ast().kind == PouKind::Class {
            let message = "a class has no statements of its own; call one of its methods";
            self.report(Diagnostic::error(Code::NotCallable, call.callee.span, message));
            return None;
        }
        let by_reference = may_be_derived(place);
        let targets = self.declarations.targets(pou, Role::Body, "");
        if !by_reference || targets.iter().all(|(_, target)| *target == pou) {
            self.note_call(pou, span);
            return Some(Dispatch::Direct);
        }
        self.note_dynamic(targets.iter().map(|(_, target)| *target));
        self.declarations.row(pou, Role::Body, "", pou).map(Dispatch::Row)
    }
}

/// True for a place where an instance of a derived type may lie: what comes by `VAR_IN_OUT`, and what a pointer or a
/// reference leads to.
fn may_be_derived(place: &Place) -> bool {
    match place.storage {
        Storage::InstancePointer(_) | Storage::RegisterPointer(_) => place.steps.is_empty(),
        Storage::Referred => place.steps.len() == 1,
        _ => false,
    }
}
