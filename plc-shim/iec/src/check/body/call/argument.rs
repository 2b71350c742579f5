//! Arguments of calls: values, references, and what goes through memory (2nd ed. 2.5.1.1, 2.5.2.1).

use super::Matched;
use crate::check::body::place::Access;
use crate::check::body::{Body, Meant};
use crate::check::types::constant::decode;
use crate::check::types::number::as_number;
use crate::check::types::operand::{Operand, constant, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature, StringMemory};
use crate::ir::text::TextShape;
use crate::ir::{
    Argument, ElementaryType, Expr, ExprKind, Field, Place, Rounding, Statement, StatementKind, Storage, Type, TypeId,
    Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, SectionKind};

impl Body<'_, '_> {
    pub(in crate::check::body) fn default_argument(
        &mut self,
        parameter: &Variable,
        named: bool,
        span: Span,
    ) -> Option<Argument> {
        let has_default =
            !self.is_open(parameter.ty) && !self.is_instance_type(parameter.ty) && !self.is_generic(parameter.ty);
        let optional = named || self.has_own_value(parameter, span);
        match self.elementary(parameter.ty) {
            Some(ty) if optional && parameter.section == SectionKind::Input => {
                let value = constant(decode(ty, &parameter.image), ty, span);
                Some(Argument::Value(Expr { ty: parameter.ty, ..value }))
            }
            None if optional && parameter.section == SectionKind::Input && has_default => {
                let place = self.declarations.constant_bytes(parameter.ty, parameter.image.clone(), span)?;
                let kind = ExprKind::Load(place);
                Some(Argument::Value(Expr { kind, ty: parameter.ty, span }))
            }
            _ => self.missing_argument(&parameter.name, span),
        }
    }

    /// True for an input whose declaration gives a value: with vendors it may be left out of a list without names.
    fn has_own_value(&self, parameter: &Variable, call: Span) -> bool {
        let is_allowed = |at: Span| self.declarations.dialect(at).has(Feature::LeftOutInputs);
        // The caller may be of such a dialect, or what it calls: stubs are plain text.
        (is_allowed(parameter.span) || is_allowed(call)) && self.is_declared_with_value(parameter)
    }

    /// What a parameter has that a call does not give.
    pub(in crate::check::body) fn left_out(
        &mut self,
        parameter: &Variable,
        call: &ast::Call,
        formal: bool,
        span: Span,
    ) -> Option<Argument> {
        let named = self.leaves_out(parameter, call, formal);
        self.default_argument(parameter, named, span)
    }

    /// True for a list that leaves out an input by its name: with names, or without anything, where with vendors the
    /// input must have a value. Reported if it has none.
    fn leaves_out(&mut self, parameter: &Variable, call: &ast::Call, formal: bool) -> bool {
        let dialect = self.declarations.dialect(call.callee.span);
        if formal || !call.arguments.is_empty() || parameter.section != SectionKind::Input {
            return formal;
        }
        if self.is_declared_with_value(parameter) {
            return dialect.has(Feature::EmptyLists) || dialect.has(Feature::BareCalls);
        }
        if dialect.has(Feature::BareCalls) {
            let message = format!("parameter `{}` is missing: it is what its type begins with", parameter.name);
            let help = format!("write `{} := ...`, or give it a value in its declaration", parameter.name);
            let found = Diagnostic::warning(Code::MissingArgument, call.callee.span, message);
            self.report(found.with_help(help));
            return true;
        }
        false
    }

    fn is_declared_with_value(&self, parameter: &Variable) -> bool {
        let Some(owner) = parameter.owner else { return false };
        let mut declared = self.declarations.pou(owner).ast().sections.iter().flat_map(|section| &section.variables);
        let is_it = |variable: &&ast::Variable| variable.names.iter().any(|name| name.span == parameter.span);
        declared.find(is_it).is_some_and(|variable| variable.initial.is_some())
    }

    pub(in crate::check) fn is_instance_type(&self, ty: TypeId) -> bool {
        matches!(self.declarations.types().get(ty), Type::FunctionBlock { .. })
    }

    pub(in crate::check::body) fn missing_argument<T>(&mut self, name: &str, span: Span) -> Option<T> {
        let message = format!("parameter `{name}` is missing");
        self.report(Diagnostic::error(Code::MissingArgument, span, message));
        None
    }

    pub(in crate::check::body) fn argument(
        &mut self,
        parameter: &Variable,
        expr: &ast::Expr,
        passing: &mut Passing,
    ) -> Option<Argument> {
        if matches!(self.declarations.types().get(parameter.ty), Type::OpenArray { .. }) {
            return self.described(parameter, expr, &mut passing.before).map(Argument::Reference);
        }
        if let Some(generic) = self.declarations.generic(parameter.ty) {
            return self.generic_argument(generic, parameter, expr, passing);
        }
        if parameter.section == SectionKind::InOut {
            return self.reference(parameter, expr, passing).map(Argument::Reference);
        }
        if self.is_reference_to(parameter.ty) {
            return self.reference_argument(parameter, expr, passing).map(Argument::Value);
        }
        let dialect = self.declarations.dialect(expr.span);
        // SIMATIC AX copies in assignments, which says nothing of inputs.
        let is_copied = dialect.has(Feature::InstanceCopies) && dialect != Dialect::Iec3;
        if self.is_instance_type(parameter.ty) && is_copied {
            return self.instance_argument(parameter.ty, expr, passing).map(Argument::Value);
        }
        if self.may_be_long(parameter, expr.span) {
            return self.duration(expr, parameter.ty).map(Argument::Value);
        }
        self.expression_for(expr, parameter.ty).map(Argument::Value)
    }

    /// True for PT of a standard timer, which is a TIME or an LTIME (3rd ed. Table 46).
    fn may_be_long(&self, parameter: &Variable, span: Span) -> bool {
        let Some(owner) = parameter.owner.filter(|owner| self.declarations.is_library(*owner)) else { return false };
        let name = self.declarations.pou(owner).ast().name.key();
        let is_timer = matches!(name.as_str(), "TON" | "TOF" | "TP") && parameter.name == "PT";
        is_timer && self.declarations.dialect(span).has(Feature::LongTimers)
    }

    /// A TIME, or an LTIME, which counts as many nanoseconds where there is this choice.
    fn duration(&mut self, expr: &ast::Expr, wanted: TypeId) -> Option<Expr> {
        let context = self.elementary(wanted);
        match self.within(context, |body| body.expression(expr))? {
            Operand::Typed(value) if value.ty == ElementaryType::Ltime.into() => {
                self.declarations.note_long_duration(expr.span);
                Some(converted(value, ElementaryType::Time, Rounding::NearestEven))
            }
            other => self.coerce(other, wanted),
        }
    }

    /// An instance for an input, which is a copy: of one that is derived, what the base has of it.
    fn instance_argument(&mut self, wanted: TypeId, expr: &ast::Expr, passing: &mut Passing) -> Option<Expr> {
        match self.within(None, |body| body.expression(expr))? {
            Operand::Typed(value) if value.ty != wanted && self.derives(value.ty, wanted) => {
                let memory = self.temporary(wanted, expr.span)?;
                passing.before.push(self.copied_as_base(memory.clone(), value, expr.span));
                Some(Expr { kind: ExprKind::Load(memory), ty: wanted, span: expr.span })
            }
            other => self.coerce(other, wanted),
        }
    }

    /// The variable given for a `VAR_IN_OUT`. One in a register or in a bit goes through memory.
    fn reference(&mut self, parameter: &Variable, expr: &ast::Expr, passing: &mut Passing) -> Option<Place> {
        if parameter.is_constant {
            return self.constant_reference(parameter, expr, passing);
        }
        let place = self.given_place(expr)?;
        if let Some(given) = self.other_string(parameter, &place, passing) {
            return given;
        }
        let is_alike = place.ty == parameter.ty
            || self.derives(place.ty, parameter.ty)
            || self.begins_as(place.ty, parameter.ty)
            || self.is_number_of(place.ty, parameter.ty, expr.span)
            || self.has_bits_of(place.ty, parameter.ty, expr.span)
            || self.is_other_pointer(place.ty, parameter.ty, expr.span);
        if !is_alike {
            let (wanted, found) = (self.type_name(parameter.ty), self.type_name(place.ty));
            let message = format!("VAR_IN_OUT `{}` is {wanted}, this is {found}", parameter.name);
            self.report(Diagnostic::error(Code::InvalidArgument, expr.span, message));
            return None;
        }
        self.through_memory(place, passing)
    }

    /// What a `VAR_IN_OUT` may be given: what may be written, and of an instance what it keeps for itself, which
    /// vendors let be handed on; its outputs, too.
    fn given_place(&mut self, expr: &ast::Expr) -> Option<Place> {
        let located = self.place(expr)?;
        match located.access {
            Access::Internal => Some(located.place),
            Access::InstanceOutput if self.declarations.dialect(expr.span).has(Feature::OutputsHandedOn) => {
                let message = "an output is written by its own instance; what is written to it here does not last";
                self.report(Diagnostic::warning(Code::NotAssignable, expr.span, message));
                Some(located.place)
            }
            _ => self.writable(located, expr.span),
        }
    }

    /// `VAR_IN_OUT CONSTANT` takes constants and values as well, which the unit reads only (CODESYS, TwinCAT).
    fn constant_reference(&mut self, parameter: &Variable, expr: &ast::Expr, passing: &mut Passing) -> Option<Place> {
        if self.is_instance_type(parameter.ty) {
            let operand = self.within(None, |body| body.expression(expr))?;
            return match operand {
                Operand::Typed(Expr { kind: ExprKind::Load(place), ty, .. })
                    if ty == parameter.ty || self.derives(ty, parameter.ty) =>
                {
                    Some(Place { ty: parameter.ty, ..place })
                }
                other => {
                    let (wanted, found) = (self.type_name(parameter.ty), self.describe(&other));
                    self.mismatch(&wanted, &found, expr.span)
                }
            };
        }
        let value = self.expression_for(expr, parameter.ty)?;
        match value.kind {
            ExprKind::Load(place) if place.has_address() => Some(Place { ty: parameter.ty, ..place }),
            _ => {
                let memory = self.temporary(parameter.ty, expr.span)?;
                passing.before.push(self.assignment(memory.clone(), value, expr.span));
                Some(memory)
            }
        }
    }

    /// True for an enumeration where the type of its numbers is wanted, as vendors have it.
    fn is_number_of(&self, found: TypeId, wanted: TypeId, span: Span) -> bool {
        let base = self.base_of_enumeration(found, span);
        base.is_some_and(|base| wanted == base.into())
    }

    /// True for a UINT where a WORD is wanted, and the like, as vendors have it: both are the same bits.
    fn has_bits_of(&self, found: TypeId, wanted: TypeId, span: Span) -> bool {
        let types = self.declarations.types();
        let has = self.declarations.dialect(span).has(Feature::BitsInOut);
        match (types.get(found), types.get(wanted)) {
            (Type::Elementary(found), Type::Elementary(wanted)) => has && as_number(*found) == as_number(*wanted),
            _ => false,
        }
    }

    /// True for a structure that adds to another one, whose members it begins with, and for a longer string.
    pub(in crate::check::body) fn begins_as(&self, found: TypeId, wanted: TypeId) -> bool {
        match (self.declarations.types().get(found), self.declarations.types().get(wanted)) {
            (Type::Struct { fields: found, .. }, Type::Struct { fields: wanted, name, .. }) => {
                let alike = |(one, other): (&Field, &Field)| {
                    one.offset == other.offset && one.ty == other.ty && one.name.eq_ignore_ascii_case(&other.name)
                };
                let declared = !name.is_empty() && wanted.len() <= found.len();
                declared && found.iter().zip(wanted).all(alike)
            }
            // Behind a reference a longer string is as much of it as the reference knows.
            (Type::Text(found), Type::Text(wanted)) => {
                let zero_terminated = |shape: &TextShape| shape.memory == StringMemory::ZeroTerminated;
                let alike = found.wide == wanted.wide && zero_terminated(found) && zero_terminated(wanted);
                alike && found.capacity >= wanted.capacity
            }
            _ => false,
        }
    }

    /// A string of another length for a `VAR_IN_OUT`, as vendors take it: one with more room as it is, of another one a
    /// copy that is copied back, so that nothing is written behind its end. Nothing if it is not such a string.
    fn other_string(&mut self, parameter: &Variable, place: &Place, passing: &mut Passing) -> Meant<Place> {
        let (wanted, found) = (self.shape(parameter.ty)?, self.shape(place.ty)?);
        let is_allowed = self.declarations.dialect(place.span).has(Feature::LooseStrings);
        if wanted == found || wanted.wide != found.wide || !is_allowed {
            return None;
        }
        if wanted.memory == found.memory && found.capacity > wanted.capacity {
            return Some(Some(Place { ty: parameter.ty, ..place.clone() }));
        }
        Some(self.copied_string(parameter.ty, place, passing))
    }

    fn copied_string(&mut self, wanted: TypeId, place: &Place, passing: &mut Passing) -> Option<Place> {
        let memory = self.temporary(wanted, place.span)?;
        for (target, source, statements) in
            [(&memory, place, &mut passing.before), (place, &memory, &mut passing.after)]
        {
            let (ty, span) = (source.ty, source.span);
            let value = Operand::Typed(Expr { kind: ExprKind::Load(source.clone()), ty, span });
            let value = self.coerce(value, target.ty)?;
            statements.push(Statement { kind: StatementKind::Copy(target.clone(), value), span });
        }
        Some(memory)
    }

    /// The place, or memory that holds its value during the call if it has no address.
    pub(super) fn through_memory(&mut self, place: Place, passing: &mut Passing) -> Option<Place> {
        if place.has_address() {
            return Some(place);
        }
        let memory = self.temporary(place.ty, place.span)?;
        let (there, back) = (copy(&memory, &place), copy(&place, &memory));
        passing.before.push(there);
        passing.after.push(back);
        Some(memory)
    }

    /// The variable given for a `REFERENCE TO`.
    pub(in crate::check::body) fn referring_argument(
        &mut self,
        ty: TypeId,
        expr: &ast::Expr,
        passing: &mut Passing,
    ) -> Option<Expr> {
        let value = self.referring(ty, expr)?;
        self.with_address(value, passing)
    }

    /// The same for an input, which may be CONSTANT: then constants are given for it, too (CODESYS, TwinCAT).
    fn reference_argument(&mut self, parameter: &Variable, expr: &ast::Expr, passing: &mut Passing) -> Option<Expr> {
        let value = self.referring_to(parameter.ty, expr, parameter.is_constant)?;
        self.with_address(value, passing)
    }

    fn with_address(&mut self, value: Expr, passing: &mut Passing) -> Option<Expr> {
        match value.kind {
            ExprKind::Address(place) => {
                let kind = ExprKind::Address(self.through_memory(place, passing)?);
                Some(Expr { kind, ..value })
            }
            _ => Some(value),
        }
    }

    /// Memory of the calling unit for one value.
    pub(in crate::check) fn temporary(&mut self, ty: TypeId, span: Span) -> Option<Place> {
        let types = self.declarations.types();
        let (size, align) = (types.size(ty), types.align(ty));
        let offset = self.declarations.allocate(size, align, span)?;
        self.scope.keep_memory();
        Some(Place::whole(Storage::Absolute(offset), ty, span))
    }

    /// The array that an output of a call is given, which the unit writes to. It must be given: without it
    /// the output has no bounds.
    pub(in crate::check::body) fn open_output(
        &mut self,
        output: &Variable,
        matched: &Matched<'_>,
        passing: &mut Passing,
        span: Span,
    ) -> Option<Argument> {
        let given = matched.outputs.iter().find(|wanted| wanted.variable.name == output.name);
        let Some(given) = given else {
            return self.missing_argument(&output.name, span);
        };
        if given.negated {
            let found = self.type_name(output.ty);
            return self.mismatch("BOOL", &found, given.target.span);
        }
        self.described(output, given.target, &mut passing.before).map(Argument::Reference)
    }
}

/// What surrounds a call: copies into memory, and back.
#[derive(Default)]
pub(in crate::check::body) struct Passing {
    pub(in crate::check::body) before: Vec<Statement>,
    pub(in crate::check::body) after: Vec<Statement>,
}

fn copy(target: &Place, source: &Place) -> Statement {
    let (ty, span) = (source.ty, source.span);
    let value = Expr { kind: ExprKind::Load(source.clone()), ty, span };
    Statement { kind: StatementKind::Assign(target.clone(), value), span }
}
