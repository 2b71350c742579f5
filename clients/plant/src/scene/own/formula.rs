//! `"=stroke_m / 2"`: values of an assembly's parts that follow from its parameters.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = factor { ("*" | "/") factor }
//! factor  = [ "-" ] ( number | name | "(" sum ")" )
//! ```
//! A name alone stands for its parameter's value as it is, a text or a truth value too. Whole numbers stay whole, but
//! for `/`, which gives a number.

use onescan_base::did_you_mean;
use toml::Value;

/// Deepest nesting of parentheses and signs.
const DEPTH_MAX: usize = 64;

/// What is wrong with a formula: where in it, what, and what was meant.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct FormulaError {
    pub(super) cause: String,
    pub(super) hint: Option<String>,
}

impl FormulaError {
    fn new(cause: impl Into<String>) -> Self {
        Self { cause: cause.into(), hint: None }
    }
}

/// A number of TOML.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    Whole(i64),
    Real(f64),
}

/// The value of a formula, without its `=`; `known` gives the values of names.
///
/// # Errors
/// It is not a formula, names nothing that is known, or has no finite value.
pub(super) fn value(formula: &str, known: &[(&str, Value)]) -> Result<Value, FormulaError> {
    let alone = formula.trim();
    if let Some((_, value)) = known.iter().find(|(name, _)| *name == alone) {
        return Ok(value.clone());
    }
    let mut reader = Reader { rest: formula, known, depth: 0 };
    let number = reader.sum()?;
    if let Some(next) = reader.next() {
        return Err(FormulaError::new(format!("`{next}` stands where an operator or the end is due")));
    }
    match number {
        Number::Whole(whole) => Ok(Value::Integer(whole)),
        Number::Real(real) if real.is_finite() => Ok(Value::Float(real)),
        Number::Real(real) => Err(FormulaError::new(format!("its value is {real}"))),
    }
}

struct Reader<'f> {
    rest: &'f str,
    known: &'f [(&'f str, Value)],
    depth: usize,
}

impl Reader<'_> {
    /// The next character that is not a blank.
    fn next(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    fn skip(&mut self) {
        let mut rest = self.rest.chars();
        rest.next();
        self.rest = rest.as_str();
    }

    fn sum(&mut self) -> Result<Number, FormulaError> {
        let mut value = self.product()?;
        while let Some(sign @ ('+' | '-')) = self.next() {
            self.skip();
            let other = self.product()?;
            value = combined(value, other, sign)?;
        }
        Ok(value)
    }

    fn product(&mut self) -> Result<Number, FormulaError> {
        let mut value = self.factor()?;
        while let Some(sign @ ('*' | '/')) = self.next() {
            self.skip();
            let other = self.factor()?;
            value = combined(value, other, sign)?;
        }
        Ok(value)
    }

    fn factor(&mut self) -> Result<Number, FormulaError> {
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err(FormulaError::new(format!("it is nested more than {DEPTH_MAX} deep")));
        }
        let value = match self.next() {
            Some('-') => {
                self.skip();
                combined(Number::Whole(0), self.factor()?, '-')
            }
            Some('(') => {
                self.skip();
                let inner = self.sum()?;
                if self.next() != Some(')') {
                    return Err(FormulaError::new("a `)` is missing"));
                }
                self.skip();
                Ok(inner)
            }
            Some(next) if next.is_ascii_digit() || next == '.' => self.number(),
            Some(next) if next.is_ascii_alphabetic() || next == '_' => self.name(),
            Some(other) => Err(FormulaError::new(format!("`{other}` stands where a number or a name is due"))),
            None => Err(FormulaError::new("it ends where a number or a name is due")),
        };
        self.depth -= 1;
        value
    }

    fn take(&mut self, length: usize) -> &str {
        let (taken, rest) = self.rest.split_at(length);
        self.rest = rest;
        taken
    }

    fn number(&mut self) -> Result<Number, FormulaError> {
        let mut last = ' ';
        let length = self.rest.find(|next: char| {
            let goes_on = next.is_ascii_digit()
                || matches!(next, '.' | 'e' | 'E')
                || matches!(next, '+' | '-') && matches!(last, 'e' | 'E');
            last = next;
            !goes_on
        });
        let text = self.take(length.unwrap_or(self.rest.len()));
        let whole = text.parse().map(Number::Whole);
        let number = whole.or_else(|_| text.parse().map(Number::Real));
        number.map_err(|_| FormulaError::new(format!("`{text}` is not a number")))
    }

    fn name(&mut self) -> Result<Number, FormulaError> {
        let length = self.rest.find(|next: char| !(next.is_ascii_alphanumeric() || next == '_'));
        let known = self.known;
        let name = self.take(length.unwrap_or(self.rest.len()));
        match known.iter().find(|(known, _)| *known == name).map(|(_, value)| value) {
            Some(Value::Integer(whole)) => Ok(Number::Whole(*whole)),
            Some(Value::Float(real)) => Ok(Number::Real(*real)),
            Some(_) => Err(FormulaError::new(format!("`{name}` is not a number, so nothing can be computed with it"))),
            None => {
                let hint = did_you_mean(name, known.iter().map(|(name, _)| *name));
                Err(FormulaError { cause: format!("there is no parameter or binding `{name}`"), hint })
            }
        }
    }
}

fn combined(a: Number, b: Number, sign: char) -> Result<Number, FormulaError> {
    if let (Number::Whole(a), Number::Whole(b), '+' | '-' | '*') = (a, b, sign) {
        let whole = match sign {
            '+' => a.checked_add(b),
            '-' => a.checked_sub(b),
            _ => a.checked_mul(b),
        };
        return whole.map(Number::Whole).ok_or_else(|| FormulaError::new("its value is beyond 64 bits"));
    }
    let real = |number| match number {
        Number::Whole(whole) => whole as f64,
        Number::Real(real) => real,
    };
    let (a, b) = (real(a), real(b));
    Ok(Number::Real(match sign {
        '+' => a + b,
        '-' => a - b,
        '*' => a * b,
        _ => a / b,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(formula: &str) -> Result<Value, String> {
        let known = [
            ("length_m", Value::Float(0.5)),
            ("teeth", Value::Integer(20)),
            ("valve", Value::String("5/3".to_owned())),
            ("fitted", Value::Boolean(true)),
        ];
        value(formula, &known).map_err(|error| format!("{}; {}", error.cause, error.hint.unwrap_or_default()))
    }

    #[test]
    fn a_formula_has_the_value_of_arithmetic() {
        assert_eq!(of("length_m / 2 - -0.25"), Ok(Value::Float(0.5)));
        assert_eq!(of(" 2 * (teeth + 1) "), Ok(Value::Integer(42)));
        assert_eq!(of("teeth / 8"), Ok(Value::Float(2.5)));
        assert_eq!(of("1e-3 + 2E+1"), Ok(Value::Float(20.001)));
        assert_eq!(of("10 - 4 - 3"), Ok(Value::Integer(3)));
        assert_eq!(of("-teeth"), Ok(Value::Integer(-20)));
    }

    #[test]
    fn a_name_alone_is_its_value() {
        assert_eq!(of("valve"), Ok(Value::String("5/3".to_owned())));
        assert_eq!(of("fitted"), Ok(Value::Boolean(true)));
    }

    #[test]
    fn what_is_no_formula_is_refused() {
        let deep = "(".repeat(1000);
        let wrong =
            ["", "2 +", "2 2", "lenght_m", "valve * 2", "1/0", "(1", "1..2", "&", "9223372036854775807 + 1", &deep];
        insta::assert_snapshot!(wrong.map(|formula| of(formula).expect_err("refused")).join("\n"));
    }
}
