//! `VARIANT` of Siemens: parameters that take a variable of any type, and questions for that type.

use crate::check::body::{Body, Meant};
use crate::check::types::generic::{Generic, class_of};
use crate::check::types::operand::{Operand, constant};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Expr, Type, TypeId, Value, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};

/// Functions whose results are compared with names of types.
const QUESTIONS: [&str; 2] = ["TYPEOF", "TYPEOFELEMENTS"];
/// Numbers of derived types begin behind those of elementary types.
const FIRST_DERIVED: i128 = 1_000;

impl Body<'_, '_> {
    /// The number of the type that `expr` names, where `question` asks for a type: `TypeOf(#v) = Int`.
    pub(in crate::check::body) fn type_asked(&mut self, question: &ast::Expr, expr: &ast::Expr) -> Meant<Operand> {
        if !self.asks_for_type(question) {
            return None;
        }
        match self.type_written(expr) {
            Some(ty) => Some(ty.map(|ty| self.type_number(ty, expr.span))),
            None if self.asks_for_type(expr) => None,
            None => {
                let message = "this is not a type, and not what TypeOf gives";
                let found = Diagnostic::error(Code::TypeMismatch, expr.span, message);
                self.report(found.with_help("compare with a type by its name, as in `TypeOf(#v) = Int`"));
                Some(None)
            }
        }
    }

    /// True for a call of `TypeOf` and the like.
    fn asks_for_type(&self, expr: &ast::Expr) -> bool {
        let ast::ExprKind::Call(call) = &expr.kind else { return false };
        let ast::ExprKind::Name(name) = &call.callee.kind else { return false };
        QUESTIONS.contains(&name.key().as_str()) && self.declarations.dialect(expr.span).has(Feature::Variants)
    }

    fn type_number(&self, ty: TypeId, span: Span) -> Operand {
        let udint = ElementaryType::Udint;
        Operand::Typed(Expr { ty: udint.into(), ..constant(Value::Int(self.type_code(ty)), udint, span) })
    }

    /// The number that distinguishes types while a program runs. Strings of any length are one type.
    pub(super) fn type_code(&self, ty: TypeId) -> i128 {
        match self.declarations.types().get(ty) {
            Type::Elementary(elementary) => class_of(*elementary),
            Type::Text(shape) => 16 + i128::from(shape.wide),
            _ => FIRST_DERIVED + i128::from(ty.number()),
        }
    }

    /// The parameter of type VARIANT that `=>` gives its variable, as TIA Portal writes it.
    pub(super) fn variant_given_back<'s>(
        &self,
        scope: &'s crate::check::declare::Scope,
        name: &Ident,
    ) -> Option<&'s Variable> {
        let found = scope.inputs().find(|variable| variable.name.eq_ignore_ascii_case(&name.text))?;
        (self.declarations.generic(found.ty) == Some(Generic::Variant)).then_some(found)
    }

    /// True for the name of a VARIANT.
    pub(super) fn is_variant(&self, expr: &ast::Expr) -> bool {
        let ast::ExprKind::Name(name) = &expr.kind else { return false };
        let variable = self.scope.find(&name.key());
        variable.is_some_and(|variable| self.declarations.generic(variable.ty) == Some(Generic::Variant))
    }

    /// `#v = NULL`: whether a VARIANT points to nothing, asked of its address.
    pub(in crate::check::body) fn address_of_variant(
        &mut self,
        expr: &ast::Expr,
        other: &ast::Expr,
    ) -> Option<ast::Expr> {
        let is_null = matches!(&other.kind, ast::ExprKind::Name(name) if name.key() == "NULL");
        if !is_null || !self.is_variant(expr) {
            return None;
        }
        let member = Ident { text: "pValue".to_owned(), span: expr.span };
        let kind = ast::ExprKind::Member(Box::new(expr.clone()), member);
        Some(ast::Expr { kind, span: expr.span, height: expr.height + 1 })
    }
}
