//! Rules on types and values, which know no declaration: constants, operands, what converts to what.
//!
//! | module | subject |
//! |---|---|
//! | [`operand`] | what an expression has come to, before its context types it |
//! | [`constant`] | constant expressions to values, bytes to values |
//! | [`number`] | bit strings as numbers, TIME as vendors count it |
//! | [`build`] | expressions and statements that no text stands for |
//! | [`reference`] | what a type refers to |
//! | [`generic`] | the types that a generic input takes |
//! | [`first_high`] | bytes as controllers of Siemens have them, for views |
//! | [`parameter`], [`width`] | parameters that take arrays of any bounds, the types of direct addresses |

pub(super) mod build;
pub(super) mod constant;
pub(super) mod first_high;
pub(super) mod generic;
pub(super) mod number;
pub(super) mod operand;
pub(super) mod parameter;
pub(super) mod reference;
pub(super) mod width;
