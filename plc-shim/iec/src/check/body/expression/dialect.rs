//! What dialects do their own way. A place in the text determines its file, and the file its dialect.

use crate::check::body::Body;
use crate::check::declare::VIRTUAL_TIME_OFFSET;
use crate::check::standard::vendor::VENDOR_FUNCTIONS;
use crate::check::types::constant::fold;
use crate::check::types::number::{MS, as_number, counter, keeps};
use crate::check::types::operand::{Operand, constant, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, DivisionByZero, Feature, LongTime};
use crate::ir::elementary::Kind;
use crate::ir::{Binary, ElementaryType as E, Expr, ExprKind, Intrinsic, Place, Rounding, Storage, Type, Value};
use crate::syntax::Span;
use crate::syntax::ast::{self, BinaryOp, Call, Ident};

fn joined(operator: Binary, left: Expr, right: Expr) -> Expr {
    let (ty, span) = (left.ty, left.span);
    Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), ty, span }
}

impl Body<'_, '_> {
    /// A TIME as the dialect counts it: whole milliseconds that wrap. Everything else as it is.
    pub(in crate::check::body) fn time_value(&self, expr: Expr) -> Expr {
        let counter = counter(self.declarations.dialect(expr.span).time());
        let Some(counter) = counter.filter(|_| expr.ty == E::Time.into()) else { return expr };
        let unit = |span| constant(Value::Int(MS), E::Lint, span);
        let span = expr.span;
        let ns = converted(expr, E::Lint, Rounding::NearestEven);
        let ms = joined(Binary::Divide, ns, unit(span));
        let wrapped = converted(converted(ms, counter, Rounding::NearestEven), E::Lint, Rounding::NearestEven);
        converted(joined(Binary::Multiply, wrapped, unit(span)), E::Time, Rounding::NearestEven)
    }

    /// Reports a TIME that the dialect cannot count.
    pub(super) fn check_duration(&mut self, ty: E, ns: i64, span: Span) -> Option<()> {
        let dialect = self.declarations.dialect(span);
        let Some(counter) = counter(dialect.time()).filter(|_| ty == E::Time) else { return Some(()) };
        let ns = i128::from(ns);
        if ns % MS == 0 && counter.wrap(ns / MS) == ns / MS {
            return Some(());
        }
        let signs = if counter == E::Dint { "signed" } else { "unsigned" };
        let message = format!("TIME of {dialect} counts milliseconds in {signs} 32 bits");
        self.report(Diagnostic::error(Code::OutOfRange, span, message).with_help("LTIME counts nanoseconds"));
        None
    }

    /// A LTIME that only one without sign has.
    pub(super) fn long_duration(&mut self, ns: u64, span: Span) -> Option<Operand> {
        if self.declarations.dialect(span).long_time() == LongTime::Unsigned64 {
            return Some(Operand::Typed(constant(Value::Int(i128::from(ns.cast_signed())), E::Ltime, span)));
        }
        self.report(Diagnostic::error(Code::InvalidLiteral, span, "duration is too long"));
        None
    }

    /// A LTIME as the number that is compared and scaled, where it has no sign. Everything else as it is.
    pub(in crate::check::body) fn unsigned_duration(&self, expr: Expr) -> Expr {
        let is_unsigned = self.declarations.dialect(expr.span).long_time() == LongTime::Unsigned64;
        if !is_unsigned || expr.ty != E::Ltime.into() {
            return expr;
        }
        if let ExprKind::Constant(Value::Int(ns)) = expr.kind {
            return constant(Value::Int(E::Ulint.wrap(ns)), E::Ulint, expr.span);
        }
        let bits = converted(expr, E::Lint, Rounding::NearestEven);
        converted(bits, E::Ulint, Rounding::NearestEven)
    }

    /// A division, by what the dialect does if the divisor is 0.
    pub(super) fn division(&self, operator: Binary, span: Span) -> Binary {
        match (operator, self.declarations.dialect(span).division_by_zero()) {
            (Binary::Divide, DivisionByZero::Continue) => Binary::DivideAnyway,
            _ => operator,
        }
    }

    /// True if operators for numbers take `ty`, and those for bit strings too.
    pub(in crate::check::body) fn bits_are_numbers(&self, ty: E, span: Span) -> bool {
        let has = self.declarations.dialect(span).has(Feature::BitArithmetic);
        has && (ty.kind() == Kind::Bits || ty.is_integer())
    }

    /// The type of an integer that is shifted as its bits are.
    pub(in crate::check::body) fn shifted_integer(&self, expr: &Expr) -> Option<E> {
        let has = self.declarations.dialect(expr.span).has(Feature::IntegerShifts);
        self.plain_elementary(expr).filter(|ty| has && ty.is_integer())
    }

    /// A value that counts or selects, where bit strings and enumerations are numbers; all else as it is.
    pub(in crate::check::body) fn as_index(&self, expr: Expr) -> Expr {
        let expr = self.as_number(expr);
        if self.held_in_register(&expr).is_some() {
            return self.taken_as(expr, E::Lint);
        }
        match self.plain_elementary(&expr) {
            Some(ty) if as_number(ty) != ty && self.bits_are_numbers(ty, expr.span) => {
                converted(expr, as_number(ty), Rounding::NearestEven)
            }
            _ => expr,
        }
    }

    /// A number that a sign can stand before, where bit strings are numbers and unsigned ones become signed: the
    /// signed type of the next size. All else as it is.
    pub(super) fn as_signed_number(&self, expr: Expr) -> Expr {
        match self.plain_elementary(&expr) {
            Some(ty) if self.bits_are_numbers(ty, expr.span) && !ty.is_signed() => {
                let wider = match ty.size() {
                    1 => E::Int,
                    2 => E::Dint,
                    _ => E::Lint,
                };
                self.taken_as(expr, wider)
            }
            _ => expr,
        }
    }

    /// True if `ty` has bits to invert.
    pub(super) fn has_bits(&self, ty: E, span: Span) -> bool {
        ty.is_bits() || self.bits_are_numbers(ty, span)
    }

    /// True if a value becomes one of `wanted` without a conversion function.
    pub(super) fn widens(&self, found: E, wanted: E, span: Span) -> bool {
        if found.widens_to(wanted) {
            return true;
        }
        let dialect = self.declarations.dialect(span);
        let (from, to) =
            if dialect.has(Feature::BitArithmetic) { (as_number(found), as_number(wanted)) } else { (found, wanted) };
        let sign = dialect.has(Feature::SignChange) && from.is_integer() && to.is_integer();
        let real = dialect.has(Feature::LossyReals) && found.is_number() && wanted.is_real();
        let integer = dialect.has(Feature::IntegersAsReals) && found.is_integer() && found.size() <= wanted.size();
        from.widens_to(to) || sign && from.size() <= to.size() || real || integer && wanted.is_real()
    }

    /// True for the result of an operation on integers none of which is wider than `wanted`: vendors reckon it in more
    /// bits and let it be assigned.
    pub(super) fn comes_of_narrower(&self, expr: &Expr, wanted: E) -> bool {
        let is_integer = |expr: &Expr| self.plain_elementary(expr).is_some_and(|ty| as_number(ty).is_integer());
        let allowed = self.declarations.dialect(expr.span).has(Feature::SignChange);
        let is_operation =
            matches!(expr.kind, ExprKind::Binary(..) | ExprKind::Intrinsic(..) | ExprKind::FromRegister(_));
        allowed && is_operation && is_integer(expr) && as_number(wanted).is_integer() && self.fits(expr, wanted.size())
    }

    /// True if no operand has more than `size` bytes before it is made wider for the operation.
    fn fits(&self, expr: &Expr, size: u32) -> bool {
        match &expr.kind {
            ExprKind::Binary(operator, left, right) if !operator.is_comparison() => {
                self.fits(left, size) && self.fits(right, size)
            }
            ExprKind::Convert(_, inner) | ExprKind::FromRegister(inner) | ExprKind::Limited(_, _, inner) => {
                self.fits(inner, size)
            }
            ExprKind::Intrinsic(Intrinsic::Min | Intrinsic::Max, operands) => {
                operands.iter().all(|each| self.fits(each, size))
            }
            ExprKind::Constant(Value::Int(value)) => {
                let bits = size * 8;
                (-(1_i128 << (bits - 1))..(1_i128 << bits)).contains(value)
            }
            _ => self.declarations.types().elementary(expr.ty).is_some_and(|ty| ty.size() <= size),
        }
    }

    /// Warns of a value that may not be the same one of type `wanted`, which the dialect allows.
    pub(super) fn warn_of_loss(&mut self, expr: &Expr, found: E, wanted: E) {
        let (from, to) = (as_number(found), as_number(wanted));
        // A literal takes the type of what it is reckoned with.
        let is_of_literal = || to == E::Real && self.literal_that_widens(expr).is_some();
        if from.widens_to(to) || found == E::Bool || is_of_literal() {
            return;
        }
        if let Ok(value) = fold(self.declarations.types(), expr)
            && keeps(value, to)
        {
            return;
        }
        let what = if to.is_real() { "lose digits" } else { "change its sign" };
        let message = format!("this {found} may {what} as {wanted}");
        let help = format!("{found}_TO_{wanted} says that it is meant");
        self.report(Diagnostic::warning(Code::LossyConversion, expr.span, message).with_help(help));
    }

    /// The smallest type that both widen to.
    pub(super) fn common(&self, left: E, right: E, span: Span) -> Option<E> {
        let numbers = || {
            let has = self.declarations.dialect(span).has(Feature::BitArithmetic);
            has.then(|| as_number(left).common(as_number(right))).flatten()
        };
        // No type holds all of ULINT and of a signed one; as in C the unsigned one counts.
        let unsigned = || {
            let has = self.declarations.dialect(span).has(Feature::SignChange);
            let both = as_number(left).is_integer() && as_number(right).is_integer();
            (has && both && (as_number(left) == E::Ulint || as_number(right) == E::Ulint)).then_some(E::Ulint)
        };
        // As where one is assigned to the other: digits may be lost.
        let real = || {
            let has = self.declarations.dialect(span).has(Feature::LossyReals);
            let (one, other) = if left.is_real() { (left, right) } else { (right, left) };
            (has && one.is_real() && other.is_integer()).then_some(one)
        };
        // Where a DINT becomes a REAL by itself, it does so beside one.
        let narrow = {
            let (one, other) = if left.is_real() { (left, right) } else { (right, left) };
            let dialect = self.declarations.dialect(span);
            let has = dialect.has(Feature::IntegersAsReals) && !dialect.has(Feature::LossyReals);
            (has && one == E::Real && other.is_integer() && other.size() <= one.size()).then_some(one)
        };
        narrow.or_else(|| left.common(right)).or_else(numbers).or_else(unsigned).or_else(real)
    }

    /// `AND_THEN`, `OR_ELSE`: the right operand is evaluated only if the left one does not decide.
    pub(super) fn short_circuit(
        &mut self,
        operator: BinaryOp,
        left: &ast::Expr,
        right: &ast::Expr,
        span: Span,
    ) -> Option<Operand> {
        let left = self.condition(left);
        self.short_circuited(operator, left, right, span)
    }

    /// The same, of a left side that has been checked.
    pub(super) fn short_circuited(
        &mut self,
        operator: BinaryOp,
        left: Option<Expr>,
        right: &ast::Expr,
        span: Span,
    ) -> Option<Operand> {
        let right = self.condition(right);
        let (left, right) = (left?, right?);
        let known = constant(Value::Bool(operator == BinaryOp::OrElse), E::Bool, span);
        let parts = if operator == BinaryOp::AndThen { [left, right, known] } else { [left, known, right] };
        Some(Operand::Typed(Expr { kind: ExprKind::Conditional(Box::new(parts)), ty: E::Bool.into(), span }))
    }

    /// True for `TIME` and `LTIME`, called as functions.
    pub(in crate::check::body) fn is_clock(name: &Ident) -> bool {
        matches!(name.key().as_str(), "TIME" | "LTIME")
    }

    /// `TIME()` and `LTIME()`: virtual time since the start.
    pub(in crate::check::body) fn clock_function(&mut self, name: &Ident, call: &Call, span: Span) -> Option<Operand> {
        let dialect = self.declarations.dialect(span);
        if !dialect.has(Feature::ClockFunctions) {
            let message = format!("{} is not part of {dialect}", Feature::ClockFunctions.about());
            let found = Diagnostic::error(Code::WrongDialect, span, message);
            self.report(found.with_help(Feature::ClockFunctions.help()));
            return None;
        }
        if let Some(argument) = call.arguments.first() {
            let message = format!("{}() takes no arguments", name.key());
            let span = match argument {
                ast::Argument::Positional(expr) | ast::Argument::Input(_, expr) => expr.span,
                ast::Argument::Output { name, .. } => name.span,
            };
            self.report(Diagnostic::error(Code::TooManyArguments, span, message));
            return None;
        }
        let place = Place::whole(Storage::Absolute(VIRTUAL_TIME_OFFSET), E::Time.into(), span);
        let now = Expr { kind: ExprKind::Load(place), ty: E::Time.into(), span };
        let long = name.key() == "LTIME";
        let now = if long { converted(now, E::Ltime, Rounding::NearestEven) } else { self.time_value(now) };
        Some(Operand::Typed(now))
    }

    /// Reports a function of a vendor's controllers; true if it is one.
    pub(in crate::check::body) fn report_vendor_function(&mut self, name: &Ident) -> bool {
        let key = name.key();
        let known = VENDOR_FUNCTIONS.iter().find(|(begin, ..)| key.starts_with(begin));
        let Some((_, code, help)) = known else { return false };
        let message = format!("`{}` is a function of a vendor's controllers", name.text);
        self.report(Diagnostic::error(*code, name.span, message).with_help(*help));
        true
    }

    /// What `x.TON(..)` calls in SCL: the instance `x` of TON, `TON_TIME` and the like.
    pub(in crate::check::body) fn instance_of<'e>(&mut self, callee: &'e ast::Expr) -> &'e ast::Expr {
        let ast::ExprKind::Member(base, name) = &callee.kind else { return callee };
        if self.declarations.dialect(callee.span) != Dialect::SiemensScl {
            return callee;
        }
        let before = self.declarations.mark();
        let place = self.place(base);
        // Were the base wrong, the callee as a whole would be reported.
        self.declarations.forget_since(before);
        let ty = place.map(|located| self.declarations.types().get(located.place.ty).clone());
        match ty {
            Some(Type::FunctionBlock { name: block, .. }) => {
                let block = block.to_ascii_uppercase();
                let plain = block.split('_').next().unwrap_or(&block);
                if plain == name.key() { base } else { callee }
            }
            _ => callee,
        }
    }
}
