//! Calls of functions and instances (2nd ed. 2.5.1.1, 2.5.2.1).

pub(super) mod any_input;
pub(super) mod argument;
pub(super) mod conversion_function;
pub(super) mod dynamic_memory;
pub(super) mod enable;
pub(super) mod enable_error;
pub(super) mod instance_call;
pub(super) mod memory_function;
pub(super) mod overload;
pub(super) mod standard_function;
pub(super) mod var_info;
mod variant;

use std::collections::BTreeMap;

use self::argument::Passing;
use self::dynamic_memory::DynamicMemory;
use super::Body;
use crate::check::asserts;
use crate::check::declare::{Numbered, Scope};
use crate::check::standard::place::PlaceFunction;
use crate::check::standard::query::Query;
use crate::check::standard::{self, form, memory};
use crate::check::types::operand::Operand;
use crate::check::types::parameter::{self, EN};
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::dialect::{Dialect, Feature};
use crate::ir::{
    Argument, ElementaryType, Expr, ExprKind, FunctionCall, Intrinsic, MemoryFunction, Place, PouId, Statement,
    StatementKind, Type, TypeTable, Unary, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, BinaryOp, Call, Ident, PouKind, SectionKind};

/// The arguments of a call by the parameter they belong to.
#[derive(Default)]
pub(super) struct Matched<'e> {
    pub(in crate::check::body) inputs: BTreeMap<String, &'e ast::Expr>,
    pub(in crate::check::body) outputs: Vec<Wanted<'e>>,
}

/// An output that the caller wants.
pub(super) struct Wanted<'e> {
    pub(in crate::check::body) variable: Variable,
    pub(super) negated: bool,
    pub(in crate::check::body) target: &'e ast::Expr,
}

/// True for a list with names, be it EN alone: what it leaves out has its initial value (2nd ed. 2.5.1.1).
pub(super) fn is_formal(call: &Call) -> bool {
    call.arguments.iter().any(|argument| !matches!(argument, ast::Argument::Positional(_)))
}

impl Body<'_, '_> {
    pub(super) fn call_expression(&mut self, call: &Call, span: Span) -> Option<Operand> {
        if let Some(called) = self.method_call(call, span) {
            return called.map(Operand::Typed);
        }
        if enable::is_controlled(call) && !self.is_instance(call) {
            return self.controlled_call(call, span);
        }
        self.plain_call(call, is_formal(call), span)
    }

    /// A call without EN and ENO, unless its function declares them; `formal` as [`is_formal`] has it of the whole.
    fn plain_call(&mut self, call: &Call, formal: bool, span: Span) -> Option<Operand> {
        let qualified = self.qualified_name(&call.callee);
        let ((ast::ExprKind::Name(name), _) | (_, Some(name))) = (&call.callee.kind, &qualified) else {
            return self.not_a_function(call, span);
        };
        if self.is_local(name) && !self.is_own_result(name) {
            return self.not_a_function(call, span);
        }
        if let Some(id) = self.function_named(name) {
            let id = self.meant(&self.declarations.functions_beside(id), name, call, span)?;
            return self.function_call(id, name, call, formal, span).map(Operand::Typed);
        }
        let name = &self.declarations.behind_libraries(name);
        if memory::exists(&name.key()) {
            return self.memory_call(name, call, span);
        }
        if let Some(function) = PlaceFunction::find(&name.key()) {
            return self.place_call(function, name, call, span);
        }
        if let Some(operator) = DynamicMemory::find(&name.key())
            && self.declarations.dialect(span).has(Feature::DynamicMemory)
        {
            return self.dynamic_memory_call(operator, call, span);
        }
        if name.key() == "__VARINFO" && self.declarations.dialect(span).has(Feature::PlacesOfText) {
            return self.var_info(call, span);
        }
        if let Some(query) = Query::find(&name.key()) {
            return self.query(query, name, call, span);
        }
        if standard::exists(&name.key()) {
            return self.standard_call(name, &call.arguments, span);
        }
        if Self::is_clock(name) {
            return self.clock_function(name, call, span);
        }
        if self.report_vendor_function(name) {
            return None;
        }
        self.report_unknown_function(name)
    }

    fn is_local(&self, name: &Ident) -> bool {
        !name.is_global() && self.is_callable_variable(&name.key())
    }

    /// True for a variable of the unit, and for an instance among those that its methods see. Of these
    /// the others leave their names to functions.
    fn is_callable_variable(&self, key: &str) -> bool {
        let outer = || self.scope.outer()?.find(key).map(|variable| variable.ty);
        let types = self.declarations.types();
        let is_block = |ty| match types.get(ty) {
            Type::FunctionBlock { .. } => true,
            Type::Reference { kind: ast::ReferenceKind::Reference, target } => {
                matches!(types.get(*target), Type::FunctionBlock { .. })
            }
            _ => false,
        };
        self.scope.own_name(key) || outer().is_some_and(is_block)
    }

    /// Inside a function its own name is its result, and a call of it recursion.
    pub(super) fn is_own_result(&self, name: &Ident) -> bool {
        self.pou.is_some_and(|id| {
            let own = self.declarations.pou(id).ast();
            own.kind.keeps_nothing() && own.name.key() == name.key()
        })
    }

    pub(super) fn function_named(&self, name: &Ident) -> Option<PouId> {
        let key = name.key();
        let id = self.declarations.pou_named(&key)?;
        // Without quotation marks it is the function that comes with the language.
        let is_scl = self.declarations.dialect(name.span) == Dialect::SiemensScl;
        if is_scl && !name.is_global() && !self.declarations.is_library(id) && standard::is_reserved(&key) {
            return None;
        }
        (self.declarations.pou(id).ast().kind == PouKind::Function).then_some(id)
    }

    /// True for a declared function, and for one that comes with the language behind the name of its library.
    fn is_function(&self, name: &Ident) -> bool {
        let key = name.key();
        let comes = |key: &str| memory::exists(key) || PlaceFunction::find(key).is_some() || standard::exists(key);
        self.function_named(name).is_some() || self.declarations.without_libraries(&key).is_some_and(comes)
    }

    /// True for what is called as a statement.
    fn is_instance(&self, call: &Call) -> bool {
        match &call.callee.kind {
            ast::ExprKind::Name(name) => {
                let key = name.key();
                self.is_callable_variable(&key) && !self.is_own_result(name)
            }
            _ => false,
        }
    }

    fn not_a_function(&mut self, call: &Call, span: Span) -> Option<Operand> {
        let place = self.place(&call.callee)?.place;
        let found = self.type_name(place.ty);
        let message = format!("this is {found}, not a function");
        let mut report = Diagnostic::error(Code::NotCallable, span, message);
        if matches!(self.declarations.types().get(place.ty), Type::FunctionBlock { .. }) {
            report = report.with_help("call the instance as a statement, then read its outputs");
        }
        self.report(report);
        None
    }

    fn report_unknown_function<T>(&mut self, name: &Ident) -> Option<T> {
        if let Some(id) = self.declarations.pou_named(&name.key()) {
            let what = match self.declarations.pou(id).ast().kind {
                PouKind::Class => "a class",
                PouKind::Interface => "an interface",
                _ => "a function block type",
            };
            let message = format!("`{}` is {what} and cannot be called", name.text);
            let help = "declare an instance of it and call that";
            let found = Diagnostic::error(Code::NotCallable, name.span, message);
            self.report(found.with_help(help));
            return None;
        }
        if self.may_inherit() {
            return None;
        }
        let functions = self.declarations.unit_names(|kind| kind == PouKind::Function);
        let variables = self.scope.variables().iter().map(|variable| variable.name.as_str());
        let standard: Vec<&str> = form::names().collect();
        let known = functions.chain(variables).chain(standard.iter().copied());
        let help = did_you_mean(&name.text, known);
        let help = self.declarations.elsewhere(name).or(help);
        let message = format!("there is no function or instance `{}`", name.text);
        let found = Diagnostic::error(Code::UnknownFunction, name.span, message);
        self.declarations.report_name(self.pou, name, found.with_optional_help(help));
        None
    }

    pub(super) fn call_statement(&mut self, call: &Call, span: Span) -> Option<StatementKind> {
        if let Some(called) = self.super_call(call, span) {
            return called;
        }
        if let Some(called) = self.method_call(call, span) {
            return Some(StatementKind::Evaluate(called?));
        }
        let function = match &call.callee.kind {
            ast::ExprKind::Member(..)
                if self.qualified_name(&call.callee).is_some_and(|name| self.is_function(&name)) =>
            {
                true
            }
            ast::ExprKind::Name(name) if self.is_this(name) => false,
            ast::ExprKind::Name(name) => {
                let is_variable = self.is_local(name)
                    || self.declarations.global_key(&name.key()).is_some()
                    || self.declarations.program_of_name(&name.key()).is_some();
                !is_variable || self.is_own_result(name)
            }
            _ => false,
        };
        if !function {
            return self.instance_call(call, span);
        }
        let Operand::Typed(result) = self.call_expression(call, span)? else {
            return None;
        };
        let effects = match &result.kind {
            ExprKind::Call(call) => self.has_effects(call.pou),
            ExprKind::Intrinsic(Intrinsic::Memory(function), _) => *function != MemoryFunction::Compare,
            ExprKind::After(..) => true,
            _ => false,
        };
        if !effects {
            let message = "the result of this call is lost";
            self.report(Diagnostic::warning(Code::ResultIgnored, span, message));
        }
        Some(StatementKind::Evaluate(result))
    }

    fn has_effects(&self, id: PouId) -> bool {
        self.declarations.pou(id).scope().is_some_and(|scope| {
            let effect = |section| matches!(section, SectionKind::Output | SectionKind::InOut | SectionKind::External);
            scope.result().is_none() || scope.variables().iter().any(|each| effect(each.section))
        })
    }

    pub(super) fn matched<'e>(&mut self, scope: &Scope, callee: &str, call: &'e Call) -> Option<Matched<'e>> {
        let mut matched = Matched::default();
        let mut sound = true;
        let mut given = 0;
        for argument in &call.arguments {
            // What has no name is counted with the inputs before it; outputs have their own.
            let index = given;
            given += usize::from(!matches!(argument, ast::Argument::Output { .. }));
            let (name, span, expr) = match argument {
                ast::Argument::Positional(expr) => {
                    // With a parameter whose declaration is wrong the others cannot be counted.
                    if scope.has_broken() {
                        return None;
                    }
                    if self.report_compared_parameter(scope, expr) {
                        sound = false;
                        continue;
                    }
                    if let Some(variable) = scope.positional().nth(index) {
                        (variable.name.to_ascii_uppercase(), expr.span, expr)
                    } else if let Some(output) = self
                        .positional_output(scope, index, expr.span)
                        .or_else(|| self.only_output(scope, call, expr.span))
                    {
                        matched.outputs.push(Wanted { variable: output, negated: false, target: expr });
                        continue;
                    } else {
                        let count = scope.positional().count();
                        let message = format!("`{callee}` takes {count} arguments");
                        self.report(Diagnostic::error(Code::TooManyArguments, expr.span, message));
                        return None;
                    }
                }
                ast::Argument::Input(name, expr) => {
                    let accepts =
                        |variable: &Variable| matches!(variable.section, SectionKind::Input | SectionKind::InOut);
                    let found = self.has_parameter(scope, callee, name, accepts);
                    sound &= found.is_some();
                    let key = found.map_or_else(|| name.key(), |found| found.name.to_ascii_uppercase());
                    (key, name.span, expr)
                }
                ast::Argument::Output { name, negated: false, target: Some(target) }
                    if let Some(variable) = self.variant_given_back(scope, name) =>
                {
                    // It points to the variable that the function writes, or is handed on.
                    sound &= self.is_variant(target) || self.target(target).is_some();
                    (variable.name.to_ascii_uppercase(), name.span, target)
                }
                ast::Argument::Output { name, negated, target } => {
                    let output = |variable: &Variable| variable.section == SectionKind::Output;
                    let found = self.has_parameter(scope, callee, name, output);
                    sound &= found.is_some();
                    if let (Some(variable), Some(target)) = (found, target) {
                        matched.outputs.push(Wanted { variable, negated: *negated, target });
                    }
                    continue;
                }
            };
            // One EN has been taken out already.
            let is_control = name == EN;
            if is_control || matched.inputs.insert(name, expr).is_some() {
                let message = "this parameter is given twice";
                if !is_control && self.declarations.dialect(span).has(Feature::RepeatedArguments) {
                    let message = format!("{message}, and the last value counts");
                    self.report(Diagnostic::warning(Code::DuplicateArgument, span, message));
                } else {
                    self.report(Diagnostic::error(Code::DuplicateArgument, span, message));
                    sound = false;
                }
            }
        }
        sound.then_some(matched)
    }

    /// In a list without names outputs may stand behind the inputs, in the order of their declaration.
    fn positional_output(&self, scope: &Scope, index: usize, span: Span) -> Option<Variable> {
        let has = self.declarations.dialect(span).has(Feature::PositionalOutputs);
        let behind = index.checked_sub(scope.positional().count()).filter(|_| has)?;
        scope.outputs().filter(|output| !parameter::is_control(output)).nth(behind).cloned()
    }

    /// Where a unit has one parameter, its name is left out, even if it is an output: `RD_SYS_T(now)`.
    fn only_output(&self, scope: &Scope, call: &Call, span: Span) -> Option<Variable> {
        let is_alone = call.arguments.len() == 1 && scope.positional().next().is_none();
        let leaves_out = self.declarations.dialect(span).has(Feature::LoneOutputs);
        let mut outputs = scope.outputs().filter(|_| is_alone && leaves_out);
        outputs.next().filter(|_| outputs.next().is_none()).cloned()
    }

    /// Reports `t(IN = q)`, which is a comparison with what the caller does not know.
    fn report_compared_parameter(&mut self, scope: &Scope, expr: &ast::Expr) -> bool {
        let ast::ExprKind::Binary(BinaryOp::Equal, left, _) = &expr.kind else { return false };
        let ast::ExprKind::Name(name) = &left.kind else { return false };
        let key = name.key();
        let parameter = |found: &Variable| match found.section {
            SectionKind::Input | SectionKind::InOut => Some(":="),
            SectionKind::Output => Some("=>"),
            _ => None,
        };
        let known = self.scope.declares(&key) || self.declarations.global_key(&key).is_some();
        let Some(sign) = scope.own(&key).and_then(parameter).filter(|_| !known) else { return false };
        let message = format!("`{} =` compares, it gives nothing to the parameter", name.text);
        let found = Diagnostic::error(Code::InvalidArgument, expr.span, message);
        self.report(found.with_help(format!("write `{} {sign}`", name.text)));
        true
    }

    fn has_parameter(
        &mut self,
        scope: &Scope,
        callee: &str,
        name: &Ident,
        accepts: impl Fn(&Variable) -> bool,
    ) -> Option<Variable> {
        let known = |variable: &&Variable| accepts(variable) && self.declarations.is_called_so(variable, name);
        let numbered = Numbered::of(&name.text);
        let found = match numbered {
            Some(wanted) => scope.numbered(wanted).filter(|variable| accepts(variable)),
            None => scope.own(&name.key()).filter(known),
        };
        if let (None, Some(wanted)) = (found, numbered) {
            self.report(Diagnostic::error(Code::UnknownArgument, name.span, wanted.lost(&format!("`{callee}`"))));
        } else if found.is_none() && !scope.may_have(&name.key()) {
            let names = scope.variables().iter().filter(|variable| accepts(variable));
            let help = did_you_mean(&name.text, names.map(|variable| variable.name.as_str()));
            let is_output = scope.own(&name.key()).is_some_and(|variable| variable.section == SectionKind::Output);
            let (message, help) = if is_output {
                let help = format!("an output goes to a variable: write `{} => variable`", name.text);
                (format!("`{}` is an output of `{callee}`, which takes no value", name.text), Some(help))
            } else {
                (format!("`{callee}` has no such parameter `{}`", name.text), help)
            };
            let found = Diagnostic::error(Code::UnknownArgument, name.span, message);
            self.report(found.with_optional_help(help));
        }
        found.cloned()
    }

    pub(in crate::check) fn note_call(&mut self, callee: PouId, span: Span) {
        self.declarations.note_call(self.pou, callee, span);
    }

    fn function_call(&mut self, id: PouId, name: &Ident, call: &Call, formal: bool, span: Span) -> Option<Expr> {
        self.note_call(id, span);
        self.declarations.note_stub(id, span);
        let scope = self.declarations.interface(id, span)?;
        let matched = self.matched(&scope, &name.text, call)?;
        let mut passing = Passing::default();
        let mut arguments = Vec::new();
        let mut sound = true;
        for parameter in scope.inputs() {
            let given = matched.inputs.get(&parameter.name.to_ascii_uppercase()).copied();
            let argument = match given {
                // The call is carried out, or the function would not read it.
                _ if parameter::is_control(parameter) => Some(Argument::Value(enable::boolean(true, span))),
                Some(expr) => self.argument(parameter, expr, &mut passing),
                None if self.declarations.is_library(id) && asserts::is_site(parameter) => Some(asserts::site(span)),
                None => self.left_out(parameter, call, formal, span),
            };
            sound &= argument.is_some();
            arguments.extend(argument);
        }
        for output in scope.outputs().filter(|output| self.is_open(output.ty)).collect::<Vec<_>>() {
            let argument = self.open_output(output, &matched, &mut passing, span);
            sound &= argument.is_some();
            arguments.extend(argument);
        }
        let outputs =
            self.outputs(&matched.outputs, |variable, span| Place::whole(variable.storage, variable.ty, span));
        let mut after = passing.after;
        after.extend(outputs?);
        if !sound || self.declarations.lacks_result(id) {
            return None;
        }
        // A function without a result (3rd ed. 6.6.2.2) can only be called as a statement.
        let ty = scope.result().map_or(TypeTable::nothing(), |result| result.ty);
        let aggregate = scope.result().is_some() && self.elementary(ty).is_none();
        let kept = if aggregate { Some(self.temporary(ty, span)?) } else { None };
        let (before, outputs) = (passing.before, after);
        let call = FunctionCall { pou: id, before, arguments, receiver: None, outputs, result: kept };
        let ty = self.declarations.types().of_value(ty);
        Some(Expr { kind: ExprKind::Call(Box::new(call)), ty, span })
    }

    pub(super) fn outputs(
        &mut self,
        wanted: &[Wanted<'_>],
        place_of: impl Fn(&Variable, Span) -> Place,
    ) -> Option<Vec<Statement>> {
        let mut statements = Vec::new();
        let mut sound = true;
        // An array without bounds is the target itself.
        let copied =
            |wanted: &&Wanted<'_>| !matches!(self.declarations.types().get(wanted.variable.ty), Type::OpenArray { .. });
        let wanted: Vec<_> = wanted.iter().filter(copied).collect();
        for Wanted { variable, negated, target } in wanted {
            let target_place = match self.new_wire(target) {
                Some(name) => self.wire(name, variable.ty, target.span),
                None => self.target(target),
            };
            let Some(target_place) = target_place else {
                sound = false;
                continue;
            };
            let place = place_of(variable, target.span);
            let (ty, span) = (self.declarations.types().of_value(place.ty), target.span);
            let mut value = Expr { kind: ExprKind::Load(place), ty, span };
            if *negated {
                if ty != ElementaryType::Bool.into() {
                    let found = self.type_name(ty);
                    return self.mismatch("BOOL", &found, span);
                }
                value = Expr { kind: ExprKind::Unary(Unary::Not, Box::new(value)), ty, span };
            }
            match self.coerce(Operand::Typed(value), target_place.ty) {
                Some(value) => statements.push(self.assignment(target_place, value, span)),
                None => sound = false,
            }
        }
        sound.then_some(statements)
    }

    /// An assignment of a value that has the target's type.
    pub(in crate::check) fn assignment(&self, target: Place, value: Expr, span: Span) -> Statement {
        let kind = match self.elementary(target.ty) {
            Some(_) => StatementKind::Assign(target, value),
            None => StatementKind::Copy(target, value),
        };
        Statement { kind, span }
    }
}
