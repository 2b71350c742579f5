//! Arrays of variable length (3rd ed. 6.5.3, Table 15): `ARRAY [*] OF INT`.
//!
//! The caller describes its array in memory of its own: the address, then each dimension's bounds. What
//! is passed is the description's address, and a unit passes on the one it was given.

use super::{Access, Located};
use crate::check::body::Body;
use crate::check::constant_value;
use crate::check::standard::place::PlaceFunction;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::types::OPEN_BOUNDS;
use crate::ir::{
    Binary, Dimension, ElementaryType, Expr, ExprKind, Intrinsic, Place, Statement, StatementKind, Step, Type, TypeId,
    Value, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, SectionKind};

impl Body<'_, '_> {
    /// The element of an array that comes with its bounds.
    pub(super) fn open_element(&mut self, base: Located, indices: &[ast::Expr], span: Span) -> Option<Located> {
        let Type::OpenArray { dimensions, element } = *self.declarations.types().get(base.place.ty) else {
            return None;
        };
        if dimensions as usize != indices.len() {
            let message = format!("the array has {dimensions} dimensions, there are {} indices", indices.len());
            self.report(Diagnostic::error(Code::WrongDimensions, span, message));
            return None;
        }
        let indices = indices.iter().map(|index| self.open_index(index)).collect::<Vec<_>>();
        let indices: Vec<Expr> = indices.into_iter().collect::<Option<_>>()?;
        let description = base.place;
        let udint = ElementaryType::Udint.into();
        let begin = Expr { kind: ExprKind::Load(description.clone().member(0, udint)), ty: udint, span };
        let mut place = Self::led_to(begin, element, span).place;
        let stride = self.declarations.types().size(element);
        place.steps.push(Step::Open { description: Box::new(description), indices, stride });
        Some(Located { place, access: base.access })
    }

    fn open_index(&mut self, index: &ast::Expr) -> Option<Expr> {
        let operand = self.within(None, |body| body.expression(index))?;
        let index = self.settle(operand)?;
        let index = self.as_index(index);
        if self.plain_elementary(&index).is_some_and(ElementaryType::is_integer) {
            return Some(index);
        }
        let found = self.type_name(index.ty);
        self.mismatch("an integer", &found, index.span)
    }

    /// The description of the array that is given for a parameter without bounds; `before` makes it.
    pub(in crate::check::body) fn described(
        &mut self,
        parameter: &Variable,
        expr: &ast::Expr,
        before: &mut Vec<Statement>,
    ) -> Option<Place> {
        let written = matches!(parameter.section, SectionKind::InOut | SectionKind::Output);
        let place = if written && !self.is_open_input(expr) { self.target(expr)? } else { self.place(expr)?.place };
        if place.ty == parameter.ty {
            return Some(place);
        }
        let suits = |body: &Self| {
            let Type::OpenArray { dimensions: wanted, element: each } = body.declarations.types().get(parameter.ty)
            else {
                return None;
            };
            match body.declarations.types().get(place.ty) {
                Type::Array { dimensions, element } if dimensions.len() == *wanted as usize && element == each => {
                    Some(dimensions.clone())
                }
                _ => None,
            }
        };
        let Some(dimensions) = suits(self) else {
            let (wanted, found) = (self.type_name(parameter.ty), self.type_name(place.ty));
            let message = format!("`{}` is {wanted}, this is {found}", parameter.name);
            self.report(Diagnostic::error(Code::InvalidArgument, expr.span, message));
            return None;
        };
        self.description(parameter.ty, &dimensions, place, before)
    }

    /// True for an input without bounds, which vendors let be handed on to what writes it: it is the caller's own array.
    fn is_open_input(&self, expr: &ast::Expr) -> bool {
        let ast::ExprKind::Name(name) = &expr.kind else { return false };
        let is_handed_on = self.declarations.dialect(expr.span).has(Feature::OpenInputsHandedOn);
        let variable = self.scope.find(&name.key()).filter(|_| is_handed_on);
        variable
            .is_some_and(|found| self.is_open(found.ty) && found.section == SectionKind::Input && !found.is_constant)
    }

    pub(in crate::check) fn is_open(&self, ty: TypeId) -> bool {
        matches!(self.declarations.types().get(ty), Type::OpenArray { .. })
    }

    /// The bounds never change, so they stand in memory from the start.
    fn description(
        &mut self,
        ty: TypeId,
        dimensions: &[Dimension],
        array: Place,
        before: &mut Vec<Statement>,
    ) -> Option<Place> {
        let span = array.span;
        let place = self.temporary(ty, span)?;
        let mut image = vec![0; 4];
        for Dimension { low, high } in dimensions {
            image.extend_from_slice(&(*low as i32).to_le_bytes());
            image.extend_from_slice(&(*high as i32).to_le_bytes());
        }
        if let crate::ir::Storage::Absolute(offset) = place.storage {
            self.declarations.place(offset, image.into());
        }
        let udint = ElementaryType::Udint.into();
        let address = Expr { kind: ExprKind::Address(array), ty: udint, span };
        let begin = place.clone().member(0, udint);
        before.push(Statement { kind: StatementKind::Assign(begin, address), span });
        Some(place)
    }

    /// `LOWER_BOUND(a, 1)`, `UPPER_BOUND(a, 1)`: a constant unless the array comes with its bounds, or the dimension is
    /// known when it runs.
    pub(in crate::check::body) fn bound(
        &mut self,
        function: PlaceFunction,
        array: &ast::Expr,
        number: &ast::Expr,
        span: Span,
    ) -> Option<Operand> {
        let place = self.place(array)?.place;
        let bounds = self.array_bounds(&place, function == PlaceFunction::UpperBound, span);
        if bounds.is_empty() {
            let message = format!("{} is not an array", self.type_name(place.ty));
            self.report(Diagnostic::error(Code::NotIndexable, array.span, message));
            return None;
        }
        let (given, number) = (number.span, self.expression(number)?);
        let dimension = match &number {
            Operand::Integer { value, .. } => Some(*value),
            Operand::Typed(typed) => constant_value(self.declarations.types(), typed).and_then(Value::as_int),
            Operand::Real { .. } | Operand::Text { .. } => None,
        };
        match dimension {
            Some(dimension) => self.bound_of(bounds, dimension, given).map(Operand::Typed),
            None => self.bound_chosen(bounds, number, span).map(Operand::Typed),
        }
    }

    /// The bounds of an array, by its dimensions; none of what is not an array.
    fn array_bounds(&self, array: &Place, upper: bool, span: Span) -> Vec<Expr> {
        let dint: TypeId = ElementaryType::Dint.into();
        let each = |kind| Expr { kind, ty: dint, span };
        match self.declarations.types().get(array.ty) {
            Type::Array { dimensions, .. } => {
                let bound = |of: &Dimension| i128::from(if upper { of.high } else { of.low });
                dimensions.iter().map(|of| each(ExprKind::Constant(Value::Int(bound(of))))).collect()
            }
            Type::OpenArray { dimensions, .. } => {
                let offset = |index| 4 + index * OPEN_BOUNDS + if upper { 4 } else { 0 };
                (0..*dimensions).map(|index| each(ExprKind::Load(array.clone().member(offset(index), dint)))).collect()
            }
            _ => Vec::new(),
        }
    }

    fn bound_of(&mut self, mut bounds: Vec<Expr>, dimension: i128, span: Span) -> Option<Expr> {
        let Some(index) = usize::try_from(dimension - 1).ok().filter(|index| *index < bounds.len()) else {
            let message = format!("the array has the dimensions 1 to {}, not {dimension}", bounds.len());
            self.report(Diagnostic::error(Code::WrongDimensions, span, message));
            return None;
        };
        Some(bounds.swap_remove(index))
    }

    /// A dimension that the program computes chooses among the bounds; one that the array does not have is a fault.
    fn bound_chosen(&mut self, bounds: Vec<Expr>, number: Operand, span: Span) -> Option<Expr> {
        let number = self.integer_as_lint(number)?;
        let ty = number.ty;
        let one = Expr { kind: ExprKind::Constant(Value::Int(1)), ty, span };
        let selector = Expr { kind: ExprKind::Binary(Binary::Subtract, Box::new(number), Box::new(one)), ty, span };
        let operands = std::iter::once(selector).chain(bounds).collect();
        Some(Expr { kind: ExprKind::Intrinsic(Intrinsic::Multiplex, operands), ty: ElementaryType::Dint.into(), span })
    }

    /// Reports an array that would be copied without knowing how much.
    pub(in crate::check::body) fn reject_whole_array<T>(&mut self, span: Span) -> Option<T> {
        let message = "an array without bounds is not copied as a whole";
        let found = Diagnostic::error(Code::OpenArray, span, message);
        self.report(found.with_help("copy its elements, from LOWER_BOUND to UPPER_BOUND"));
        None
    }

    /// Reports a variable without bounds that is not such a parameter.
    pub(in crate::check) fn reject_open_array(&mut self, ty: TypeId, span: Span) -> Option<()> {
        if !self.is_open(ty) {
            return Some(());
        }
        let message = "ARRAY [*] is for VAR_IN_OUT, and VAR_INPUT and VAR_OUTPUT of functions and methods";
        self.report(Diagnostic::error(Code::OpenArray, span, message));
        None
    }
}

/// An input without bounds is the caller's own array, which the function does not write to.
pub(in crate::check) fn access(types: &crate::ir::TypeTable, variable: &Variable) -> Option<Access> {
    let open = matches!(types.get(variable.ty), Type::OpenArray { .. });
    (open && variable.section == SectionKind::Input).then_some(Access::Constant)
}
