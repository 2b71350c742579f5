//! What CODESYS and TwinCAT convert by themselves: bit strings that are numbers, numbers that are bit strings, and values
//! that may lose something. Where the target's dialect wants a function for it, the text gets one.

use std::collections::BTreeSet;

use super::tree::{Node, is_whole, node};
use super::{Change, Writer, Written, conversions, fitting, given, is_plain, signed, wrapped};
use crate::output::Refused;
use onescan_iec::check::as_number;
use onescan_iec::diagnostic::Code;
use onescan_iec::dialect::{Dialect, Feature};
use onescan_iec::front::Front;
use onescan_iec::ir::walk::{self, Visitor};
use onescan_iec::ir::{Binary, ElementaryType as E, Expr, ExprKind, Intrinsic, Unary};
use onescan_iec::syntax::Span;

fn is_bitwise(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Binary(Binary::And | Binary::Or | Binary::Xor, ..) | ExprKind::Unary(Unary::Not, _))
}

/// True for what no text says: one of its operands stands where it does.
fn is_made_up(expr: &Expr) -> bool {
    let is_here = |operand: &Expr| operand.span == expr.span;
    match &expr.kind {
        ExprKind::Convert(_, operand) | ExprKind::FromRegister(operand) | ExprKind::Unary(_, operand) => {
            is_here(operand)
        }
        ExprKind::Binary(_, left, right) => is_here(left) || is_here(right),
        ExprKind::Intrinsic(_, operands) => operands.iter().any(is_here),
        ExprKind::Conditional(parts) => parts.iter().any(is_here),
        _ => false,
    }
}

/// Shows the writer what the text has in an expression that a function of it is made of, such as one of durations.
fn beneath(expr: &Expr, writer: &mut Writer<'_>) {
    struct Beneath<'b, 'w>(Span, &'b mut Writer<'w>);
    impl Visitor for Beneath<'_, '_> {
        fn goes_into_expressions(&self) -> bool {
            false
        }

        fn index(&mut self, index: &Expr) {
            self.1.index(index);
        }

        fn expression(&mut self, expr: &Expr) {
            let held = match &expr.kind {
                ExprKind::FromRegister(inner) | ExprKind::Convert(_, inner) => self.1.wider(given(inner)).is_some(),
                _ => false,
            };
            if expr.span == self.0 && !held && is_made_up(expr) {
                walk::children(expr, self);
            } else {
                self.1.expression(expr);
            }
        }
    }
    walk::children(expr, &mut Beneath(expr.span, writer));
}

/// Where `theirs` has a value of a type that is not wanted there.
pub(super) fn unread(theirs: &Front) -> BTreeSet<Span> {
    let places = theirs.findings.iter().filter(|found| matches!(found.code, Code::TypeMismatch | Code::OutOfRange));
    places.map(|found| found.span).collect()
}

/// True if the target's dialect converts by itself.
fn is_silent(reader: Dialect, from: E, to: E) -> bool {
    let as_real = reader.has(Feature::IntegersAsReals) && from.is_integer() && to.is_real();
    from.widens_to(to) || as_real && from.size() <= to.size()
}

/// An expression without what is converted where it stands, with the types that it goes through, its own first.
fn chain<'e>(writer: &Writer<'_>, expr: &'e Expr) -> (&'e Expr, Vec<E>) {
    let (mut inner, mut types) = (expr, Vec::new());
    types.extend(writer.types.elementary(expr.ty));
    while let ExprKind::Convert(_, operand) = &inner.kind
        && operand.span == inner.span
        && let Some(ty) = writer.types.elementary(operand.ty)
    {
        types.push(ty);
        inner = operand;
    }
    types.reverse();
    (inner, types)
}

impl Writer<'_> {
    /// An expression that no register makes wider.
    pub(super) fn said(&mut self, expr: &Expr) -> Written<()> {
        match &expr.kind {
            ExprKind::Constant(_) => self.constant(expr),
            ExprKind::Convert(_, operand) if operand.span == expr.span => self.silent(expr),
            ExprKind::Binary(..) if is_made_up(expr) => {
                beneath(expr, self);
                Ok(())
            }
            ExprKind::FromRegister(inner) if is_bitwise(inner) => {
                self.types.elementary(expr.ty).map_or(Ok(()), |target| self.bitwise_as(inner, target))
            }
            _ if is_bitwise(expr) && self.types.elementary(expr.ty).is_some_and(E::is_integer) => {
                self.types.elementary(expr.ty).map_or(Ok(()), |own| self.bitwise_as(expr, own))
            }
            ExprKind::Intrinsic(
                kind @ (Intrinsic::ShiftLeft | Intrinsic::ShiftRight | Intrinsic::RotateLeft | Intrinsic::RotateRight),
                operands,
            ) => self.shifted(expr, *kind, operands),
            _ if self.is_number_of_bits(expr) => {
                self.types.elementary(expr.ty).map_or(Ok(()), |own| self.computed_bits(expr, own))
            }
            _ => {
                walk::children(expr, self);
                Ok(())
            }
        }
    }

    fn unsigned_register(&self, span: Span) -> Option<E> {
        Some(self.sources.get(span.file)?.word_size().register(false))
    }

    /// True for a bit string that is computed.
    fn is_number_of_bits(&self, expr: &Expr) -> bool {
        let is_bits = self.types.elementary(expr.ty).is_some_and(|ty| ty.is_bits() && is_whole(ty));
        let computes = self.unsigned_register(expr.span);
        is_bits && computes.is_some_and(|register| matches!(node(self.types, expr, register), Node::Operation { .. }))
    }

    /// A constant that is written as a number which the target does not take for its type.
    fn constant(&mut self, expr: &Expr) -> Written<()> {
        let ExprKind::Constant(value) = &expr.kind else { return Ok(()) };
        let ty = self.types.elementary(expr.ty).filter(|ty| is_whole(*ty));
        let (Some(_), Some(value)) = (ty, value.as_int()) else { return Ok(()) };
        if !self.unread.contains(&expr.span) {
            return Ok(());
        }
        let Span { start, end, .. } = expr.span;
        self.note(expr.span, vec![Change { at: (start, end), text: value.to_string() }])
    }

    /// A value that its dialect converts where it stands.
    fn silent(&mut self, expr: &Expr) -> Written<()> {
        let (inner, types) = chain(self, expr);
        let Some((target, before)) = types.split_last() else { return Ok(()) };
        let is_alike = types.windows(2).all(|pair| is_silent(self.reader, pair[0], pair[1]));
        if !types.iter().all(|ty| is_said(*ty)) {
            beneath(expr, self);
            return Ok(());
        }
        if is_alike {
            self.expression(inner);
            return Ok(());
        }
        if is_bitwise(inner) && before.iter().all(|ty| ty.is_integer()) {
            return self.bitwise_as(inner, *target);
        }
        if self.is_number_of_bits(inner) {
            return self.computed_bits(inner, *target);
        }
        let (head, count) = conversions(before, *target);
        self.note(expr.span, wrapped(inner.span, &head, count))?;
        walk::children(inner, self);
        Ok(())
    }

    /// Numbers that are computed and become bit strings.
    fn computed_bits(&mut self, expr: &Expr, target: E) -> Written<()> {
        let Some(register) = self.unsigned_register(expr.span) else { return Ok(()) };
        let node = node(self.types, expr, register);
        self.converted(expr, (&node, register), target)?;
        self.leaves(&node);
        Ok(())
    }

    /// `AND` and the like, each of whose operands becomes a bit string, and the result one of `target`.
    fn bitwise_as(&mut self, expr: &Expr, target: E) -> Written<()> {
        let Some(ty) = self.types.elementary(expr.ty) else { return Ok(()) };
        let bits = as_bits(ty);
        let (head, count) = conversions(&[bits], target);
        let mut changes = wrapped(expr.span, &head, count);
        self.bitwise(expr, bits, &mut changes)?;
        self.note(expr.span, changes)
    }

    fn bitwise(&mut self, expr: &Expr, bits: E, changes: &mut Vec<Change>) -> Written<()> {
        match &expr.kind {
            ExprKind::Binary(Binary::And | Binary::Or | Binary::Xor, left, right) => {
                self.bitwise(left, bits, changes)?;
                self.bitwise(right, bits, changes)
            }
            ExprKind::Unary(Unary::Not, operand) => self.bitwise(operand, bits, changes),
            ExprKind::Constant(value) if value.as_int().is_some() => {
                let value = value.as_int().unwrap_or(0);
                if value < 0 || !is_plain(self.sources.text(expr.span)) {
                    let text = as_number(bits).wrap(value).to_string();
                    changes.push(Change { at: (expr.span.start, expr.span.end), text });
                }
                Ok(())
            }
            _ => self.bits(expr, bits, changes),
        }
    }

    /// A value that is not an operation on bits, as a bit string.
    fn bits(&mut self, expr: &Expr, bits: E, changes: &mut Vec<Change>) -> Written<()> {
        if let Some((node, register)) = self.wider(expr) {
            let (head, count) = conversions(&[register], bits);
            changes.extend(wrapped(node.span(), &head, count));
            self.operands(&node, register, changes);
            self.leaves(&node);
            return Ok(());
        }
        let (inner, types) = chain(self, expr);
        let (head, count) = conversions(&types, bits);
        changes.extend(wrapped(inner.span, &head, count));
        if let (ExprKind::FromRegister(held), Some(own)) = (&inner.kind, types.first())
            && let Some((node, register)) = self.wider(given(held))
        {
            self.converted(inner, (&node, register), *own)?;
            self.leaves(&node);
            return Ok(());
        }
        walk::children(inner, self);
        Ok(())
    }

    fn shifted(&mut self, expr: &Expr, kind: Intrinsic, operands: &[Expr]) -> Written<()> {
        let [value, count] = operands else { return Ok(()) };
        let ty = self.types.elementary(value.ty);
        if kind == Intrinsic::ShiftRight && ty.is_some_and(E::is_signed) && !self.reader.has(Feature::IntegerShifts) {
            let message = "SHR of an integer with a sign, which moves in from the left,".to_owned();
            return Err(Refused { span: expr.span, message });
        }
        match (&value.kind, ty) {
            (ExprKind::Constant(number), Some(ty)) if is_plain(self.sources.text(value.span)) => {
                let text = format!("{ty}#{}", number.as_int().unwrap_or(0));
                self.note(value.span, vec![Change { at: (value.span.start, value.span.end), text }])?;
            }
            _ => self.expression(value),
        }
        self.counted(count)
    }

    /// A number whose type does not matter, if it is one of integers.
    fn counted(&mut self, expr: &Expr) -> Written<()> {
        let (inner, types) = chain(self, expr);
        match types.first() {
            Some(own) if as_number(*own) != *own => {
                self.note(expr.span, wrapped(inner.span, &format!("{own}_TO_{}(", as_number(*own)), 1))?;
                walk::children(inner, self);
            }
            _ => self.expression(inner),
        }
        Ok(())
    }

    /// An index, which is at most a DINT in SCL: what that does not hold is in no array either.
    pub(super) fn indexed(&mut self, index: &Expr) -> Written<()> {
        let (inner, types) = chain(self, index);
        let of_register = self.types.elementary(inner.ty).filter(|_| self.wider(inner).is_some());
        let own = of_register.or(types.first().copied());
        if let Some((node, register)) = self.wider(inner) {
            let computed = fitting(&node, register);
            let mut changes = as_index(self.reader, node.span(), computed);
            self.operands(&node, computed, &mut changes);
            self.note(index.span, changes)?;
            self.leaves(&node);
            return Ok(());
        }
        match own {
            Some(own) if own.size() == 8 || own == E::Udint => {
                let changes = as_index(self.reader, inner.span, as_number(own));
                if changes.is_empty() {
                    self.expression(index);
                    return Ok(());
                }
                self.note(index.span, changes)?;
                walk::children(inner, self);
                Ok(())
            }
            _ => self.counted(index),
        }
    }
}

/// What makes an index of a number of type `ty` at `span`.
fn as_index(reader: Dialect, span: Span, ty: E) -> Vec<Change> {
    let least = if ty.is_signed() { E::Dint.range().map_or(0, |(least, _)| least) } else { 0 };
    let greatest = E::Dint.range().map_or(0, |(_, greatest)| greatest);
    if reader != Dialect::SiemensScl || E::Dint.range().zip(ty.range()).is_some_and(|(dint, own)| own.1 <= dint.1) {
        return Vec::new();
    }
    let change = |at, text: String| Change { at: (at, at), text };
    let head = format!("{ty}_TO_DINT(LIMIT({least}, ");
    vec![change(span.start, head), change(span.end, format!(", {greatest}))"))]
}

/// True for types that conversion functions have in every target.
fn is_said(ty: E) -> bool {
    is_whole(ty) || ty.is_real() || ty == E::Bool
}

/// The bit string of an integer's size.
fn as_bits(ty: E) -> E {
    match signed(ty) {
        E::Sint => E::Byte,
        E::Int => E::Word,
        E::Dint => E::Dword,
        _ => E::Lword,
    }
}
