//! Standard functions: the names of their inputs in SCL, and what SCL has in another way.

use onescan_iec::ir::ElementaryType;

/// What becomes of a function.
pub(super) enum Function {
    /// SCL has it, with these inputs; none for one input, which needs no name.
    Same(Vec<String>),
    /// SCL has it by another name, of one input.
    Named(String),
    /// SCL has an operator for it: `a ** b`.
    Operator(&'static str),
    /// SCL has nothing of the kind; what to do.
    Missing(&'static str),
}

/// Functions of one input that SCL has, too.
const UNARY: [&str; 13] =
    ["ABS", "SQRT", "LN", "EXP", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "LEN", "TRUNC", "ROUND"];

/// Functions of several inputs, with their names.
const INPUTS: [(&str, &[&str]); 13] = [
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
];

/// Functions that are operators, with the inputs that they may have (2nd ed. Tables 24, 26 and 28): a comparison of more
/// is one of each pair.
const OPERATORS: [(&str, usize, &str); 14] = [
    ("ADD", usize::MAX, "+"),
    ("SUB", 2, "-"),
    ("MUL", usize::MAX, "*"),
    ("DIV", 2, "/"),
    ("MOD", 2, "MOD"),
    ("AND", usize::MAX, "AND"),
    ("OR", usize::MAX, "OR"),
    ("XOR", usize::MAX, "XOR"),
    ("GT", 2, ">"),
    ("GE", 2, ">="),
    ("EQ", 2, "="),
    ("LE", 2, "<="),
    ("LT", 2, "<"),
    ("NE", 2, "<>"),
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
        "EXPT" => Function::Operator("**"),
        "MOVE" => Function::Named(String::new()),
        "LOG" => Function::Missing("write LN(x) / LN(10.0)"),
        _ => match OPERATORS.iter().find(|(name, most, _)| *name == key && count <= *most) {
            Some((.., operator)) => Function::Operator(operator),
            None => conversion(key, first),
        },
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_written_as_scl_has_them() {
        let shown = |key, count, first| match function(key, count, first) {
            Function::Same(inputs) => inputs.join(" "),
            Function::Named(name) => name,
            Function::Operator(operator) => operator.to_owned(),
            Function::Missing(_) => "none".to_owned(),
        };
        let int = Some(ElementaryType::Int);
        for (key, count, first, wanted) in [
            ("SEL", 3, None, "G IN0 IN1"),
            ("MUX", 3, None, "K IN0 IN1"),
            ("MAX", 3, None, "IN1 IN2 IN3"),
            ("SQRT", 1, None, ""),
            ("TO_DINT", 1, int, "INT_TO_DINT"),
            ("TO_INT", 1, int, ""),
            ("TO_INT", 1, None, "none"),
            ("TIME_TO_LREAL", 1, None, "DINT_TO_LREAL(TIME_TO_DINT"),
            ("LREAL_TO_TIME", 1, None, "DINT_TO_TIME(LREAL_TO_DINT"),
            ("TIME_TO_DINT", 1, None, "TIME_TO_DINT"),
            ("ADD", 3, None, "+"),
            ("GT", 2, None, ">"),
            ("GT", 3, None, "none"),
            ("ADD_INT", 2, int, "none"),
            ("LOG", 1, None, "none"),
        ] {
            assert_eq!(shown(key, count, first), wanted, "{key}");
        }
    }
}
