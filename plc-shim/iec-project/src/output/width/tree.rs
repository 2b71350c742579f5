//! What is computed in registers: operations, and what they are done with.

use onescan_iec::check::as_number;
use onescan_iec::ir::{Binary, ElementaryType as E, Expr, ExprKind, Intrinsic, TypeTable, Unary};
use onescan_iec::syntax::Span;

/// An operation on integers, or what goes into one.
pub(super) enum Node<'e> {
    Literal {
        value: i128,
        span: Span,
    },
    Leaf {
        expr: &'e Expr,
        /// Its own type, then those that it is implicitly converted to, without that of the register.
        types: Vec<E>,
    },
    Operation {
        kind: Operation,
        operands: Vec<Node<'e>>,
        /// What chooses among them.
        selector: Option<&'e Expr>,
        span: Span,
    },
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Operation {
    Add,
    Subtract,
    Multiply,
    Negate,
    Divide,
    Modulo,
    Absolute,
    /// MIN, MAX, SEL, MUX and what is made of them.
    Choose,
}

impl Operation {
    /// True if low-order bits of the result depend on no others of the operands.
    pub(super) fn is_exact_below(self) -> bool {
        matches!(self, Self::Add | Self::Subtract | Self::Multiply | Self::Negate)
    }
}

/// An expression whose value is held in a register as one of `register`.
pub(super) fn node<'e>(types: &TypeTable, expr: &'e Expr, register: E) -> Node<'e> {
    let span = expr.span;
    let each = |operands: &'e [Expr]| operands.iter().map(|operand| node(types, operand, register)).collect();
    let operation = |kind, operands, selector| Node::Operation { kind, operands, selector, span };
    match &expr.kind {
        ExprKind::Constant(value) if value.as_int().is_some() => {
            Node::Literal { value: value.as_int().unwrap_or(0), span }
        }
        ExprKind::Unary(Unary::Negate, operand) => {
            operation(Operation::Negate, vec![node(types, operand, register)], None)
        }
        ExprKind::Binary(operator, left, right) => match of_binary(*operator) {
            // What a conversion function is made of stands nowhere in the text.
            Some(kind) if left.span != span && right.span != span => {
                operation(kind, vec![node(types, left, register), node(types, right, register)], None)
            }
            _ => leaf(types, expr, register),
        },
        ExprKind::Intrinsic(Intrinsic::Abs, operands) => operation(Operation::Absolute, each(operands), None),
        ExprKind::Intrinsic(Intrinsic::Min | Intrinsic::Max, operands) => {
            operation(Operation::Choose, each(operands), None)
        }
        ExprKind::Intrinsic(Intrinsic::Multiplex, operands) => match operands.split_first() {
            Some((selector, values)) => operation(Operation::Choose, each(values), Some(selector)),
            None => leaf(types, expr, register),
        },
        ExprKind::Conditional(parts) => operation(Operation::Choose, each(&parts[1..]), Some(&parts[0])),
        _ => leaf(types, expr, register),
    }
}

fn of_binary(operator: Binary) -> Option<Operation> {
    Some(match operator {
        Binary::Add => Operation::Add,
        Binary::Subtract => Operation::Subtract,
        Binary::Multiply => Operation::Multiply,
        Binary::Divide | Binary::DivideAnyway => Operation::Divide,
        Binary::Modulo => Operation::Modulo,
        _ => return None,
    })
}

fn leaf<'e>(types: &TypeTable, expr: &'e Expr, register: E) -> Node<'e> {
    let mut chain = vec![types.elementary(expr.ty).unwrap_or(register)];
    let mut inner = expr;
    // A conversion that stands where its operand does is an implicit one.
    while let ExprKind::Convert(_, operand) = &inner.kind
        && operand.span == inner.span
        && let Some(ty) = types.elementary(operand.ty).filter(|ty| is_whole(*ty))
    {
        chain.push(ty);
        inner = operand;
    }
    chain.reverse();
    if chain.len() > 1 {
        chain.pop();
    }
    Node::Leaf { expr: inner, types: chain }
}

/// True for integers and bit strings.
pub(super) fn is_whole(ty: E) -> bool {
    ty.is_integer() || ty.is_bits() && ty != E::Bool
}

impl Node<'_> {
    pub(super) fn span(&self) -> Span {
        match self {
            Self::Literal { span, .. } | Self::Operation { span, .. } => *span,
            Self::Leaf { expr, .. } => expr.span,
        }
    }

    /// The type that the text gives it; nothing for a literal, which takes that of its neighbours.
    pub(super) fn own(&self) -> Option<E> {
        match self {
            Self::Literal { .. } => None,
            Self::Leaf { types, .. } => types.last().copied().map(as_number),
            Self::Operation { operands, .. } => {
                let of_operands = operands.iter().filter_map(Node::own).reduce(joined)?;
                let literals = operands.iter().filter_map(|operand| match operand {
                    Self::Literal { value, .. } => Some(*value),
                    _ => None,
                });
                let settled = literals
                    .filter(|value| !has(of_operands, *value))
                    .filter_map(|value| [E::Dint, E::Lint, E::Ulint].into_iter().find(|ty| has(*ty, value)));
                Some(settled.fold(of_operands, joined))
            }
        }
    }

    /// True if a register holds more of an operation within it than the type that its text gives it.
    pub(super) fn is_wider_in(&self, register: E) -> bool {
        let Self::Operation { operands, .. } = self else { return false };
        self.own().is_some_and(|own| own.size() < register.size())
            || operands.iter().any(|operand| operand.is_wider_in(register))
    }

    /// True if all of it are operations on low-order bits.
    pub(super) fn is_exact_below(&self) -> bool {
        match self {
            Self::Operation { kind, operands, .. } => {
                kind.is_exact_below() && operands.iter().all(Node::is_exact_below)
            }
            _ => true,
        }
    }

    /// The least and greatest value that it can have before anything is cut.
    pub(super) fn range(&self) -> (i128, i128) {
        match self {
            Self::Literal { value, .. } => (*value, *value),
            Self::Leaf { types, .. } => types.last().and_then(|ty| as_number(*ty).range()).unwrap_or(ANY),
            Self::Operation { kind, operands, .. } => {
                let ranges: Vec<_> = operands.iter().map(Node::range).collect();
                of_operation(*kind, &ranges)
            }
        }
    }

    /// True if one of `ty` holds every value on the way.
    pub(super) fn fits(&self, ty: E) -> bool {
        let (least, greatest) = self.range();
        let is_inside = has(ty, least) && has(ty, greatest);
        match self {
            Self::Operation { operands, .. } => is_inside && operands.iter().all(|operand| operand.fits(ty)),
            _ => is_inside,
        }
    }
}

fn joined(left: E, right: E) -> E {
    left.common(right).unwrap_or(if left.size() < right.size() { right } else { left })
}

pub(super) fn has(ty: E, value: i128) -> bool {
    ty.range().is_some_and(|(least, greatest)| (least..=greatest).contains(&value))
}

/// More than any register holds.
const ANY: (i128, i128) = (-(1 << 63), (1 << 64) - 1);

fn of_operation(kind: Operation, ranges: &[(i128, i128)]) -> (i128, i128) {
    let hull = |values: &[i128]| {
        let (least, greatest) = (values.iter().min(), values.iter().max());
        least.zip(greatest).map_or(ANY, |(least, greatest)| (*least, *greatest))
    };
    match (kind, ranges) {
        (Operation::Add, [left, right]) => (left.0.saturating_add(right.0), left.1.saturating_add(right.1)),
        (Operation::Subtract, [left, right]) => (left.0.saturating_sub(right.1), left.1.saturating_sub(right.0)),
        (Operation::Multiply, [left, right]) => hull(&[
            left.0.saturating_mul(right.0),
            left.0.saturating_mul(right.1),
            left.1.saturating_mul(right.0),
            left.1.saturating_mul(right.1),
        ]),
        (Operation::Negate, [only]) => (only.1.saturating_neg(), only.0.saturating_neg()),
        (Operation::Absolute, [only]) => (0, only.0.saturating_abs().max(only.1.saturating_abs())),
        (Operation::Divide, [left, right]) => {
            let most = left.0.saturating_abs().max(left.1.saturating_abs());
            // Only a division by -1 gives the opposite of the least value.
            if right.0 > 0 { (left.0.min(0), left.1.max(0)) } else { (most.saturating_neg(), most) }
        }
        (Operation::Modulo, [left, _]) => (left.0.min(0), left.1.max(0)),
        (Operation::Choose, all) => hull(&all.iter().flat_map(|range| [range.0, range.1]).collect::<Vec<_>>()),
        _ => ANY,
    }
}
