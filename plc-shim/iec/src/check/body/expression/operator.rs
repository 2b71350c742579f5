//! Operators on typed operands (2nd ed. 2.5.1.5, Tables 23 to 30).

use crate::check::body::Body;
use crate::check::types::constant;
use crate::check::types::operand::{Operand, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Rounding, Unary, Value};
use crate::syntax::Span;
use crate::syntax::ast::{BinaryOp, UnaryOp};

/// Two operands of one elementary type.
pub(in crate::check) struct Pair {
    pub(in crate::check::body) left: Expr,
    pub(in crate::check::body) right: Expr,
    pub(in crate::check::body) ty: ElementaryType,
}

fn resolved(operator: BinaryOp) -> Option<Binary> {
    Some(match operator {
        // Those that are evaluated in part only are not operations on two values.
        BinaryOp::Power | BinaryOp::AndThen | BinaryOp::OrElse => return None,
        BinaryOp::Multiply => Binary::Multiply,
        BinaryOp::Divide => Binary::Divide,
        BinaryOp::Modulo => Binary::Modulo,
        BinaryOp::Add => Binary::Add,
        BinaryOp::Subtract => Binary::Subtract,
        BinaryOp::Less => Binary::Less,
        BinaryOp::Greater => Binary::Greater,
        BinaryOp::LessEqual => Binary::LessEqual,
        BinaryOp::GreaterEqual => Binary::GreaterEqual,
        BinaryOp::Equal => Binary::Equal,
        BinaryOp::NotEqual => Binary::NotEqual,
        BinaryOp::And => Binary::And,
        BinaryOp::Xor => Binary::Xor,
        BinaryOp::Or => Binary::Or,
    })
}

impl Body<'_, '_> {
    pub(in crate::check) fn unary(&mut self, operator: UnaryOp, operand: Operand, span: Span) -> Option<Operand> {
        match (operator, operand) {
            (UnaryOp::Negate, Operand::Integer { value, .. }) => {
                Some(Operand::Integer { value: value.wrapping_neg(), span })
            }
            (UnaryOp::Negate, Operand::Real { value, .. }) => Some(Operand::Real { value: -value, span }),
            (UnaryOp::Plus, operand @ (Operand::Integer { .. } | Operand::Real { .. })) => {
                Some(operand.with_span(span))
            }
            (UnaryOp::Not, operand) => self.not(operand, span),
            (operator, Operand::Typed(expr)) => self.signed(operator, expr, span),
            (operator, operand @ Operand::Text { .. }) => {
                let expr = self.settle(operand)?;
                self.signed(operator, expr, span)
            }
        }
    }

    fn signed(&mut self, operator: UnaryOp, expr: Expr, span: Span) -> Option<Operand> {
        let expr = self.as_signed_number(expr);
        let ty = self.plain_elementary(&expr);
        if !ty.is_some_and(|ty| ty.is_signed() && !ty.is_calendar() || ty.is_real()) {
            let message = format!("{} has no sign", self.type_name(expr.ty));
            self.report(Diagnostic::error(Code::InvalidOperand, span, message));
            return None;
        }
        if operator == UnaryOp::Plus {
            return Some(Operand::Typed(expr));
        }
        let ty = expr.ty;
        let kind = ExprKind::Unary(Unary::Negate, Box::new(expr));
        Some(Operand::Typed(self.time_value(Expr { kind, ty, span })))
    }

    pub(in crate::check) fn not(&mut self, operand: Operand, span: Span) -> Option<Operand> {
        match operand {
            Operand::Typed(expr) if self.plain_elementary(&expr).is_some_and(|ty| self.has_bits(ty, span)) => {
                let ty = expr.ty;
                let kind = ExprKind::Unary(Unary::Not, Box::new(expr));
                Some(Operand::Typed(Expr { kind, ty, span }))
            }
            other => {
                let message = format!("NOT is for BOOL and bit strings, not {}", self.describe(&other));
                self.report(Diagnostic::error(Code::InvalidOperand, span, message));
                None
            }
        }
    }

    /// The elementary type, enumerations left out: they know assignment and comparison only.
    pub(in crate::check::body) fn plain_elementary(&self, expr: &Expr) -> Option<ElementaryType> {
        match self.declarations.types().get(expr.ty) {
            crate::ir::Type::Elementary(ty) => Some(*ty),
            _ => None,
        }
    }

    pub(in crate::check) fn binary(
        &mut self,
        operator: BinaryOp,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        match resolved(operator) {
            Some(operator) => self.operation(operator, left, right, span),
            None => self.power(left, right, span),
        }
    }

    pub(in crate::check) fn operation(
        &mut self,
        operator: Binary,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        if matches!(operator, Binary::Add | Binary::And) && (self.is_text(&left) || self.is_text(&right)) {
            let help = "strings are joined by `CONCAT(a, b)`, a number becomes text by `DINT_TO_STRING(n)`";
            return self.not_joined(&left, &right, span, Some(help.to_owned()));
        }
        if !operator.is_comparison() && !matches!((&left, &right), (Operand::Typed(_), _) | (_, Operand::Typed(_))) {
            return self.fold_literals(operator, &left, &right, span);
        }
        if !operator.is_comparison() {
            self.refuse_strict_operands([&left, &right])?;
        }
        let (left, right) = self.as_numbers(left, right, operator.is_comparison());
        if self.is_interface(&left) || self.is_interface(&right) {
            return self.interface_comparison(operator, left, right, span);
        }
        if self.is_reference(&left) || self.is_reference(&right) {
            return self.reference_operation(operator, left, right, span);
        }
        if operator.is_comparison() {
            return self.comparison(operator, left, right, span);
        }
        if matches!(operator, Binary::And | Binary::Or | Binary::Xor) {
            return self.bitwise(operator, left, right, span);
        }
        if self.is_calendar(&left) || self.is_calendar(&right) {
            return self.calendar_operation(operator, left, right, span);
        }
        if self.is_duration(&left) || self.is_duration(&right) {
            return self.duration_operation(operator, left, right, span);
        }
        let wanted = if operator == Binary::Modulo { "integers" } else { "numbers" };
        let pair = self.unify(operator, left, right, wanted, span)?;
        let bits = pair.ty.is_bits() && self.bits_are_numbers(pair.ty, span);
        let allowed = bits || if operator == Binary::Modulo { pair.ty.is_integer() } else { pair.ty.is_number() };
        if !allowed {
            let message = format!("this operator is for {wanted}, not {}", pair.ty);
            let help = pair.ty.is_bits().then_some("convert bit strings to an integer type first");
            let found = Diagnostic::error(Code::InvalidOperand, span, message);
            self.report(found.with_optional_help(help.map(str::to_owned)));
            return None;
        }
        let ty = pair.ty.into();
        let operator = self.division(operator, span);
        let (left, right) = match operator {
            Binary::Divide | Binary::DivideAnyway | Binary::Modulo => self.whole_operands(pair.left, pair.right),
            _ => (pair.left, pair.right),
        };
        let held = left.ty;
        let kind = ExprKind::Binary(operator, Box::new(left), Box::new(right));
        Some(Self::cut(kind, held, ty, span))
    }

    /// Two constants without type make a third.
    fn fold_literals(&mut self, operator: Binary, left: &Operand, right: &Operand, span: Span) -> Option<Operand> {
        let real = |operand: &Operand| match operand {
            Operand::Integer { value, .. } => *value as f64,
            Operand::Real { value, .. } => *value,
            Operand::Typed(_) | Operand::Text { .. } => 0.0,
        };
        let folded = match (left, right) {
            (Operand::Text { .. }, _) | (_, Operand::Text { .. }) => return self.invalid_operands(left, right, span),
            (Operand::Integer { value: left, .. }, Operand::Integer { value: right, .. }) => {
                self.warn_of_lost_fraction_of(operator, (*left, *right), span);
                constant::integer(operator, *left, *right).map(|value| Operand::Integer { value, span })
            }
            _ if matches!(operator, Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide) => {
                let value = constant::real(operator, real(left), real(right));
                value.map(|value| Operand::Real { value, span })
            }
            _ => return self.invalid_operands(left, right, span),
        };
        if folded.is_err() {
            let message = "a constant is divided by zero";
            self.report(Diagnostic::error(Code::ConstantDivisionByZero, span, message));
        }
        folded.ok()
    }

    pub(in crate::check::body) fn invalid_operands<T>(
        &mut self,
        left: &Operand,
        right: &Operand,
        span: Span,
    ) -> Option<T> {
        self.not_joined(left, right, span, None)
    }

    fn not_joined<T>(&mut self, left: &Operand, right: &Operand, span: Span, help: Option<String>) -> Option<T> {
        let (left, right) = (self.describe(left), self.describe(right));
        let message = format!("this operator does not join {left} and {right}");
        self.report(Diagnostic::error(Code::InvalidOperand, span, message).with_optional_help(help));
        None
    }

    fn comparison(&mut self, operator: Binary, left: Operand, right: Operand, span: Span) -> Option<Operand> {
        if self.is_text(&left) || self.is_text(&right) {
            return self.text_comparison(operator, left, right, span);
        }
        let (left, right) = self.milliseconds_beside_time(left, right);
        let (left, right) = match (left, right) {
            (Operand::Typed(left), Operand::Typed(right))
                if left.ty == right.ty && self.elementary(left.ty).is_some() =>
            {
                (left, right)
            }
            (left, right) => {
                let pair = self.unify(operator, left, right, "elementary values", span)?;
                (pair.left, pair.right)
            }
        };
        let (left, right) = (self.unsigned_duration(left), self.unsigned_duration(right));
        self.warn_of_uncut_difference(&left);
        self.warn_of_uncut_difference(&right);
        let (left, right) = self.whole_operands(left, right);
        let kind = ExprKind::Binary(operator, Box::new(left), Box::new(right));
        Some(Operand::Typed(Expr { kind, ty: ElementaryType::Bool.into(), span }))
    }

    /// A number beside a TIME as so many milliseconds, where vendors have it so.
    fn milliseconds_beside_time(&self, left: Operand, right: Operand) -> (Operand, Operand) {
        let time = ElementaryType::Time;
        let is_time = |operand: &Operand| {
            let has = |span| self.declarations.dialect(span).has(Feature::TimesBesideNumbers);
            operand.typed().is_some_and(|expr| expr.ty == time.into() && has(expr.span))
        };
        let of_ms = |value: i128, span| {
            let kind = ExprKind::Constant(Value::Int(value.saturating_mul(1_000_000)));
            Operand::Typed(Expr { kind, ty: time.into(), span })
        };
        match (left, right) {
            (left, Operand::Integer { value, span }) if is_time(&left) => (left, of_ms(value, span)),
            (Operand::Integer { value, span }, right) if is_time(&right) => (of_ms(value, span), right),
            others => others,
        }
    }

    fn bitwise(&mut self, operator: Binary, left: Operand, right: Operand, span: Span) -> Option<Operand> {
        let pair = self.unify(operator, left, right, "BOOL and bit strings", span)?;
        if !pair.ty.is_bits() && !self.bits_are_numbers(pair.ty, span) {
            let message = format!("AND, OR, XOR are for BOOL and bit strings, not {}", pair.ty);
            let found = Diagnostic::error(Code::InvalidOperand, span, message);
            self.report(found.with_help("convert integers to a bit string type first"));
            return None;
        }
        let ty = pair.ty.into();
        let kind = ExprKind::Binary(operator, Box::new(pair.left), Box::new(pair.right));
        Some(Operand::Typed(Expr { kind, ty, span }))
    }

    /// Both operands in the smallest type that holds both.
    pub(in crate::check::body) fn unify(
        &mut self,
        _operator: Binary,
        left: Operand,
        right: Operand,
        _wanted: &str,
        span: Span,
    ) -> Option<Pair> {
        let ty = self.common_type(&left, &right, span);
        let Some(ty) = ty else {
            return self.invalid_operands(&left, &right, span);
        };
        let left = self.coerce(left, ty.into())?;
        let right = self.coerce(right, ty.into())?;
        Some(Pair { left, right, ty })
    }

    fn common_type(&mut self, left: &Operand, right: &Operand, span: Span) -> Option<ElementaryType> {
        let (left_ty, right_ty) = (self.own_type(left), self.own_type(right));
        match (left_ty, right_ty) {
            (Some(ty), None) if Self::adapts(right, ty) => Some(ty),
            (None, Some(ty)) if Self::adapts(left, ty) => Some(ty),
            _ => {
                let left = self.settled_type(left)?;
                let right = self.settled_type(right)?;
                self.common(left, right, span)
            }
        }
    }

    fn own_type(&self, operand: &Operand) -> Option<ElementaryType> {
        match operand {
            Operand::Typed(expr) => self.plain_elementary(expr),
            _ => None,
        }
    }

    fn settled_type(&mut self, operand: &Operand) -> Option<ElementaryType> {
        if let Operand::Typed(expr) = operand {
            return self.plain_elementary(expr);
        }
        let expr = self.settle(operand.clone())?;
        self.plain_elementary(&expr)
    }

    fn is_duration(&self, operand: &Operand) -> bool {
        self.own_type(operand).is_some_and(ElementaryType::is_duration)
    }

    /// 2nd ed. Table 30: durations are added, and scaled by numbers.
    fn duration_operation(&mut self, operator: Binary, left: Operand, right: Operand, span: Span) -> Option<Operand> {
        match (operator, left, right) {
            (Binary::Add | Binary::Subtract, left, right) => {
                let pair = self.unify(operator, left, right, "durations", span)?;
                let ty = pair.ty.into();
                let kind = ExprKind::Binary(operator, Box::new(pair.left), Box::new(pair.right));
                Some(Operand::Typed(self.time_value(Expr { kind, ty, span })))
            }
            (Binary::Multiply | Binary::Divide, Operand::Typed(left), right)
                if self.plain_elementary(&left).is_some_and(ElementaryType::is_duration)
                    && !self.is_duration(&right) =>
            {
                self.scale(operator, left, right, span)
            }
            // The standard wants the duration first; a product may be turned around.
            (Binary::Multiply, left, Operand::Typed(right)) if !self.is_duration(&left) => {
                self.scale(operator, right, left, span)
            }
            (_, left, right) => self.invalid_operands(&left, &right, span),
        }
    }

    fn scale(&mut self, operator: Binary, duration: Expr, factor: Operand, span: Span) -> Option<Operand> {
        let factor = self.settle(factor)?;
        let duration_ty = self.plain_elementary(&duration)?;
        let Some(ty) = self.plain_elementary(&factor).filter(|ty| ty.is_number()) else {
            let (left, right) = (Operand::Typed(duration), Operand::Typed(factor));
            return self.invalid_operands(&left, &right, span);
        };
        let exact = |operator, left: Expr, right: Expr| {
            let ty = left.ty;
            Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), ty, span }
        };
        let duration = self.unsigned_duration(duration);
        if ty.is_integer() {
            let counted =
                if duration.ty == ElementaryType::Ulint.into() { duration.ty } else { ElementaryType::Lint.into() };
            let factor = self.taken_as(factor, ElementaryType::Lint);
            let factor = if counted == ElementaryType::Ulint.into() {
                converted(factor, ElementaryType::Ulint, Rounding::NearestEven)
            } else {
                factor
            };
            let operator = self.division(operator, span);
            let scaled = converted(exact(operator, duration, factor), duration_ty, Rounding::NearestEven);
            return Some(Operand::Typed(self.time_value(scaled)));
        }
        let lreal = ElementaryType::Lreal;
        let duration = converted(duration, lreal, Rounding::NearestEven);
        let factor = self.taken_as(factor, lreal);
        let operator = self.division(operator, span);
        let product = exact(operator, duration, factor);
        let scaled = converted(product, duration_ty, Rounding::NearestEven);
        Some(Operand::Typed(self.time_value(scaled)))
    }

    /// 2nd ed. Table 24: the base is a real number, and so is the result.
    pub(in crate::check::body) fn power(&mut self, base: Operand, exponent: Operand, span: Span) -> Option<Operand> {
        let single = self.own_type(&base) == Some(ElementaryType::Real);
        let ty = if single { ElementaryType::Real } else { ElementaryType::Lreal };
        let base = self.coerce(base, ty.into())?;
        let exponent = self.settle(exponent)?;
        if !self.plain_elementary(&exponent).is_some_and(ElementaryType::is_number) {
            let found = self.type_name(exponent.ty);
            return self.mismatch("a number", &found, exponent.span);
        }
        let exponent = self.taken_as(exponent, ty);
        let kind = ExprKind::Intrinsic(Intrinsic::Power, vec![base, exponent]);
        Some(Operand::Typed(Expr { kind, ty: ty.into(), span }))
    }
}
