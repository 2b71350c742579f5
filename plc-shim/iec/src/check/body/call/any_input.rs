//! Generic inputs of vendors' units (CODESYS, TwinCAT: `ANY`, `ANY_NUM` and the like): what is given is a
//! variable of one of the types; the unit sees its class, address and size.

use super::argument::Passing;
use crate::check::body::Body;
use crate::check::body::place::Access;
use crate::check::types::build::assign;
use crate::check::types::generic::{Generic, class_of};
use crate::check::types::operand::constant;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::elementary::Kind;
use crate::ir::{
    Argument, ElementaryType, Expr, ExprKind, Place, Statement, StatementKind, Type, TypeId, Value, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, ReferenceKind};

impl Body<'_, '_> {
    /// What an input of a generic type is given: class, address and size of a variable.
    pub(super) fn generic_argument(
        &mut self,
        generic: Generic,
        parameter: &Variable,
        expr: &ast::Expr,
        passing: &mut Passing,
    ) -> Option<Argument> {
        if parameter.owner.is_some_and(|owner| self.declarations.is_external(owner)) {
            return self.ignored_argument(parameter, expr, passing).map(Argument::Value);
        }
        let located = self.place(expr)?;
        let span = expr.span;
        if located.access == Access::Constant && self.is_declared_in_out(parameter) {
            let message = format!("`{}` is VAR_IN_OUT, which takes no constant", parameter.name);
            let found = Diagnostic::error(Code::InvalidArgument, span, message);
            self.report(found.with_help("give it a variable, which the block may write"));
            return None;
        }
        let variable = located.place;
        if self.declarations.generic(variable.ty).is_some() && (generic == Generic::Any || variable.ty == parameter.ty)
        {
            return Some(Argument::Value(Expr { kind: ExprKind::Load(variable), ty: parameter.ty, span }));
        }
        let Some(class) = self.class_taken(generic, variable.ty) else {
            let message =
                format!("`{}` is {}, this is {}", parameter.name, generic.name(), self.type_name(variable.ty));
            self.report(Diagnostic::error(Code::InvalidArgument, span, message));
            return None;
        };
        let size = self.declarations.types().size(variable.ty);
        // What is not an array is its own element, and has none.
        let (element, elements) = self.declarations.types().get(variable.ty).elements().unwrap_or((variable.ty, 0));
        let (of_type, of_element) = (self.type_code(variable.ty), self.type_code(element));
        let memory = self.through_memory(variable, passing)?;
        let given = self.temporary(parameter.ty, span)?;
        let Type::Struct { fields, .. } = self.declarations.types().get(parameter.ty).clone() else { return None };
        let udint = |value, ty| Expr { ty, ..constant(Value::Int(value), ElementaryType::Udint, span) };
        for field in fields {
            let member = given.clone().member(field.offset, field.ty);
            let value = match field.name.as_str() {
                "TypeClass" => udint(class, field.ty),
                "pValue" => Expr { kind: ExprKind::Address(memory.clone()), ty: field.ty, span },
                "TypeCode" => udint(of_type, field.ty),
                "ElementCode" => udint(of_element, field.ty),
                "ElementCount" => udint(i128::from(elements), field.ty),
                _ => constant(Value::Int(i128::from(size)), ElementaryType::Dint, span),
            };
            passing.before.push(assign(&member, value));
        }
        Some(Argument::Value(Expr { kind: ExprKind::Load(Place { span, ..given }), ty: parameter.ty, span }))
    }

    /// True for a VARIANT of `VAR_IN_OUT`, which comes as an input does.
    fn is_declared_in_out(&self, parameter: &Variable) -> bool {
        let Some(owner) = parameter.owner.filter(|_| self.is_generic(parameter.ty)) else { return false };
        let sections = &self.declarations.pou(owner).ast().sections;
        let holds =
            |span: Span| span.file == parameter.span.file && (span.start..span.end).contains(&parameter.span.start);
        sections.iter().any(|section| section.kind == ast::SectionKind::InOut && holds(section.span))
    }

    /// A stub does nothing with what it is given, so it takes values, too.
    fn ignored_argument(&mut self, parameter: &Variable, expr: &ast::Expr, passing: &mut Passing) -> Option<Expr> {
        let operand = self.within(None, |body| body.expression(expr))?;
        let value = self.settle(operand)?;
        if self.elementary(value.ty).is_some() {
            passing.before.push(Statement { kind: StatementKind::Evaluate(value), span: expr.span });
        }
        let given = self.temporary(parameter.ty, expr.span)?;
        Some(Expr { kind: ExprKind::Load(given), ty: parameter.ty, span: expr.span })
    }

    /// The class of a type, if variables of it are taken.
    fn class_taken(&self, generic: Generic, ty: TypeId) -> Option<i128> {
        let (class, kind) = self.class_and_kind(ty)?;
        let taken = match (generic, kind) {
            (Generic::Any | Generic::Variant, _) => true,
            (Generic::AnyString, _) => matches!(self.declarations.types().get(ty), Type::Text(_)),
            (_, Some(kind)) => generic.takes(kind),
            (_, None) => false,
        };
        taken.then_some(class)
    }

    /// The number of a type in `__SYSTEM.TYPE_CLASS`, and the kind of its values if they are elementary.
    pub(super) fn class_and_kind(&self, ty: TypeId) -> Option<(i128, Option<Kind>)> {
        Some(match self.declarations.types().get(ty) {
            Type::Elementary(elementary) => (class_of(*elementary), Some(elementary.kind())),
            Type::Subrange { base, .. } => (24, Some(base.kind())),
            Type::Enumeration { base, .. } => (25, Some(base.kind())),
            Type::Text(shape) => (if shape.wide { 17 } else { 16 }, None),
            Type::Reference { kind: ReferenceKind::Reference, .. } => (23, None),
            Type::Reference { .. } | Type::Address { .. } => (22, None),
            Type::Array { .. } => (26, None),
            Type::Struct { .. } | Type::FunctionBlock { .. } => (28, None),
            Type::Interface { .. } => (0xF000, None),
            Type::OpenArray { .. } | Type::Nothing | Type::Null => return None,
        })
    }

    pub(super) fn is_generic(&self, ty: TypeId) -> bool {
        self.declarations.generic(ty).is_some()
    }
}
