//! Generic inputs of vendors' units (CODESYS, TwinCAT: `ANY`, `ANY_NUM` and the like): what is given is a
//! variable of one of the types; the unit sees its class, address and size.

use super::argument::Passing;
use super::build::assign;
use super::convert::constant;
use super::names::TypedImage;
use super::scope::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::elementary::Kind;
use crate::ir::{Argument, ElementaryType, Expr, ExprKind, Place, Type, TypeId, Value, Variable};
use crate::syntax::ast::{self, Ident, PouKind, ReferenceKind, SectionKind, TypeSpecKind};

/// A generic type that an input may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Generic {
    Any,
    AnyBit,
    AnyDate,
    AnyNum,
    AnyReal,
    AnyInt,
    AnyString,
}

impl Generic {
    const ALL: [Self; 7] =
        [Self::Any, Self::AnyBit, Self::AnyDate, Self::AnyNum, Self::AnyReal, Self::AnyInt, Self::AnyString];

    fn name(self) -> &'static str {
        match self {
            Self::Any => "ANY",
            Self::AnyBit => "ANY_BIT",
            Self::AnyDate => "ANY_DATE",
            Self::AnyNum => "ANY_NUM",
            Self::AnyReal => "ANY_REAL",
            Self::AnyInt => "ANY_INT",
            Self::AnyString => "ANY_STRING",
        }
    }

    /// The generic type of this name, in capitals.
    pub(super) fn find(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|generic| generic.name() == key)
    }

    /// True if variables of elementary types of the kind are taken.
    fn takes(self, kind: Kind) -> bool {
        let integer = matches!(kind, Kind::Signed | Kind::Unsigned);
        match self {
            Self::Any => true,
            Self::AnyBit => matches!(kind, Kind::Bool | Kind::Bits),
            Self::AnyDate => matches!(kind, Kind::Date | Kind::TimeOfDay | Kind::DateTime),
            Self::AnyNum => integer || kind == Kind::Real,
            Self::AnyReal => kind == Kind::Real,
            Self::AnyInt => integer,
            Self::AnyString => false,
        }
    }
}

/// Numbers of `__SYSTEM.TYPE_CLASS` (CODESYS, Base Interfaces: `TypeClass`).
fn class_of(ty: ElementaryType) -> i128 {
    use ElementaryType as E;
    match ty {
        E::Bool => 0,
        E::Byte => 2,
        E::Word => 3,
        E::Dword => 4,
        E::Lword => 5,
        E::Sint => 6,
        E::Int => 7,
        E::Dint => 8,
        E::Lint => 9,
        E::Usint => 10,
        E::Uint => 11,
        E::Udint => 12,
        E::Ulint => 13,
        E::Real => 14,
        E::Lreal => 15,
        E::Time => 18,
        E::Date => 19,
        E::Dt => 20,
        E::Tod => 21,
        E::Ltime => 37,
        E::Ldate => 46,
        E::Ldt => 47,
        E::Ltod => 48,
        // Vendors have no single characters.
        E::Char | E::Wchar => NO_CLASS,
    }
}

const NO_CLASS: i128 = 29;

impl<'a> Body<'_, 'a> {
    /// The type of a generic input; nothing if it is declared with another.
    pub(super) fn generic_input(
        &mut self,
        unit: PouKind,
        section: SectionKind,
        spec: &'a ast::TypeSpec,
    ) -> super::Meant<TypedImage<'a>> {
        let TypeSpecKind::Name(name) = &spec.kind else { return None };
        let generic = Generic::find(&name.key()).filter(|_| self.checker.type_key(&name.key()).is_none())?;
        let suitable = matches!(unit, PouKind::Function | PouKind::Method | PouKind::FunctionBlock);
        if section != SectionKind::Input || !suitable {
            self.reject_generic(name);
            return Some(None);
        }
        let ty = self.generic_type(generic);
        Some(ty.map(|ty| self.whole(ty)))
    }

    /// Reports a generic type where no argument could say which type is meant.
    pub(super) fn reject_generic(&mut self, name: &Ident) {
        let message = format!("{} is for VAR_INPUT of functions, methods and function blocks", name.key());
        self.report(Diagnostic::error(Code::WrongSection, name.span, message));
    }

    /// What the unit sees: `__SYSTEM.AnyType` under the name of the generic type.
    fn generic_type(&mut self, generic: Generic) -> Option<TypeId> {
        if let Some((found, _)) = self.checker.generics.iter().find(|(_, known)| **known == generic) {
            return Some(*found);
        }
        let seen = self.checker.named_type("__SYSTEM.ANYTYPE", None)?.ty;
        let Type::Struct { fields, .. } = self.checker.types.get(seen).clone() else { return None };
        let image = self.checker.types.image(seen).clone();
        let ty = self.checker.types.structure(generic.name().to_owned());
        self.checker.types.complete_structure(ty, fields, image);
        self.checker.generics.insert(ty, generic);
        Some(ty)
    }

    /// What an input of a generic type is given: class, address and size of a variable.
    pub(super) fn generic_argument(
        &mut self,
        generic: Generic,
        parameter: &Variable,
        expr: &ast::Expr,
        passing: &mut Passing,
    ) -> Option<Argument> {
        let variable = self.place(expr)?.place;
        let span = expr.span;
        if self.checker.generics.contains_key(&variable.ty) && (generic == Generic::Any || variable.ty == parameter.ty)
        {
            return Some(Argument::Value(Expr { kind: ExprKind::Load(variable), ty: parameter.ty, span }));
        }
        let Some(class) = self.class_taken(generic, variable.ty) else {
            let message =
                format!("`{}` is {}, this is {}", parameter.name, generic.name(), self.type_name(variable.ty));
            self.report(Diagnostic::error(Code::InvalidArgument, span, message));
            return None;
        };
        let size = self.checker.types.size(variable.ty);
        let memory = self.through_memory(variable, passing)?;
        let given = self.temporary(parameter.ty, span)?;
        let Type::Struct { fields, .. } = self.checker.types.get(parameter.ty).clone() else { return None };
        let udint = |value, ty| Expr { ty, ..constant(Value::Int(value), ElementaryType::Udint, span) };
        for field in fields {
            let member = given.clone().member(field.offset, field.ty);
            let value = match field.name.as_str() {
                "TypeClass" => udint(class, field.ty),
                "pValue" => Expr { kind: ExprKind::Address(memory.clone()), ty: field.ty, span },
                _ => constant(Value::Int(i128::from(size)), ElementaryType::Dint, span),
            };
            passing.before.push(assign(&member, value));
        }
        Some(Argument::Value(Expr { kind: ExprKind::Load(Place { span, ..given }), ty: parameter.ty, span }))
    }

    /// The class of a type, if variables of it are taken.
    fn class_taken(&self, generic: Generic, ty: TypeId) -> Option<i128> {
        let (class, kind) = match self.checker.types.get(ty) {
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
        };
        let taken = match (generic, kind) {
            (Generic::Any, _) => true,
            (Generic::AnyString, _) => matches!(self.checker.types.get(ty), Type::Text(_)),
            (_, Some(kind)) => generic.takes(kind),
            (_, None) => false,
        };
        taken.then_some(class)
    }

    pub(super) fn is_generic(&self, ty: TypeId) -> bool {
        self.checker.generics.contains_key(&ty)
    }
}
