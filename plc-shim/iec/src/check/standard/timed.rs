//! Functions on durations, dates and times of day whose names say what they join (2nd ed. Table 30, 3rd ed. Table 35).

use crate::ir::{Binary, ElementaryType as E};

/// A function whose name says what it joins. Nothing stands for any number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) struct TimedFunction {
    pub(in crate::check) name: &'static str,
    pub(in crate::check) operator: Binary,
    pub(in crate::check) left: E,
    pub(in crate::check) right: Option<E>,
}

const fn timed(name: &'static str, operator: Binary, left: E, right: Option<E>) -> TimedFunction {
    TimedFunction { name, operator, left, right }
}

pub(in crate::check) const FUNCTIONS: [TimedFunction; 26] = [
    timed("ADD_TIME", Binary::Add, E::Time, Some(E::Time)),
    timed("ADD_LTIME", Binary::Add, E::Ltime, Some(E::Ltime)),
    timed("ADD_TOD_TIME", Binary::Add, E::Tod, Some(E::Time)),
    timed("ADD_LTOD_LTIME", Binary::Add, E::Ltod, Some(E::Ltime)),
    timed("ADD_DT_TIME", Binary::Add, E::Dt, Some(E::Time)),
    timed("ADD_LDT_LTIME", Binary::Add, E::Ldt, Some(E::Ltime)),
    timed("SUB_TIME", Binary::Subtract, E::Time, Some(E::Time)),
    timed("SUB_LTIME", Binary::Subtract, E::Ltime, Some(E::Ltime)),
    timed("SUB_DATE_DATE", Binary::Subtract, E::Date, Some(E::Date)),
    timed("SUB_LDATE_LDATE", Binary::Subtract, E::Ldate, Some(E::Ldate)),
    timed("SUB_TOD_TIME", Binary::Subtract, E::Tod, Some(E::Time)),
    timed("SUB_LTOD_LTIME", Binary::Subtract, E::Ltod, Some(E::Ltime)),
    timed("SUB_TOD_TOD", Binary::Subtract, E::Tod, Some(E::Tod)),
    timed("SUB_LTOD_LTOD", Binary::Subtract, E::Ltod, Some(E::Ltod)),
    timed("SUB_DT_TIME", Binary::Subtract, E::Dt, Some(E::Time)),
    timed("SUB_LDT_LTIME", Binary::Subtract, E::Ldt, Some(E::Ltime)),
    timed("SUB_DT_DT", Binary::Subtract, E::Dt, Some(E::Dt)),
    timed("SUB_LDT_LDT", Binary::Subtract, E::Ldt, Some(E::Ldt)),
    timed("MULTIME", Binary::Multiply, E::Time, None),
    timed("MUL_TIME", Binary::Multiply, E::Time, None),
    timed("MUL_LTIME", Binary::Multiply, E::Ltime, None),
    timed("DIVTIME", Binary::Divide, E::Time, None),
    timed("DIV_TIME", Binary::Divide, E::Time, None),
    timed("DIV_LTIME", Binary::Divide, E::Ltime, None),
    timed("CONCAT_DATE_TOD", Binary::Add, E::Date, Some(E::Tod)),
    timed("CONCAT_DATE_LTOD", Binary::Add, E::Ldate, Some(E::Ltod)),
];
