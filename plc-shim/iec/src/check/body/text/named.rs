//! The names of an enumeration's values as text, behind `{attribute 'to_string'}` (CODESYS, TwinCAT).

use crate::check::body::Body;
use crate::check::types::operand::{Operand, constant};
use crate::ir::text::TextShape;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Type, TypeId, Value};
use crate::syntax::Span;
use crate::syntax::text_literal::Text;

impl Body<'_, '_> {
    /// The values of an enumeration whose names are its text, in ascending order; of two names of a value the first.
    pub(super) fn values_shown_by_name(&self, ty: TypeId) -> Option<Vec<(i128, String)>> {
        let Type::Enumeration { values, shows_names: true, .. } = self.declarations.types().get(ty) else {
            return None;
        };
        let mut values: Vec<_> = values.iter().map(|(name, value)| (*value, name.clone())).collect();
        values.sort_by_key(|(value, _)| *value);
        values.dedup_by_key(|(value, _)| *value);
        Some(values)
    }

    /// The name of a value, or its number if it has no name.
    pub(super) fn name_as_text(
        &mut self,
        expr: Expr,
        values: &[(i128, String)],
        shape: TextShape,
        span: Span,
    ) -> Option<Operand> {
        let longest = values.iter().map(|(_, name)| name.chars().count() as u32).max().unwrap_or(0);
        let shape = TextShape { capacity: shape.capacity.max(longest), ..shape };
        let base = self.elementary(expr.ty)?;
        let number = Expr { ty: base.into(), ..expr };
        let (before, number) = match number.kind {
            ExprKind::Constant(_) => (Vec::new(), number),
            _ => self.once(number),
        };
        let names = values.iter().map(|(value, name)| {
            let text = Text { wide: shape.wide, units: name.encode_utf16().collect() };
            Some((*value, self.stored_text(shape, &text, span)?))
        });
        let names = names.collect::<Option<Vec<_>>>()?;
        let other = self.formatted_number(number.clone(), base, shape, span)?;
        let chosen = match &number.kind {
            ExprKind::Constant(value) => {
                let named = names.into_iter().find(|(known, _)| value.as_int() == Some(*known));
                named.map_or(other, |(_, name)| name)
            }
            _ => search(&names, &number, base, &other),
        };
        let ty = chosen.ty;
        Some(Operand::Typed(Expr { kind: ExprKind::After(before, Some(Box::new(chosen))), ty, span }))
    }
}

/// Halves the values until one is left, so that the tree is low however many there are.
fn search(names: &[(i128, Expr)], number: &Expr, base: ElementaryType, other: &Expr) -> Expr {
    let compared = |operator, value: i128| {
        let right = constant(Value::Int(value), base, number.span);
        let kind = ExprKind::Binary(operator, Box::new(number.clone()), Box::new(right));
        Expr { kind, ty: ElementaryType::Bool.into(), span: number.span }
    };
    let (condition, then, otherwise) = match names {
        [] => return other.clone(),
        [(value, name)] => (compared(Binary::Equal, *value), name.clone(), other.clone()),
        more => {
            let (left, right) = more.split_at(more.len() / 2);
            let Some((middle, _)) = right.first() else { return other.clone() };
            let [left, right] = [left, right].map(|half| search(half, number, base, other));
            (compared(Binary::Less, *middle), left, right)
        }
    };
    let (ty, span) = (other.ty, other.span);
    Expr { kind: ExprKind::Conditional(Box::new([condition, then, otherwise])), ty, span }
}
