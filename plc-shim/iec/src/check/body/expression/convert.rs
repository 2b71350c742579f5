//! Implicit conversions and constants in their context (3rd ed. 6.6.1.6).

use crate::check::body::Body;
use crate::check::standard::conversion;
use crate::check::types::operand::{Operand, constant};
use crate::check::types::reference;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Expr, Field, Type, TypeId, TypeTable, Value};
use crate::syntax::Span;

/// What a structure without a name of its own is called.
const NAMELESS: &str = "STRUCT";

impl Body<'_, '_> {
    pub(in crate::check::body) fn mismatch<T>(&mut self, wanted: &str, found: &str, span: Span) -> Option<T> {
        let message = format!("{wanted} is wanted, this is {found}");
        self.report(Diagnostic::error(Code::TypeMismatch, span, message));
        None
    }

    /// The operand as a value of `target`, or a report why it cannot be one.
    pub(in crate::check) fn coerce(&mut self, operand: Operand, target: TypeId) -> Option<Expr> {
        if let Some(shape) = self.shape(target) {
            return self.coerce_text(operand, shape);
        }
        if let Type::Interface { pou, .. } = *self.declarations.types().get(target) {
            return self.coerce_interface(operand, pou, target);
        }
        if matches!(self.declarations.types().get(target), Type::OpenArray { .. }) {
            return self.reject_whole_array(operand.span());
        }
        if reference::target_of(self.declarations.types(), target).is_some() {
            return self.coerce_reference(operand, target);
        }
        if let Type::Subrange { base, low, high } = *self.declarations.types().get(target) {
            let expr = self.coerce(operand, base.into())?;
            return self.limited(expr, target, low, high);
        }
        let operand = match self.enumerated(operand, target) {
            Ok(value) => return value,
            Err(operand) => operand,
        };
        let wanted = match self.declarations.types().get(target) {
            Type::Elementary(ty) => Some(*ty),
            _ => None,
        };
        match (operand, wanted) {
            (Operand::Typed(expr), _) if expr.ty == target => Some(expr),
            // Inside of its unit an input of type ANY is what the library declares it to be.
            (Operand::Typed(expr), None) if self.is_generic_value(&expr, target) => Some(Expr { ty: target, ..expr }),
            (Operand::Typed(expr), None) if self.is_alike_structure(expr.ty, target, expr.span) => {
                Some(Expr { ty: target, ..expr })
            }
            (Operand::Typed(expr), None) if self.has_base_part(expr.ty, target, expr.span) => {
                Some(Expr { ty: target, ..expr })
            }
            (Operand::Typed(expr), Some(wanted)) => match self.value_as_number(&expr, wanted) {
                Some(value) => Some(value),
                None => self.widen(expr, wanted),
            },
            (Operand::Integer { value, span }, Some(wanted)) => self.literal_integer(value, wanted, span),
            (Operand::Real { value, span }, Some(wanted)) => self.literal_real(value, wanted, span),
            (Operand::Text { text, span }, Some(wanted)) if wanted.is_character() => {
                self.literal_character(&text, wanted, span)
            }
            (operand, _) => {
                let found = self.describe(&operand);
                let wanted = self.type_name(target);
                self.mismatch(&wanted, &found, operand.span())
            }
        }
    }

    /// True for structures that are alike in all members, one of which has no name, where the dialect has that.
    fn is_alike_structure(&self, found: TypeId, wanted: TypeId, span: Span) -> bool {
        let types = self.declarations.types();
        let nameless = |ty| matches!(types.get(ty), Type::Struct { name, .. } if name == NAMELESS);
        let has = self.declarations.dialect(span).has(Feature::AlikeStructures);
        has && (nameless(found) || nameless(wanted)) && is_alike(types, found, wanted)
    }

    /// True for a structure that extends the wanted one, whose members it begins with, where the dialect copies that part.
    fn has_base_part(&self, found: TypeId, wanted: TypeId, span: Span) -> bool {
        let has = self.declarations.dialect(span).has(Feature::BaseParts);
        has && self.declarations.structure_extends(found, wanted)
    }

    fn is_generic_value(&self, expr: &Expr, target: TypeId) -> bool {
        let types = self.declarations.types();
        let is_any_type =
            matches!(types.get(target), Type::Struct { name, .. } if name.eq_ignore_ascii_case("AnyType"));
        is_any_type && self.declarations.generic(expr.ty).is_some() && types.size(expr.ty) == types.size(target)
    }

    pub(in crate::check::body) fn describe(&self, operand: &Operand) -> String {
        match operand {
            Operand::Typed(expr) => self.type_name(expr.ty),
            Operand::Integer { .. } => "an integer".to_owned(),
            Operand::Real { .. } => "a real number".to_owned(),
            Operand::Text { text, .. } => if text.wide { "a WSTRING" } else { "a STRING" }.to_owned(),
        }
    }

    fn widen(&mut self, expr: Expr, wanted: ElementaryType) -> Option<Expr> {
        let expr = self.as_number(expr);
        if let Some(number) = self.address_as_number(&expr, wanted) {
            return Some(number);
        }
        let found = if let Type::Elementary(found) = self.declarations.types().get(expr.ty) {
            *found
        } else {
            let found = self.type_name(expr.ty);
            return self.mismatch(wanted.name(), &found, expr.span);
        };
        if self.widens(found, wanted, expr.span) {
            self.warn_of_loss(&expr, found, wanted);
            self.warn_of_cut_product(&expr, found, wanted);
            self.warn_of_lost_fraction(&expr, found, wanted);
            return Some(self.taken_as(expr, wanted));
        }
        if self.comes_of_narrower(&expr, wanted) {
            let message = format!("this result is kept in {wanted}, which may be too small for it");
            let help = format!("{found}_TO_{wanted} says that it is meant");
            self.report(Diagnostic::warning(Code::LossyConversion, expr.span, message).with_help(help));
            return Some(self.taken_as(expr, wanted));
        }
        let message = format!("{wanted} is wanted, this is {found}");
        let mut report = Diagnostic::error(Code::TypeMismatch, expr.span, message);
        if wanted == ElementaryType::Real
            && let Some(literal) = self.literal_that_widens(&expr)
        {
            let help = format!("a literal beside an integer is an {found}: `{wanted}#` before it makes it a {wanted}");
            report = report.with_label(literal, "this one").with_help(help);
        } else if conversion::is_defined(found, wanted) {
            report = report.with_help(format!("convert it with {found}_TO_{wanted}"));
        }
        self.report(report);
        None
    }

    fn literal_integer(&mut self, value: i128, wanted: ElementaryType, span: Span) -> Option<Expr> {
        match (wanted, wanted.range()) {
            (ElementaryType::Real, _) => Some(constant(Value::Real(value as f32), wanted, span)),
            (ElementaryType::Lreal, _) => Some(constant(Value::Lreal(value as f64), wanted, span)),
            _ if !wanted.takes_integers() => {
                let message = format!("{wanted} is wanted, this is an integer");
                let found = Diagnostic::error(Code::TypeMismatch, span, message);
                let help = wanted.is_duration().then(|| "write a duration, as in T#200ms".to_owned());
                self.report(found.with_optional_help(help));
                None
            }
            (_, Some((low, high))) if (low..=high).contains(&value) => {
                // BOOL has the literals 0 and 1 too (2nd ed. Table 1).
                let boolean = wanted == ElementaryType::Bool;
                let value = if boolean { Value::Bool(value == 1) } else { Value::Int(value) };
                Some(constant(value, wanted, span))
            }
            (_, Some((0, high))) if self.changes_sign(value, high, span) => {
                let wrapped = wanted.wrap(value);
                let message = format!("{value} becomes {wrapped} as {wanted}");
                self.report(Diagnostic::warning(Code::LossyConversion, span, message));
                Some(constant(Value::Int(wrapped), wanted, span))
            }
            (_, range) => {
                let (low, high) = range.unwrap_or((0, 0));
                let message = format!("{value} does not fit {wanted} ({low} to {high})");
                self.report(Diagnostic::error(Code::OutOfRange, span, message));
                None
            }
        }
    }

    /// True for a negative literal that vendors take as the unsigned number of its bits, as they do with variables.
    fn changes_sign(&self, value: i128, high: i128, span: Span) -> bool {
        let dialect = self.declarations.dialect(span);
        dialect.has(Feature::SignChange) && value < 0 && value >= -(high / 2) - 1
    }

    fn literal_real(&mut self, value: f64, wanted: ElementaryType, span: Span) -> Option<Expr> {
        match wanted {
            ElementaryType::Lreal => Some(constant(Value::Lreal(value), wanted, span)),
            ElementaryType::Real if (value as f32).is_finite() => {
                Some(constant(Value::Real(value as f32), wanted, span))
            }
            ElementaryType::Real => {
                let message = format!("{value:e} does not fit REAL");
                self.report(Diagnostic::error(Code::OutOfRange, span, message));
                None
            }
            _ => self.mismatch(wanted.name(), "a real number", span),
        }
    }

    /// The operand with the type it has on its own: integers DINT or, if they need it, LINT or
    /// ULINT; reals LREAL.
    pub(in crate::check::body) fn settle(&mut self, operand: Operand) -> Option<Expr> {
        match operand {
            Operand::Typed(expr) => Some(expr),
            Operand::Text { text, span } => self.settled_text(&text, span),
            Operand::Real { value, span } => Some(constant(Value::Lreal(value), ElementaryType::Lreal, span)),
            Operand::Integer { value, span } => {
                let types = [ElementaryType::Dint, ElementaryType::Lint, ElementaryType::Ulint];
                let fits = types.into_iter().find(|ty| ty.wrap(value) == value);
                self.literal_integer(value, fits.unwrap_or(ElementaryType::Ulint), span)
            }
        }
    }

    /// True if a constant without type can be one of `ty`.
    pub(in crate::check::body) fn adapts(operand: &Operand, ty: ElementaryType) -> bool {
        match operand {
            Operand::Typed(_) => false,
            Operand::Text { text, .. } => Self::as_character(text, ty).is_some(),
            Operand::Real { value, .. } => {
                ty == ElementaryType::Lreal || ty == ElementaryType::Real && (*value as f32).is_finite()
            }
            Operand::Integer { value, .. } => {
                ty.takes_integers() && ty.range().is_none_or(|(low, high)| (low..=high).contains(value))
            }
        }
    }

    /// An expression that must be of elementary type `ty`.
    pub(in crate::check::body) fn expression_of(
        &mut self,
        expr: &crate::syntax::ast::Expr,
        ty: ElementaryType,
    ) -> Option<Expr> {
        self.expression_for(expr, ty.into())
    }

    /// An expression that must be of type `ty`.
    pub(in crate::check) fn expression_for(&mut self, expr: &crate::syntax::ast::Expr, ty: TypeId) -> Option<Expr> {
        let context = self.elementary(ty);
        let operand = self.within(context, |body| body.wanting(Some(ty), |body| body.expression(expr)))?;
        self.coerce(operand, ty)
    }

    /// Runs `check` where the place wants `context`.
    pub(in crate::check::body) fn within<T>(
        &mut self,
        context: Option<ElementaryType>,
        check: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let outer = std::mem::replace(&mut self.context, context);
        let checked = self.wanting(None, check);
        self.context = outer;
        checked
    }
}

fn is_alike(types: &TypeTable, one: TypeId, other: TypeId) -> bool {
    match (types.get(one), types.get(other)) {
        _ if one == other => true,
        (Type::Struct { fields: one, .. }, Type::Struct { fields: other, .. }) => {
            let pair = |(one, other): (&Field, &Field)| {
                let place = one.offset == other.offset && one.bit == other.bit;
                place && one.name.eq_ignore_ascii_case(&other.name) && is_alike(types, one.ty, other.ty)
            };
            one.len() == other.len() && one.iter().zip(other).all(pair)
        }
        _ => false,
    }
}
