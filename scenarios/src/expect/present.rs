//! Formulas of the present, judged on the values of one image.
//!
//! Where a [`super::condition`] is on signals and values only, so that a session can keep it in a checkpoint, these may
//! have arithmetic with signals, too.

use super::bind::{Expectation, KnownSignal};
use super::error::{FormulaError, FormulaErrorKind};
use super::formula::{Comparison, Formula, Term, TermKind};
use super::truth::{Scale, Truth};

/// A formula that one image decides.
#[derive(Clone, Debug)]
pub struct Present(Part);

#[derive(Clone, Debug)]
enum Part {
    Constant(bool),
    Signal(usize),
    Compare(Comparison, Value, Value),
    Not(Box<Self>),
    And(Box<[Self; 2]>),
    Or(Box<[Self; 2]>),
    Iff(Box<[Self; 2]>),
}

#[derive(Clone, Debug)]
enum Value {
    Constant(f64),
    Signal(usize),
    Changed(fn(f64) -> f64, Box<Self>),
    Joined(fn(f64, f64) -> f64, Box<[Self; 2]>),
    /// Times the first, by the second.
    Scaled(Box<Self>, f64, f64),
}

impl Present {
    /// The formula written in `text`, on signals of `known`. `columns` are the names of the values that it will be
    /// judged on; signals that have none get one.
    ///
    /// # Errors
    /// The text is not a formula, names what is not known, or needs more than one image.
    pub fn parse(text: &str, known: &[KnownSignal], columns: &mut Vec<String>) -> Result<Self, FormulaError> {
        let expectation = Expectation::parse(text, known, columns)?;
        Part::of(expectation.formula()).map(Self).ok_or_else(|| {
            let help = "write what holds at one time: signals, comparisons, `and`, `or`, `not`, `implies`, `iff`";
            FormulaError::new(FormulaErrorKind::NotPresent, 0..text.len()).with_help(help.to_owned())
        })
    }

    /// Whether it holds with these values, one a column. A column that is missing is NaN.
    pub fn holds(&self, values: &[f64]) -> bool {
        self.0.holds(values)
    }
}

impl Part {
    /// Nothing if it looks at more than one image.
    fn of(formula: &Formula<usize>) -> Option<Self> {
        let two = |left: &Formula<usize>, right: &Formula<usize>| Some(Box::new([Self::of(left)?, Self::of(right)?]));
        let not = |inner: &Formula<usize>| Some(Self::Not(Box::new(Self::of(inner)?)));
        Some(match formula {
            Formula::Constant(value) => Self::Constant(*value),
            Formula::Signal(column) => Self::Signal(*column),
            Formula::Compare(comparison, left, right) => {
                Self::Compare(*comparison, Value::of(left)?, Value::of(right)?)
            }
            Formula::Not(inner) => not(inner)?,
            Formula::And(left, right) => Self::And(two(left, right)?),
            Formula::Or(left, right) => Self::Or(two(left, right)?),
            Formula::Implies(left, right) => Self::Or(Box::new([not(left)?, Self::of(right)?])),
            Formula::Iff(left, right) => Self::Iff(two(left, right)?),
            Formula::Always(..)
            | Formula::Eventually(..)
            | Formula::Until(..)
            | Formula::Historically(..)
            | Formula::Once(..)
            | Formula::Since(..)
            | Formula::Edge(..) => return None,
        })
    }

    fn holds(&self, values: &[f64]) -> bool {
        match self {
            Self::Constant(value) => *value,
            Self::Signal(column) => column_of(values, *column) != 0.0,
            Self::Compare(comparison, left, right) => {
                Truth::of_comparison(*comparison, left.at(values), right.at(values)) == Truth::True
            }
            Self::Not(inner) => !inner.holds(values),
            Self::And(both) => both.iter().all(|one| one.holds(values)),
            Self::Or(both) => both.iter().any(|one| one.holds(values)),
            Self::Iff(both) => both[0].holds(values) == both[1].holds(values),
        }
    }
}

impl Value {
    fn of(term: &Term<usize>) -> Option<Self> {
        let boxed = |term: &Term<usize>| Self::of(term).map(Box::new);
        Some(match &term.kind {
            TermKind::Number(value, _) => Self::Constant(*value),
            TermKind::Signal(column) => Self::Signal(*column),
            TermKind::Rate(_) => return None,
            TermKind::Negate(inner) => Self::Changed(|value| -value, boxed(inner)?),
            TermKind::Abs(inner) => Self::Changed(f64::abs, boxed(inner)?),
            TermKind::Scaled(inner, times, by) => Self::Scaled(boxed(inner)?, *times, *by),
            TermKind::Binary(operator, left, right) => {
                Self::Joined(operator.operation(), Box::new([Self::of(left)?, Self::of(right)?]))
            }
        })
    }

    fn at(&self, values: &[f64]) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Signal(column) => column_of(values, *column),
            Self::Changed(change, inner) => change(inner.at(values)),
            Self::Joined(join, both) => join(both[0].at(values), both[1].at(values)),
            Self::Scaled(inner, times, by) => inner.at(values) * times / by,
        }
    }
}

fn column_of(values: &[f64], column: usize) -> f64 {
    values.get(column).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalType;

    use super::*;

    fn judged(text: &str, values: &[f64]) -> Result<bool, String> {
        let known = [("On", SignalType::BOOL, None), ("x", SignalType::LREAL, Some("m")), ("n", SignalType::INT, None)]
            .map(|(name, ty, unit)| KnownSignal { name: name.to_owned(), ty, unit: unit.map(str::to_owned) });
        let mut columns = known.each_ref().map(|signal| signal.name.clone()).to_vec();
        Present::parse(text, &known, &mut columns)
            .map(|present| present.holds(values))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn one_image_decides() {
        let values = [1.0, 0.05, 3.0];
        for text in ["On", "x = 50 mm", "n + 1 > 3 and On", "On iff n = 3", "not On implies false", "abs(x - 1) < 1 m"]
        {
            assert_eq!(judged(text, &values), Ok(true), "{text}");
            assert_eq!(judged(&format!("not ({text})"), &values), Ok(false), "{text}");
        }
        assert_eq!(judged("x < 1 or x >= 1", &[1.0, f64::NAN, 0.0]), Ok(false), "nothing compares with NaN");
    }

    #[test]
    fn what_needs_a_past_or_a_future_is_refused() {
        for text in ["rose(On)", "On and once On", "rate(x) > 1", "not eventually On", "abs(rate(x)) > 1"] {
            assert_eq!(judged(text, &[]), Err(FormulaErrorKind::NotPresent.to_string()), "{text}");
        }
    }
}
