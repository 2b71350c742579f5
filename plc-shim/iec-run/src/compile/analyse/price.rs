//! How many instructions the forms of the language take, about.
//!
//! It decides only whether a loop that ends by itself is so small that it need not pay for its turns. What the
//! code then costs is counted as it is made.

use onescan_iec::ir::elementary::Kind;
use onescan_iec::ir::{Binary, ElementaryType, Intrinsic};

/// A value in memory, fetched and kept in a register.
pub(super) const LOAD: u64 = 3;
/// One that a register holds already.
pub(super) const HELD_LOAD: u64 = 1;
pub(super) const STORE: u64 = 3;
/// Bytes copied, once both addresses are known.
pub(super) const COPY: u64 = 2;
/// Some bits, cut out of a whole.
pub(super) const PART: u64 = 5;
/// A condition asked, and the way around what depends on it.
pub(super) const BRANCH: u64 = 5;
/// What is around a loop.
pub(super) const LOOP: u64 = 4;
/// What is around a loop's body.
pub(super) const TURN: u64 = 2;
/// A turn of a FOR loop that sets its variable, without the loads and stores of that.
pub(super) const FOR: u64 = 70;
/// For a turn, out of the budget.
pub(super) const PAYMENT: u64 = 13;
/// A reference that is checked.
pub(super) const REFERENCE: u64 = 12;
/// Both limits of a subrange.
pub(super) const LIMITS: u64 = 14;
/// A NaN made the one that all machines have.
pub(super) const CANONICAL: u64 = 9;
/// A call of the host, which works on a string.
pub(super) const TEXT_CALL: u64 = 27;
/// A call of a method that only the run decides.
pub(super) const ROW_CALL: u64 = 106;

/// Statements that a fault ends: a call by way of the host, beside a number for each register.
pub(super) const TRY: u64 = 200;

/// A CASE: a block for each arm, and a search for the label.
pub(super) fn case(arms: u64, labels: u64) -> u64 {
    4 + 3 * arms + 6 * labels
}

/// An index of type `ty` that is checked and scaled.
pub(super) fn index(ty: ElementaryType, low: i64, stride: u32) -> u64 {
    let widened = if ty == ElementaryType::Udint { 2 } else { u64::from(ty.size() == 8) };
    6 + widened + 2 * u64::from(low != 0) + 2 * u64::from(stride != 1)
}

/// An element of an array whose bounds come with it.
pub(super) fn open_element(indices: u64) -> u64 {
    8 + 20 * indices
}

/// To cut a number to its type's width.
fn wrap(ty: ElementaryType) -> u64 {
    match (ty.kind(), ty.size()) {
        (Kind::Signed, 1 | 2) => 1,
        (Kind::Unsigned | Kind::Bits, 1 | 2) => 2,
        _ => 0,
    }
}

pub(super) fn unary(ty: ElementaryType) -> u64 {
    if ty == ElementaryType::Bool { 1 } else { 2 + wrap(ty) }
}

pub(super) fn binary(operator: Binary, ty: ElementaryType, by_constant: bool) -> u64 {
    match operator {
        Binary::Divide | Binary::Modulo if by_constant => 1,
        // Zero and, of signed numbers, -1 are asked for.
        Binary::Divide if ty.is_real() => 8,
        Binary::Divide if ty.is_signed() => 17,
        Binary::DivideAnyway if !ty.is_real() => 26,
        Binary::Modulo => 12,
        Binary::Add | Binary::Subtract | Binary::Multiply => 1 + wrap(ty),
        Binary::Divide
        | Binary::DivideAnyway
        | Binary::And
        | Binary::Or
        | Binary::Xor
        | Binary::Equal
        | Binary::NotEqual
        | Binary::Less
        | Binary::LessEqual
        | Binary::Greater
        | Binary::GreaterEqual => 1,
    }
}

pub(super) fn conversion(from: ElementaryType, to: ElementaryType) -> u64 {
    match (from.kind(), to.kind()) {
        (_, Kind::Bool) => 2,
        (Kind::Real, Kind::Real) => u64::from(from.size() != to.size()),
        (Kind::Real, _) => {
            if to.size() == 8 {
                3
            } else {
                17
            }
        }
        (_, Kind::Real) => 1,
        _ => u64::from((from.size() == 8) != (to.size() == 8)) + wrap(to),
    }
}

/// Without its operands.
pub(super) fn intrinsic(intrinsic: Intrinsic, operands: u64, ty: ElementaryType) -> u64 {
    match intrinsic {
        Intrinsic::Abs if !ty.is_real() && ty.is_signed() => 9,
        Intrinsic::Max | Intrinsic::Min if !ty.is_real() => 9,
        Intrinsic::Select => 7,
        Intrinsic::Multiplex => 8 + 8 * operands,
        Intrinsic::ShiftLeft | Intrinsic::ShiftRight => 12,
        Intrinsic::RotateLeft | Intrinsic::RotateRight => 24,
        Intrinsic::Memory(_) | Intrinsic::SwapBytes => 30,
        Intrinsic::FloorRemainder | Intrinsic::FloorMultiple => 17,
        Intrinsic::Fraction => 4,
        Intrinsic::Reinterpret => 2,
        Intrinsic::Abs
        | Intrinsic::Max
        | Intrinsic::Min
        | Intrinsic::Sqrt
        | Intrinsic::Ln
        | Intrinsic::Log
        | Intrinsic::Exp
        | Intrinsic::Sin
        | Intrinsic::Cos
        | Intrinsic::Tan
        | Intrinsic::Asin
        | Intrinsic::Acos
        | Intrinsic::Atan
        | Intrinsic::Atan2
        | Intrinsic::Power => 1,
    }
}
