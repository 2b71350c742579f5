//! The standard functions, their parameters and their typed forms (2nd ed. 2.5.1.4, 2.5.1.5; 3rd ed. 6.6.1.7,
//! 6.6.2.5).

use super::text::{self, TextForm};
use super::timed::{self, TimedFunction};
use crate::ir::text::Edit;
use crate::ir::{Binary, ElementaryType, Intrinsic};
use crate::syntax::ast::BinaryOp;

/// What a standard function does with its arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum Form {
    Absolute,
    Real(Intrinsic),
    Power,
    /// Of two real numbers.
    RealPair(Intrinsic),
    /// Neither infinite nor no number.
    IsValid,
    SwapBytes,
    Move,
    Not,
    /// Joins two or more from the left.
    Operator(BinaryOp),
    Pair(BinaryOp),
    /// Holds between each two neighbours.
    Comparison(Binary),
    Extreme(Intrinsic),
    Limit,
    Select,
    Multiplex,
    Shift(Intrinsic),
    Text(TextForm),
    Timed(TimedFunction),
}

const FUNCTIONS: &[(&str, Form)] = &[
    ("ABS", Form::Absolute),
    ("SQRT", Form::Real(Intrinsic::Sqrt)),
    ("LN", Form::Real(Intrinsic::Ln)),
    ("LOG", Form::Real(Intrinsic::Log)),
    ("EXP", Form::Real(Intrinsic::Exp)),
    ("SIN", Form::Real(Intrinsic::Sin)),
    ("COS", Form::Real(Intrinsic::Cos)),
    ("TAN", Form::Real(Intrinsic::Tan)),
    ("ASIN", Form::Real(Intrinsic::Asin)),
    ("ACOS", Form::Real(Intrinsic::Acos)),
    ("ATAN", Form::Real(Intrinsic::Atan)),
    ("EXPT", Form::Power),
    ("MOVE", Form::Move),
    ("NOT", Form::Not),
    ("ADD", Form::Operator(BinaryOp::Add)),
    ("MUL", Form::Operator(BinaryOp::Multiply)),
    ("SUB", Form::Pair(BinaryOp::Subtract)),
    ("DIV", Form::Pair(BinaryOp::Divide)),
    ("MOD", Form::Pair(BinaryOp::Modulo)),
    ("AND", Form::Operator(BinaryOp::And)),
    ("OR", Form::Operator(BinaryOp::Or)),
    ("XOR", Form::Operator(BinaryOp::Xor)),
    ("GT", Form::Comparison(Binary::Greater)),
    ("GE", Form::Comparison(Binary::GreaterEqual)),
    ("EQ", Form::Comparison(Binary::Equal)),
    ("LE", Form::Comparison(Binary::LessEqual)),
    ("LT", Form::Comparison(Binary::Less)),
    ("NE", Form::Pair(BinaryOp::NotEqual)),
    ("MAX", Form::Extreme(Intrinsic::Max)),
    ("MIN", Form::Extreme(Intrinsic::Min)),
    ("LIMIT", Form::Limit),
    ("SEL", Form::Select),
    ("MUX", Form::Multiplex),
    ("SHL", Form::Shift(Intrinsic::ShiftLeft)),
    ("SHR", Form::Shift(Intrinsic::ShiftRight)),
    ("ROL", Form::Shift(Intrinsic::RotateLeft)),
    ("ROR", Form::Shift(Intrinsic::RotateRight)),
];

/// Younger than many programs, or of vendors: a user's own of the same name go before.
const LATER: &[(&str, Form)] = &[
    ("ATAN2", Form::RealPair(Intrinsic::Atan2)),
    ("FRAC", Form::Real(Intrinsic::Fraction)),
    ("IS_VALID", Form::IsValid),
    // TIA Portal: SWAP.
    ("SWAP", Form::SwapBytes),
    // Memory is little-endian (3rd ed. Table 37).
    ("TO_BIG_ENDIAN", Form::SwapBytes),
    ("BIG_ENDIAN_TO", Form::SwapBytes),
    ("TO_LITTLE_ENDIAN", Form::Move),
    ("LITTLE_ENDIAN_TO", Form::Move),
];

fn listed(list: &[(&str, Form)], key: &str) -> Option<Form> {
    list.iter().find(|(name, _)| *name == key).map(|(_, form)| *form)
}

/// A function that every program has under its name.
fn find_reserved(key: &str) -> Option<Form> {
    let text = || text::FUNCTIONS.iter().find(|(name, _)| *name == key).map(|(_, form)| Form::Text(*form));
    let timed = || timed::FUNCTIONS.iter().find(|function| function.name == key).map(|found| Form::Timed(*found));
    listed(FUNCTIONS, key).or_else(text).or_else(timed)
}

/// The function of this name in capitals, and the type that a typed one names, as in `ADD_INT`
/// (2nd ed. 2.5.1.4).
pub(in crate::check) fn find(key: &str) -> Option<(Form, Option<ElementaryType>)> {
    let whole = find_reserved(key).or_else(|| listed(LATER, key));
    whole.map(|form| (form, None)).or_else(|| find_typed(key))
}

fn find_typed(key: &str) -> Option<(Form, Option<ElementaryType>)> {
    // A type's name may have underscores too.
    key.match_indices('_').find_map(|(at, _)| {
        let (base, ty) = (key.get(..at)?, ElementaryType::find(key.get(at + 1..)?)?);
        let form = listed(FUNCTIONS, base).or_else(|| listed(LATER, base))?;
        form.has_type(ty).then_some((form, Some(ty)))
    })
}

/// True if no unit or type may have the name.
pub(in crate::check) fn is_reserved(key: &str) -> bool {
    find_reserved(key).is_some()
}

/// Names of all but the conversions.
pub(in crate::check) fn names() -> impl Iterator<Item = &'static str> {
    let listed = FUNCTIONS.iter().chain(LATER).map(|(name, _)| *name);
    listed.chain(text::FUNCTIONS.iter().map(|(name, _)| *name))
}

impl Form {
    /// Fewest and most arguments.
    pub(in crate::check) fn arity(self) -> (usize, usize) {
        match self {
            Self::Absolute | Self::Real(_) | Self::Move | Self::Not | Self::IsValid | Self::SwapBytes => (1, 1),
            Self::Timed(_) | Self::Power | Self::RealPair(_) | Self::Pair(_) | Self::Shift(_) => (2, 2),
            Self::Limit | Self::Select => (3, 3),
            Self::Text(form) if form != TextForm::Edit(Edit::Concat) => {
                (form.parameters().len(), form.parameters().len())
            }
            Self::Text(_) | Self::Operator(_) | Self::Comparison(_) | Self::Extreme(_) | Self::Multiplex => {
                (2, usize::MAX)
            }
        }
    }

    /// Position of a formal parameter.
    pub(in crate::check) fn position(self, name: &str) -> Option<usize> {
        let numbered = || name.strip_prefix("IN")?.parse::<usize>().ok();
        match (self, name) {
            (Self::Text(form), _) if form != TextForm::Edit(Edit::Concat) => {
                form.parameters().iter().position(|known| *known == name || *known == text::of_vendors(name))
            }
            (Self::Text(_), "STR1" | "STR2") => self.position(text::of_vendors(name)),
            (Self::Limit, "MN") | (Self::RealPair(_), "Y") | (Self::Select, "G") | (Self::Multiplex, "K") => Some(0),
            (Self::Shift(_), "N") | (Self::Limit, "IN") | (Self::RealPair(_), "X") => Some(1),
            (Self::Limit, "MX") => Some(2),
            (_, "IN") if self.arity() == (1, 1) || matches!(self, Self::Shift(_)) => Some(0),
            (Self::Select | Self::Multiplex, _) => numbered()?.checked_add(1),
            (Self::Limit | Self::Shift(_) | Self::RealPair(_), _) => None,
            _ if self.arity() == (1, 1) => None,
            // SIMATIC AX: System.Strings.Concat.
            (Self::Text(_), _) if name.starts_with("STRING") => {
                name.strip_prefix("STRING")?.parse::<usize>().ok()?.checked_sub(1)
            }
            _ => numbered()?.checked_sub(1),
        }
    }

    /// True if there is a form for values of `ty` alone.
    fn has_type(self, ty: ElementaryType) -> bool {
        match self {
            Self::Move | Self::Select | Self::Multiplex | Self::Comparison(_) | Self::Extreme(_) | Self::Limit => true,
            Self::Absolute => ty.is_number(),
            Self::Real(_) | Self::RealPair(_) | Self::Power | Self::IsValid => ty.is_real(),
            Self::Not | Self::Shift(_) => ty.is_bits(),
            Self::Operator(operator) | Self::Pair(operator) => match operator {
                BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => ty.is_bits(),
                BinaryOp::Modulo => ty.is_integer(),
                BinaryOp::NotEqual => true,
                _ => ty.is_number(),
            },
            Self::SwapBytes | Self::Text(_) | Self::Timed(_) => false,
        }
    }

    /// True if the argument at `position` has the type that a typed function names.
    pub(in crate::check) fn is_typed_at(self, position: usize) -> bool {
        match self {
            Self::Select | Self::Multiplex => position > 0,
            Self::Shift(_) | Self::Power => position == 0,
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_functions_exist_for_the_types_of_their_tables() {
        for known in ["ADD_INT", "MUX_DINT", "SEL_TIME_OF_DAY", "SIN_REAL", "SHL_WORD", "MAX_LTIME"] {
            assert!(find(known).is_some_and(|(_, ty)| ty.is_some()), "{known}");
        }
        for unknown in ["ADD_WORD", "SIN_INT", "AND_INT", "MOD_REAL", "ADD", "NOT_REAL", "_INT", "CONCAT_INT"] {
            assert!(find(unknown).is_none_or(|(_, ty)| ty.is_none()), "{unknown}");
        }
        assert!(is_reserved("ADD") && is_reserved("ADD_TIME") && !is_reserved("ADD_INT") && !is_reserved("ATAN2"));
    }
}
