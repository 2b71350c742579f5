//! Errors of standard functions that ENO reports (2nd ed. 2.5.1.2, Annex E).
//!
//! With `ENO =>` the caller asks for them; the error then makes ENO FALSE and stops nothing.
//!
//! | function | error |
//! |---|---|
//! | DIV, and time functions that divide | the divisor is 0 |
//! | MUX | the selector is outside of the inputs |
//! | SQRT, LN, LOG, ASIN, ACOS, EXPT and the like | the result is not a number |
//! | conversions of numbers to a type with fewer of them | the number does not fit, or is none |

use crate::check::body::Body;
use crate::check::types::operand::{constant, converted};
use crate::ir::{
    Binary, ElementaryType, Expr, ExprKind, Intrinsic, Place, Rounding, Statement, StatementKind, Storage, TypeId,
    Value,
};
use crate::syntax::Span;

/// A call of a standard function with what reports its errors.
pub(in crate::check) struct Guard {
    pub(in crate::check::body) before: Vec<Statement>,
    /// Must hold for the call to be carried out.
    pub(in crate::check::body) sound: Option<Expr>,
    pub(in crate::check::body) called: Expr,
    /// Holds afterwards if there was no error.
    pub(in crate::check::body) after: Option<Expr>,
}

fn comparison(operator: Binary, left: Expr, right: Expr) -> Expr {
    let span = left.span;
    let kind = ExprKind::Binary(operator, Box::new(left), Box::new(right));
    Expr { kind, ty: ElementaryType::Bool.into(), span }
}

fn both(left: Expr, right: Expr) -> Expr {
    comparison(Binary::And, left, right)
}

fn zero(ty: ElementaryType) -> Value {
    match ty {
        ElementaryType::Real => Value::Real(0.0),
        ElementaryType::Lreal => Value::Lreal(0.0),
        _ => Value::Int(0),
    }
}

impl Body<'_, '_> {
    /// How errors of `called` show, whose value goes to `result`.
    pub(super) fn error_guard(&mut self, called: Expr, result: Option<&Place>) -> Guard {
        let (ty, span) = (called.ty, called.span);
        match called.kind {
            ExprKind::FromRegister(held) => {
                let Guard { before, sound, called, .. } = self.error_guard(*held, None);
                let kind = ExprKind::FromRegister(Box::new(called));
                Guard { before, sound, called: Expr { kind, ty, span }, after: None }
            }
            ExprKind::Binary(Binary::Divide, left, right) => {
                let (mut before, divisor) = self.once(*right);
                let dividend = self.once_more(*left, &mut before);
                let held = self.elementary(divisor.ty).unwrap_or(ElementaryType::Lint);
                let sound = comparison(Binary::NotEqual, divisor.clone(), constant(zero(held), held, span));
                let kind = ExprKind::Binary(Binary::Divide, Box::new(dividend), Box::new(divisor));
                Guard { before, sound: Some(sound), called: Expr { kind, ty, span }, after: None }
            }
            ExprKind::Intrinsic(Intrinsic::Multiplex, mut operands) if operands.len() > 1 => {
                let (before, selector) = self.once(operands.remove(0));
                let lint = |value: usize| constant(Value::Int(value as i128), ElementaryType::Lint, span);
                let low = comparison(Binary::GreaterEqual, selector.clone(), lint(0));
                let high = comparison(Binary::Less, selector.clone(), lint(operands.len()));
                operands.insert(0, selector);
                let kind = ExprKind::Intrinsic(Intrinsic::Multiplex, operands);
                Guard { before, sound: Some(both(low, high)), called: Expr { kind, ty, span }, after: None }
            }
            ExprKind::Convert(rounding, operand) => self.conversion_guard(rounding, *operand, ty, span),
            kind => {
                let after = matches!(kind, ExprKind::Intrinsic(..)).then(|| self.is_number(result, span)).flatten();
                Guard { before: Vec::new(), sound: None, called: Expr { kind, ty, span }, after }
            }
        }
    }

    /// A value that is used twice.
    pub(in crate::check) fn once(&mut self, expr: Expr) -> (Vec<Statement>, Expr) {
        let mut before = Vec::new();
        let again = self.once_more(expr, &mut before);
        (before, again)
    }

    /// Evaluates a value in front of what `before` does already.
    fn once_more(&mut self, expr: Expr, before: &mut Vec<Statement>) -> Expr {
        let (ty, span) = (expr.ty, expr.span);
        let Some(held) = self.elementary(ty) else {
            return expr;
        };
        let place = Place::whole(Storage::Register(self.scope.register(held)), ty, span);
        before.insert(0, Statement { kind: StatementKind::Assign(place.clone(), expr), span });
        Expr { kind: ExprKind::Load(place), ty, span }
    }

    /// Only NaN differs from itself.
    fn is_number(&self, result: Option<&Place>, span: Span) -> Option<Expr> {
        let place = result.filter(|place| self.elementary(place.ty).is_some_and(ElementaryType::is_real))?;
        let value = Expr { kind: ExprKind::Load(place.clone()), ty: place.ty, span };
        Some(comparison(Binary::Equal, value.clone(), value))
    }

    /// The number must be one of the type it is converted to.
    fn conversion_guard(&mut self, rounding: Rounding, operand: Expr, ty: TypeId, span: Span) -> Guard {
        let bounds = match (self.plain_elementary(&operand), self.elementary(ty)) {
            (Some(from), Some(to)) => Bounds::new(from, to, rounding),
            _ => None,
        };
        let Some(Bounds { held, low, strict, high, closed }) = bounds else {
            let kind = ExprKind::Convert(rounding, Box::new(operand));
            return Guard { before: Vec::new(), sound: None, called: Expr { kind, ty, span }, after: None };
        };
        let (before, operand) = self.once(operand);
        let value = converted(operand.clone(), held, rounding);
        let above = if strict { Binary::Greater } else { Binary::GreaterEqual };
        let below = if closed { Binary::LessEqual } else { Binary::Less };
        let sound = both(
            comparison(above, value.clone(), constant(low, held, span)),
            comparison(below, value, constant(high, held, span)),
        );
        let kind = ExprKind::Convert(rounding, Box::new(operand));
        Guard { before, sound: Some(sound), called: Expr { kind, ty, span }, after: None }
    }
}

/// Numbers that a conversion can take.
struct Bounds {
    /// The type in which they are compared.
    held: ElementaryType,
    low: Value,
    /// True if `low` itself is too small.
    strict: bool,
    high: Value,
    /// True if `high` itself is not too great.
    closed: bool,
}

impl Bounds {
    /// Nothing if every number of `from` is one of `to`.
    fn new(from: ElementaryType, to: ElementaryType, rounding: Rounding) -> Option<Self> {
        if !(from.is_number() && to.is_integer()) {
            return None;
        }
        let (low, high) = to.range()?;
        if let Some((least, greatest)) = from.range() {
            let narrower = least < low || greatest > high;
            let (low, high) = (Value::Int(low.max(least)), Value::Int(high.min(greatest)));
            return narrower.then_some(Self { held: from, low, strict: false, high, closed: true });
        }
        // Limits are even below and odd above, so that ties go to the first and beyond the second. A 64 bit
        // limit's neighbour is not an LREAL; there the limit itself stands in.
        let narrow = to.size() < 8;
        let (down, strict) = match rounding {
            Rounding::NearestEven => (0.5, false),
            Rounding::NearestAway => (0.5, narrow || low == 0),
            Rounding::Down => (0.0, false),
            Rounding::Truncate | Rounding::Up => (1.0, narrow || low == 0),
        };
        let (up, closed) = match rounding {
            Rounding::NearestEven | Rounding::NearestAway => (0.5, false),
            Rounding::Up => (0.0, narrow),
            Rounding::Truncate | Rounding::Down => (1.0, false),
        };
        let (low, high) = (Value::Lreal(low as f64 - down), Value::Lreal(high as f64 + up));
        Some(Self { held: ElementaryType::Lreal, low, strict, high, closed })
    }
}
