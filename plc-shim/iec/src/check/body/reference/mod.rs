//! References and pointers (3rd ed. 6.4.4.10; `POINTER TO` and `REFERENCE TO` of vendors).

pub(super) mod address;

use super::place::{Access, Located};
use super::{Body, Meant};
use crate::check::types::operand::{Operand, constant, converted};
use crate::check::types::reference::target_of;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{
    Binary, ElementaryType, Expr, ExprKind, Place, Rounding, Statement, StatementKind, Step, Storage, Type, TypeId,
    TypeTable, Value,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, ReferenceKind};

/// True for the types that vendors let stand for an address.
fn holds_address(ty: ElementaryType) -> bool {
    matches!(ty, ElementaryType::Udint | ElementaryType::Dword | ElementaryType::Ulint | ElementaryType::Lword)
}

fn joined(operator: Binary, left: Expr, right: Expr, ty: TypeId, span: Span) -> Expr {
    Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), ty, span }
}

impl Body<'_, '_> {
    /// NULL.
    pub(super) fn null(span: Span) -> Expr {
        Expr { kind: ExprKind::Constant(Value::Int(0)), ty: TypeTable::null(), span }
    }

    /// What an address leads to.
    pub(super) fn led_to(address: Expr, target: TypeId, span: Span) -> Located {
        let step = Step::Pointer { address: Box::new(address), target };
        let place = Place { steps: vec![step], ..Place::whole(Storage::Referred, target, span) };
        Located { place, access: Access::ReadWrite }
    }

    /// `a^`
    pub(super) fn dereferenced(&mut self, inner: &ast::Expr, span: Span) -> Option<Located> {
        let operand = self.within(None, |body| body.expression(inner))?;
        let found = self.describe(&operand);
        let reference = match operand {
            Operand::Typed(expr) => target_of(self.declarations.types(), expr.ty).map(|(_, target)| (expr, target)),
            _ => None,
        };
        let Some((expr, target)) = reference else {
            let message = format!("{found} refers to nothing, so `^` leads nowhere");
            self.report(Diagnostic::error(Code::NotAReference, span, message));
            return None;
        };
        Some(Self::led_to(expr, target, span))
    }

    /// A use of a `REFERENCE TO` stands for what it refers to.
    pub(super) fn through_reference(&self, located: Located) -> Located {
        match self.declarations.types().get(located.place.ty) {
            Type::Reference { kind: ReferenceKind::Reference, target } => {
                let (target, span) = (*target, located.place.span);
                let ty = located.place.ty;
                Self::led_to(Expr { kind: ExprKind::Load(located.place), ty, span }, target, span)
            }
            _ => located,
        }
    }

    /// What a function's `REFERENCE TO` refers to.
    pub(super) fn referred_result(&self, result: Operand) -> Operand {
        match result {
            Operand::Typed(expr) => match self.declarations.types().get(expr.ty) {
                Type::Reference { kind: ReferenceKind::Reference, target } => {
                    let (span, target) = (expr.span, *target);
                    let place = Self::led_to(expr, target, span).place;
                    let ty = self.declarations.types().of_value(target);
                    Operand::Typed(Expr { kind: ExprKind::Load(place), ty, span })
                }
                _ => Operand::Typed(expr),
            },
            other => other,
        }
    }

    /// The target of the reference that a property or a call gives, which is a variable like any other. Nothing for
    /// other expressions.
    pub(super) fn referred_place(&mut self, expr: &ast::Expr) -> Meant<Located> {
        let may_refer = match &expr.kind {
            ast::ExprKind::Name(name) | ast::ExprKind::Member(_, name) => {
                self.declarations.has_property_named(&name.key())
            }
            ast::ExprKind::Call(_) => true,
            _ => false,
        };
        if !may_refer {
            return None;
        }
        let known = self.declarations.mark();
        let given = self.given_value(expr)?.map(|value| self.referred_result(value));
        match given {
            Some(Operand::Typed(Expr { kind: ExprKind::Load(place), .. })) if place.storage == Storage::Referred => {
                Some(Some(Located { place, access: Access::ReadWrite }))
            }
            None if self.declarations.has_found_since(known) => Some(None),
            _ => None,
        }
    }

    /// The place of a value of several parts, which lies in memory until the next call.
    pub(super) fn place_of_value(&mut self, value: Operand, span: Span) -> Option<Located> {
        let value = self.referred_result(value);
        let value = self.settle(value)?;
        if let ExprKind::Load(place) = value.kind {
            return Some(Located { place, access: Access::ReadWrite });
        }
        let ty = value.ty;
        if self.elementary(ty).is_some() && !matches!(self.declarations.types().get(ty), Type::Interface { .. }) {
            let message = format!("{} has no members", self.type_name(ty));
            self.report(Diagnostic::error(Code::NotAStructure, span, message));
            return None;
        }
        Some(Located { access: Access::Value, ..Self::led_to(value, ty, span) })
    }

    /// `p[i]` of vendors: so many targets further. The bounds are those of memory.
    pub(super) fn pointed_element(
        &mut self,
        base: Located,
        target: TypeId,
        index: &ast::Expr,
        span: Span,
    ) -> Option<Located> {
        let operand = self.within(None, |body| body.expression(index))?;
        let index = self.settle(operand)?;
        let index = self.as_index(index);
        if !self.plain_elementary(&index).is_some_and(ElementaryType::is_integer) {
            let found = self.type_name(index.ty);
            return self.mismatch("an integer", &found, index.span);
        }
        let ty = base.place.ty;
        let pointer = Expr { kind: ExprKind::Load(base.place), ty, span };
        let size =
            constant(Value::Int(i128::from(self.declarations.types().size(target))), ElementaryType::Udint, span);
        let index = converted(index, ElementaryType::Udint, Rounding::NearestEven);
        let further = joined(Binary::Multiply, index, size, ElementaryType::Udint.into(), span);
        Some(Self::led_to(joined(Binary::Add, pointer, further, ty, span), target, span))
    }

    /// The operand as a reference of type `wanted`.
    pub(super) fn coerce_reference(&mut self, operand: Operand, wanted: TypeId) -> Option<Expr> {
        let null: TypeId = TypeTable::null();
        let (kind, target) = target_of(self.declarations.types(), wanted)?;
        match (operand, kind) {
            (Operand::Typed(expr), _) if expr.ty == wanted || expr.ty == null => Some(Expr { ty: wanted, ..expr }),
            (Operand::Integer { value, span }, ReferenceKind::Pointer) if u32::try_from(value).is_ok() => {
                Some(Expr { ty: wanted, ..constant(Value::Int(value), ElementaryType::Udint, span) })
            }
            (Operand::Typed(expr), ReferenceKind::Pointer) => match *self.declarations.types().get(expr.ty) {
                Type::Address { .. } => Some(Expr { ty: wanted, ..expr }),
                Type::Reference { kind: ReferenceKind::Pointer, target: other } if self.derives(other, target) => {
                    Some(Expr { ty: wanted, ..expr })
                }
                Type::Reference { kind: ReferenceKind::Pointer, target: other } => {
                    self.report_other_pointer(other, target, expr.span);
                    Some(Expr { ty: wanted, ..expr })
                }
                Type::Elementary(ty) if holds_address(ty) => {
                    Some(Expr { ty: wanted, ..converted(expr, ElementaryType::Udint, Rounding::NearestEven) })
                }
                _ => self.no_reference(&Operand::Typed(expr), wanted),
            },
            // To a base one to what is derived from it may be assigned (3rd ed. 6.4.4.10.3).
            (Operand::Typed(expr), ReferenceKind::RefTo) => match *self.declarations.types().get(expr.ty) {
                Type::Reference { kind: ReferenceKind::RefTo, target: other } if self.derives(other, target) => {
                    Some(Expr { ty: wanted, ..expr })
                }
                _ => self.no_reference(&Operand::Typed(expr), wanted),
            },
            (operand, _) => self.no_reference(&operand, wanted),
        }
    }

    fn no_reference<T>(&mut self, operand: &Operand, wanted: TypeId) -> Option<T> {
        let (found, wanted) = (self.describe(operand), self.type_name(wanted));
        self.mismatch(&wanted, &found, operand.span())
    }

    /// An address as a number: vendors assign pointers to DWORD and the like.
    pub(super) fn address_as_number(&self, expr: &Expr, wanted: ElementaryType) -> Option<Expr> {
        let pointer = match self.declarations.types().get(expr.ty) {
            Type::Address { .. } => true,
            Type::Reference { kind, .. } => *kind == ReferenceKind::Pointer,
            _ => false,
        };
        (pointer && holds_address(wanted)).then(|| {
            let number = Expr { ty: ElementaryType::Udint.into(), ..expr.clone() };
            converted(number, wanted, Rounding::NearestEven)
        })
    }

    pub(super) fn is_reference(&self, operand: &Operand) -> bool {
        let types = self.declarations.types();
        matches!(operand, Operand::Typed(expr)
            if target_of(types, expr.ty).is_some() || matches!(types.get(expr.ty), Type::Null))
    }

    /// Comparison (3rd ed. 6.4.4.10.5), and sums of vendors' pointers.
    pub(super) fn reference_operation(
        &mut self,
        operator: Binary,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        let pointer = |body: &Self, operand: &Operand| match operand {
            Operand::Typed(expr) => {
                let found = target_of(body.declarations.types(), expr.ty);
                found.filter(|(kind, _)| *kind == ReferenceKind::Pointer).map(|_| expr.ty)
            }
            _ => None,
        };
        let (left_pointer, right_pointer) = (pointer(self, &left), pointer(self, &right));
        let equality = matches!(operator, Binary::Equal | Binary::NotEqual);
        let ordered = equality || operator.is_comparison() && (left_pointer.is_some() || right_pointer.is_some());
        let sum = matches!(operator, Binary::Add | Binary::Subtract);
        let udint = ElementaryType::Udint.into();
        let (left, right, ty) = match (left_pointer, right_pointer) {
            _ if ordered => {
                let (left, right) = self.comparable(left, right, span)?;
                (left, right, ElementaryType::Bool.into())
            }
            (Some(_), Some(_)) if operator == Binary::Subtract => (self.settle(left)?, self.settle(right)?, udint),
            (Some(ty), None) if sum => (self.settle(left)?, self.distance(right)?, ty),
            (None, Some(ty)) if operator == Binary::Add => (self.settle(right)?, self.distance(left)?, ty),
            _ => return self.invalid_operands(&left, &right, span),
        };
        Some(Operand::Typed(joined(operator, left, right, ty, span)))
    }

    fn comparable(&mut self, left: Operand, right: Operand, span: Span) -> Option<(Expr, Expr)> {
        let loose = |body: &Self, operand: &Operand| match operand {
            Operand::Typed(expr) => match body.declarations.types().get(expr.ty) {
                Type::Reference { kind, .. } => *kind == ReferenceKind::Pointer,
                Type::Elementary(ty) => holds_address(*ty),
                Type::Address { .. } | Type::Null => true,
                _ => false,
            },
            Operand::Integer { value, .. } => u32::try_from(*value).is_ok(),
            _ => false,
        };
        let null: TypeId = TypeTable::null();
        let strict = |left: &Expr, right: &Expr| left.ty == right.ty || left.ty == null || right.ty == null;
        let reference = |body: &Self, operand: &Operand| body.is_reference(operand);
        let allowed = match (&left, &right) {
            (Operand::Typed(first), Operand::Typed(second))
                if reference(self, &left) && reference(self, &right) && strict(first, second) =>
            {
                true
            }
            _ => loose(self, &left) && loose(self, &right),
        };
        if !allowed {
            return self.invalid_operands(&left, &right, span);
        }
        Some((self.as_udint(left)?, self.as_udint(right)?))
    }

    fn as_udint(&mut self, operand: Operand) -> Option<Expr> {
        let expr = self.settle(operand)?;
        Some(match self.plain_elementary(&expr) {
            Some(_) => converted(expr, ElementaryType::Udint, Rounding::NearestEven),
            None => Expr { ty: ElementaryType::Udint.into(), ..expr },
        })
    }

    /// A number of bytes that is added to a pointer.
    fn distance(&mut self, operand: Operand) -> Option<Expr> {
        let expr = self.settle(operand)?;
        match self.plain_elementary(&expr) {
            Some(ty) if ty.is_integer() || ty.is_bits() && ty != ElementaryType::Bool => {
                Some(converted(expr, ElementaryType::Udint, Rounding::NearestEven))
            }
            _ => {
                let found = self.type_name(expr.ty);
                self.mismatch("a number of bytes", &found, expr.span)
            }
        }
    }
}

impl Body<'_, '_> {
    /// `a REF= b`
    pub(super) fn refer(&mut self, target: &ast::Expr, value: &ast::Expr, span: Span) -> Option<Statement> {
        if let Some(found) = self.property_referral(target, value, span) {
            return found;
        }
        let place = self.declared_place(target)?.place;
        self.require_reference_target(place.ty, target.span)?;
        let value = self.referring(place.ty, value)?;
        if let ExprKind::Address(source) = &value.kind {
            self.require_address(source, value.span)?;
        }
        self.note_assigned(&place);
        Some(Statement { kind: StatementKind::Assign(place, value), span })
    }

    /// Reports a target of `REF=` that is not a `REFERENCE TO`.
    pub(super) fn require_reference_target(&mut self, ty: TypeId, span: Span) -> Option<()> {
        if self.is_reference_to(ty) {
            return Some(());
        }
        let message = format!("`REF=` is for REFERENCE TO, this is {}", self.type_name(ty));
        self.report(Diagnostic::error(Code::NotAReference, span, message));
        None
    }

    /// True for a `REFERENCE TO` of vendors.
    pub(super) fn is_reference_to(&self, ty: TypeId) -> bool {
        matches!(self.declarations.types().get(ty), Type::Reference { kind: ReferenceKind::Reference, .. })
    }

    /// A reference of type `wanted`, a `REFERENCE TO`, to the variable `value`; NULL and 0 take it back.
    /// Vendors let it refer to what does not outlive the call.
    pub(super) fn referring(&mut self, wanted: TypeId, value: &ast::Expr) -> Option<Expr> {
        self.referring_to(wanted, value, false)
    }

    /// The same; where nothing is written by it, to a constant, too.
    pub(super) fn referring_to(&mut self, wanted: TypeId, value: &ast::Expr, reads: bool) -> Option<Expr> {
        let (_, target) = target_of(self.declarations.types(), wanted)?;
        let is_null = match &value.kind {
            ast::ExprKind::Literal(ast::Literal::Integer(0)) => true,
            ast::ExprKind::Name(name) => name.key() == "NULL" && self.variable_named(name).is_none(),
            _ => false,
        };
        if is_null {
            return Some(Expr { ty: wanted, ..Self::null(value.span) });
        }
        if let Some(given) = self.given_reference(value) {
            return self.reference_given(given?, wanted);
        }
        let source = self.declared_place(value)?.place;
        if source.ty == wanted {
            return Some(Expr { kind: ExprKind::Load(source), ty: wanted, span: value.span });
        }
        let located = self.place(value)?;
        if !reads {
            self.reject_constant(&located, value.span)?;
        }
        let place = located.place;
        let is_alike = place.ty == target || self.derives(place.ty, target) || self.begins_as(place.ty, target);
        if !is_alike && !self.is_other_pointer(place.ty, target, value.span) {
            let (target, found) = (self.type_name(target), self.type_name(place.ty));
            return self.mismatch(&target, &found, value.span);
        }
        Some(Expr { kind: ExprKind::Address(place), ty: wanted, span: value.span })
    }

    /// True for a pointer where one to another type is wanted, as vendors have it, with a warning.
    pub(super) fn is_other_pointer(&mut self, found: TypeId, wanted: TypeId, span: Span) -> bool {
        let types = self.declarations.types();
        let target = |ty| target_of(types, ty).filter(|(kind, _)| *kind == ReferenceKind::Pointer).map(|(_, to)| to);
        let (Some(found), Some(wanted)) = (target(found), target(wanted)) else { return false };
        if !self.declarations.dialect(span).has(Feature::PointersInOut) {
            return false;
        }
        self.report_other_pointer(found, wanted, span);
        true
    }

    fn report_other_pointer(&mut self, found: TypeId, wanted: TypeId, span: Span) {
        let (wanted, found) = (self.type_name(wanted), self.type_name(found));
        let message = format!("a pointer to {wanted} is made of one to {found}");
        self.report(Diagnostic::warning(Code::PointerOfOtherType, span, message));
    }

    /// What a variable of type `ty` begins with. A `REFERENCE TO` begins as what it refers to, be it written with `:=`
    /// or with `REF=` (CODESYS: data type REFERENCE).
    pub(in crate::check) fn beginning(&mut self, expr: &ast::Expr, ty: TypeId) -> Option<Expr> {
        if !self.is_reference_to(ty) {
            return self.expression_for(expr, ty);
        }
        let value = self.referring(ty, expr)?;
        if let ExprKind::Address(source) = &value.kind {
            self.require_address(source, value.span)?;
        }
        Some(value)
    }

    /// What a call or a property gives, be it between parentheses; nothing if `value` is neither.
    fn given_reference(&mut self, value: &ast::Expr) -> Meant<Operand> {
        match &value.kind {
            ast::ExprKind::Paren(inner) => self.given_reference(inner),
            _ => self.given_value(value),
        }
    }

    /// A reference that a call gave, as one of type `wanted`.
    fn reference_given(&mut self, given: Operand, wanted: TypeId) -> Option<Expr> {
        let given = as_reference(given);
        if let Operand::Typed(expr) = &given {
            let types = self.declarations.types();
            let targets = target_of(types, expr.ty).zip(target_of(types, wanted));
            let is_same = targets.is_some_and(|((_, found), (_, wanted))| found == wanted);
            if is_same || targets.is_some_and(|((_, found), (_, wanted))| self.derives(found, wanted)) {
                return Some(Expr { ty: wanted, ..expr.clone() });
            }
        }
        self.no_reference(&given, wanted)
    }

    /// `a ?= b` (3rd ed. 6.6.6.7): NULL unless `b` refers to what `a` may refer to.
    pub(super) fn attempt(&mut self, target: &ast::Expr, value: &ast::Expr, span: Span) -> Option<Statement> {
        let place = self.target(target)?;
        let operand = self.within(None, |body| body.expression(value))?;
        if matches!(self.declarations.types().get(place.ty), Type::Interface { .. }) {
            return self.attempt_interface(place, operand, span);
        }
        let kind = target_of(self.declarations.types(), place.ty).map(|(kind, _)| kind);
        if kind.is_none() || !self.is_reference(&operand) {
            let wrong = if kind.is_none() { target.span } else { value.span };
            let message = "`?=` assigns references";
            self.report(Diagnostic::error(Code::NotAReference, wrong, message));
            return None;
        }
        let value = match operand {
            Operand::Typed(expr) if expr.ty == place.ty => expr,
            // Without inheritance no other type is ever found at run time.
            _ => Expr { ty: place.ty, ..Self::null(value.span) },
        };
        Some(Statement { kind: StatementKind::Assign(place, value), span })
    }
}

/// The reference that a value was read by, if it was.
pub(super) fn as_reference(value: Operand) -> Operand {
    let read_by = match &value {
        Operand::Typed(Expr { kind: ExprKind::Load(place), .. }) if place.storage == Storage::Referred => {
            match place.steps.as_slice() {
                [Step::Pointer { address, .. }] => Some((**address).clone()),
                _ => None,
            }
        }
        _ => None,
    };
    read_by.map_or(value, Operand::Typed)
}
