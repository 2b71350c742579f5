//! Arguments of calls: values, references, and what goes through memory (2nd ed. 2.5.1.1, 2.5.2.1).

use crate::check::body::Body;
use crate::check::types::constant::decode;
use crate::check::types::operand::constant;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Argument, Expr, ExprKind, Place, Statement, StatementKind, Storage, Type, TypeId, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, ReferenceKind, SectionKind};

impl Body<'_, '_> {
    pub(in crate::check::body) fn default_argument(
        &mut self,
        parameter: &Variable,
        named: bool,
        span: Span,
    ) -> Option<Argument> {
        let has_default =
            !self.is_open(parameter.ty) && !self.is_instance_type(parameter.ty) && !self.is_generic(parameter.ty);
        match self.elementary(parameter.ty) {
            Some(ty) if named && parameter.section == SectionKind::Input => {
                let value = constant(decode(ty, &parameter.image), ty, span);
                Some(Argument::Value(Expr { ty: parameter.ty, ..value }))
            }
            None if named && parameter.section == SectionKind::Input && has_default => {
                let place = self.declarations.constant_bytes(parameter.ty, parameter.image.clone(), span)?;
                let kind = ExprKind::Load(place);
                Some(Argument::Value(Expr { kind, ty: parameter.ty, span }))
            }
            _ => self.missing_argument(&parameter.name, span),
        }
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
        if matches!(self.declarations.types().get(parameter.ty), Type::Reference { kind: ReferenceKind::Reference, .. })
        {
            return self.referring_argument(parameter.ty, expr, passing).map(Argument::Value);
        }
        self.expression_for(expr, parameter.ty).map(Argument::Value)
    }

    /// The variable given for a `VAR_IN_OUT`. One in a register or in a bit goes through memory.
    fn reference(&mut self, parameter: &Variable, expr: &ast::Expr, passing: &mut Passing) -> Option<Place> {
        let place = self.target(expr)?;
        if place.ty != parameter.ty && !self.derives(place.ty, parameter.ty) {
            let (wanted, found) = (self.type_name(parameter.ty), self.type_name(place.ty));
            let message = format!("VAR_IN_OUT `{}` is {wanted}, this is {found}", parameter.name);
            self.report(Diagnostic::error(Code::InvalidArgument, expr.span, message));
            return None;
        }
        self.through_memory(place, passing)
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
    fn referring_argument(&mut self, ty: TypeId, expr: &ast::Expr, passing: &mut Passing) -> Option<Expr> {
        let value = self.referring(ty, expr)?;
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
