//! Standard functions: the names of their inputs in SCL, and what SCL has in another way.

use crate::ir::ElementaryType;

/// What becomes of a function.
pub(super) enum Function {
    /// SCL has it, with these inputs; none for one input, which needs no name.
    Same(Vec<String>),
    /// SCL has it by another name, of one input.
    Named(String),
    /// SCL has an operator for it: `a ** b`.
    Power,
    /// SCL has nothing of the kind; what to do.
    Missing(&'static str),
}

/// Functions of one input that SCL has, too.
const UNARY: [&str; 13] =
    ["ABS", "SQRT", "LN", "EXP", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "LEN", "TRUNC", "ROUND"];

/// Functions of several inputs, with their names.
const INPUTS: [(&str, &[&str]); 14] = [
    ("SEL", &["G", "IN0", "IN1"]),
    ("LIMIT", &["MN", "IN", "MX"]),
    ("SHL", &["IN", "N"]),
    ("SHR", &["IN", "N"]),
    ("ROL", &["IN", "N"]),
    ("ROR", &["IN", "N"]),
    ("LEFT", &["IN", "L"]),
    ("RIGHT", &["IN", "L"]),
    ("MID", &["IN", "L", "P"]),
    ("INSERT", &["IN1", "IN2", "P"]),
    ("DELETE", &["IN", "L", "P"]),
    ("REPLACE", &["IN1", "IN2", "L", "P"]),
    ("FIND", &["IN1", "IN2"]),
    ("NOT", &["IN"]),
];

/// What becomes of the standard function `key` with so many inputs, the first of type `first`.
pub(super) fn function(key: &str, count: usize, first: Option<ElementaryType>) -> Function {
    if UNARY.contains(&key) {
        return Function::Same(Vec::new());
    }
    if let Some((_, inputs)) = INPUTS.iter().find(|(name, _)| *name == key) {
        return Function::Same(inputs.iter().map(|name| (*name).to_owned()).collect());
    }
    match key {
        "MAX" | "MIN" | "CONCAT" => Function::Same((1..=count).map(|at| format!("IN{at}")).collect()),
        "MUX" => {
            let inputs = (0..count.saturating_sub(1)).map(|at| format!("IN{at}"));
            Function::Same(std::iter::once("K".to_owned()).chain(inputs).collect())
        }
        "EXPT" => Function::Power,
        "LOG" => Function::Missing("write LN(x) / LN(10.0)"),
        _ => conversion(key, first),
    }
}

/// `INT_TO_REAL`, and `TO_REAL` of the 3rd edition.
fn conversion(key: &str, first: Option<ElementaryType>) -> Function {
    const HELP: &str = "write it with operators, or with functions that TIA Portal has";
    let (from, to) = match key.strip_prefix("TO_") {
        Some(to) => match first {
            Some(from) => (from.name(), to),
            None => return Function::Missing("name the type that is converted: INT_TO_DINT(x)"),
        },
        None => match key.split_once("_TO_") {
            Some(pair) => pair,
            None => return Function::Missing(HELP),
        },
    };
    let is_known = |name: &str| ElementaryType::find(name).is_some() || name == "STRING" || name == "WSTRING";
    if !is_known(from) || !is_known(to) {
        return Function::Missing(HELP);
    }
    let is_time = |name: &str| name == "TIME";
    Function::Named(match (from, to) {
        _ if from == to => String::new(),
        // TIME and DINT are converted into each other there, others go by way of DINT.
        _ if is_time(from) && !matches!(to, "DINT" | "STRING" | "LTIME" | "DWORD") => {
            format!("DINT_TO_{to}(TIME_TO_DINT")
        }
        _ if is_time(to) && !matches!(from, "DINT" | "STRING" | "LTIME" | "DWORD") => {
            format!("DINT_TO_TIME({from}_TO_DINT")
        }
        _ => format!("{from}_TO_{to}"),
    })
}
