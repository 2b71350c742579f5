//! Formulas of the present and the past as conditions that a running session can judge.
//!
//! A session has seen the images so far, and none of those to come: what looks ahead is refused, and so is arithmetic
//! with signals, since checkpoints keep conditions as comparisons of signals with values.

use onescan_server::signal::{SignalName, SignalType};
use onescan_server::timeline::{Back, Condition, Edge, Relation};

use super::bind::{Expectation, KnownSignal};
use super::error::{FormulaError, FormulaErrorKind};
use super::formula::{self, Arithmetic, Comparison, Formula, Term, TermKind, Window};

/// The condition written in `text`, on signals of `known`.
///
/// # Errors
/// The text is not a formula, names what is not known, or looks ahead.
pub fn condition(text: &str, known: &[KnownSignal]) -> Result<Condition, FormulaError> {
    let mut columns = Vec::new();
    let expectation = Expectation::parse(text, known, &mut columns)?;
    let signals = Signals { known, columns: &columns, whole: text.len() };
    signals.condition(expectation.formula())
}

/// What the columns of a formula stand for.
struct Signals<'a> {
    known: &'a [KnownSignal],
    columns: &'a [String],
    /// Bytes of the text, for what has no place of its own.
    whole: usize,
}

/// One side of a comparison.
enum Side {
    Number(f64),
    /// A signal; its value times the first by the second is compared.
    Signal(usize, f64, f64),
}

impl Signals<'_> {
    fn condition(&self, formula: &Formula<usize>) -> Result<Condition, FormulaError> {
        let not = |condition| Condition::Not(Box::new(condition));
        let boxed = |inner: &Formula<usize>| self.condition(inner).map(Box::new);
        Ok(match formula {
            Formula::Constant(true) => Condition::All(Vec::new()),
            Formula::Constant(false) => Condition::Any(Vec::new()),
            Formula::Signal(signal) => {
                let (signal, _) = self.signal(*signal)?;
                Condition::Compare { signal, relation: Relation::Equal, value: "1".to_owned() }
            }
            Formula::Compare(comparison, left, right) => self.comparison(*comparison, left, right)?,
            Formula::Not(inner) => not(self.condition(inner)?),
            Formula::And(left, right) => Condition::All(vec![self.condition(left)?, self.condition(right)?]),
            Formula::Or(left, right) => Condition::Any(vec![self.condition(left)?, self.condition(right)?]),
            Formula::Implies(left, right) => Condition::Any(vec![not(self.condition(left)?), self.condition(right)?]),
            Formula::Iff(left, right) => {
                let (left, right) = (self.condition(left)?, self.condition(right)?);
                let neither = Condition::All(vec![not(left.clone()), not(right.clone())]);
                Condition::Any(vec![Condition::All(vec![left, right]), neither])
            }
            Formula::Historically(window, inner) => Condition::Historically(back(*window), boxed(inner)?),
            Formula::Once(window, inner) => Condition::Once(back(*window), boxed(inner)?),
            Formula::Since(window, left, right) => {
                let both = [self.condition(left)?, self.condition(right)?];
                Condition::Since(back(*window), Box::new(both))
            }
            Formula::Edge(edge, inner) => Condition::Edge(edge_of(*edge), boxed(inner)?),
            Formula::Always(..) | Formula::Eventually(..) | Formula::Until(..) => {
                let help =
                    "write what has happened: `once`, `historically`, `since`, `rose`, `fell`, `changed`".to_owned();
                return Err(FormulaError::new(FormulaErrorKind::LooksAhead, 0..self.whole).with_help(help));
            }
        })
    }

    fn refused(place: std::ops::Range<usize>) -> FormulaError {
        let help = "compare signals with values, and combine with `and`, `or`, `not`, `implies`".to_owned();
        FormulaError::new(FormulaErrorKind::NotNow, place).with_help(help)
    }

    fn signal(&self, column: usize) -> Result<(SignalName, SignalType), FormulaError> {
        let known = self.known.iter().find(|known| Some(&known.name) == self.columns.get(column));
        let found = known.and_then(|known| Some((SignalName::new(known.name.as_str()).ok()?, known.ty)));
        found.ok_or_else(|| Self::refused(0..self.whole))
    }

    fn comparison(
        &self,
        comparison: Comparison,
        left: &Term<usize>,
        right: &Term<usize>,
    ) -> Result<Condition, FormulaError> {
        let place = left.place.start.min(right.place.start)..left.place.end.max(right.place.end);
        let relation = relation(comparison);
        let (signal, relation, value) = match (Self::side(left)?, Self::side(right)?) {
            (Side::Signal(signal, times, by), Side::Number(number)) => (signal, relation, number * by / times),
            (Side::Number(number), Side::Signal(signal, times, by)) => (signal, turned(relation), number * by / times),
            _ => return Err(Self::refused(place)),
        };
        let (signal, ty) = self.signal(signal)?;
        Ok(on(&signal, ty, relation, value))
    }

    fn side(term: &Term<usize>) -> Result<Side, FormulaError> {
        if let Some(number) = constant(term) {
            return Ok(Side::Number(number));
        }
        match &term.kind {
            TermKind::Signal(signal) => Ok(Side::Signal(*signal, 1.0, 1.0)),
            TermKind::Scaled(inner, times, by) => match Self::side(inner)? {
                Side::Signal(signal, own_times, own_by) => Ok(Side::Signal(signal, own_times * times, own_by * by)),
                Side::Number(_) => Err(Self::refused(term.place.clone())),
            },
            _ => Err(Self::refused(term.place.clone())),
        }
    }
}

/// A number compared with a signal of a type that may not have it: an integer cannot be 2.5, but it can
/// be greater.
fn on(signal: &SignalName, ty: SignalType, relation: Relation, value: f64) -> Condition {
    let compare = |relation, value: String| Condition::Compare { signal: signal.clone(), relation, value };
    let SignalType::Elementary(elementary) = ty else { return compare(relation, value.to_string()) };
    let Some((low, high)) = elementary.range() else { return compare(relation, format!("{value:?}")) };
    // Times are compared in seconds and kept in nanoseconds.
    let value = if elementary.is_duration() || elementary.is_calendar() { value * 1e9 } else { value };
    let never = || Condition::Any(Vec::new());
    let always = || Condition::All(Vec::new());
    let floor = value.floor();
    let is_whole = floor == value;
    let text = |whole: f64| (whole as i128).to_string();
    let (low, high) = (low as f64, high as f64);
    match relation {
        Relation::Equal if !is_whole || value < low || value > high => never(),
        Relation::Unequal if !is_whole || value < low || value > high => always(),
        Relation::Equal | Relation::Unequal => compare(relation, text(value)),
        // Below 2.5 is at most 2; above 2.5 is at least 3, which is above 2.
        Relation::Less | Relation::AtMost if value > high => always(),
        Relation::Less | Relation::AtMost if value < low => never(),
        Relation::Less if is_whole => compare(Relation::Less, text(value)),
        Relation::Less | Relation::AtMost => compare(Relation::AtMost, text(floor)),
        Relation::Greater | Relation::AtLeast if value > high => never(),
        Relation::Greater | Relation::AtLeast if value < low => always(),
        Relation::AtLeast if is_whole => compare(Relation::AtLeast, text(value)),
        Relation::Greater | Relation::AtLeast => compare(Relation::Greater, text(floor)),
    }
}

/// The value of a term without signals.
fn constant(term: &Term<usize>) -> Option<f64> {
    Some(match &term.kind {
        TermKind::Number(number, _) => *number,
        TermKind::Signal(_) | TermKind::Rate(_) => return None,
        TermKind::Negate(inner) => -constant(inner)?,
        TermKind::Abs(inner) => constant(inner)?.abs(),
        TermKind::Scaled(inner, times, by) => constant(inner)? * times / by,
        TermKind::Binary(operator, left, right) => {
            let (left, right) = (constant(left)?, constant(right)?);
            match operator {
                Arithmetic::Add => left + right,
                Arithmetic::Subtract => left - right,
                Arithmetic::Multiply => left * right,
                Arithmetic::Divide => left / right,
                Arithmetic::Min => left.min(right),
                Arithmetic::Max => left.max(right),
            }
        }
    })
}

fn back(window: Window) -> Back {
    Back { from_ns: window.from_ns, to_ns: window.to_ns }
}

fn edge_of(edge: formula::Edge) -> Edge {
    match edge {
        formula::Edge::Rose => Edge::Rose,
        formula::Edge::Fell => Edge::Fell,
        formula::Edge::Changed => Edge::Changed,
    }
}

fn relation(comparison: Comparison) -> Relation {
    match comparison {
        Comparison::Less => Relation::Less,
        Comparison::LessEqual => Relation::AtMost,
        Comparison::Greater => Relation::Greater,
        Comparison::GreaterEqual => Relation::AtLeast,
        Comparison::Equal => Relation::Equal,
        Comparison::NotEqual => Relation::Unequal,
    }
}

/// The relation with its sides exchanged.
fn turned(relation: Relation) -> Relation {
    match relation {
        Relation::Less => Relation::Greater,
        Relation::AtMost => Relation::AtLeast,
        Relation::Greater => Relation::Less,
        Relation::AtLeast => Relation::AtMost,
        same => same,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> String {
        let signal = |name: &str, ty, unit: Option<&str>| KnownSignal {
            name: name.to_owned(),
            ty,
            unit: unit.map(str::to_owned),
        };
        let known = [
            signal("On", SignalType::BOOL, None),
            signal("x", SignalType::LREAL, Some("m")),
            signal("n", SignalType::USINT, None),
            signal("t", SignalType::TIME, None),
        ];
        condition(text, &known).map_or_else(|error| format!("error: {error}"), |condition| condition.to_string())
    }

    #[test]
    fn formulas_without_a_future_are_conditions() {
        let texts = [
            "On",
            "not On",
            "x > 50 mm",
            "0.5 < x",
            "On and (x <= -1 or n = 3)",
            "n > 2.5",
            "n < 2.5",
            "n = 2.5",
            "n < 300",
            "t >= 20 ms",
            "On implies n = 1",
            "always On",
            "rose(On)",
            "On and not once[20ms,1s] x > 1",
            "historically[100ms,] fell(On)",
            "(n > 1) since[0s,2s] changed(x > 0.5)",
            "rose(eventually On)",
            "rate(x) > 1",
            "x + 1 > 2",
            "x > x",
            "y",
        ];
        let read: Vec<String> = texts.iter().map(|text| format!("{text}  ->  {}", read(text))).collect();
        insta::assert_snapshot!(read.join("\n"));
    }

    use onescan_server::timeline::past::Judged;
    use proptest::prelude::*;

    use super::super::monitor::Monitor;
    use super::super::sample::Block;
    use super::super::truth::Truth;

    fn past() -> impl Strategy<Value = String> {
        let window = prop_oneof![
            2 => Just(String::new()),
            4 => (0_u64..9, 0_u64..12).prop_map(|(from, length)| format!("[{from}ns,{}ns]", from + length)),
            1 => (0_u64..9).prop_map(|from| format!("[{from}ns,]")),
        ];
        let leaf = prop_oneof![Just("On".to_owned()), (-2_i32..3).prop_map(|limit| format!("(x > {limit})"))];
        leaf.prop_recursive(4, 16, 2, move |inner| {
            let two = prop::sample::select(vec!["and", "or", "implies", "iff"]);
            let one = prop::sample::select(vec!["historically", "once"]);
            let edge = prop::sample::select(vec!["rose", "fell", "changed"]);
            prop_oneof![
                (one, window.clone(), inner.clone()).prop_map(|(word, window, f)| format!("({word}{window} {f})")),
                (inner.clone(), two, inner.clone()).prop_map(|(f, word, g)| format!("({f} {word} {g})")),
                (inner.clone(), window.clone(), inner.clone())
                    .prop_map(|(f, window, g)| format!("({f} since{window} {g})")),
                inner.clone().prop_map(|f| format!("(not {f})")),
                (edge, inner).prop_map(|(word, f)| format!("{word}({f})")),
            ]
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]
        /// A session judges the past as expectations do, at every image, and also after its memories were saved.
        #[test]
        fn conditions_are_worth_what_formulas_are(
            text in past(),
            samples in prop::collection::vec((1_u64..5, -3_i32..4, any::<bool>()), 1..60),
        ) {
            let signal = |name: &str, ty| KnownSignal { name: name.to_owned(), ty, unit: None };
            let known = [signal("On", SignalType::BOOL), signal("x", SignalType::LREAL)];
            let mut columns = vec!["On".to_owned(), "x".to_owned()];
            let expectation = Expectation::parse(&text, &known, &mut columns).expect("a formula");
            let mut monitor = Monitor::every(expectation.formula());
            let mut block = Block::new(2);
            let condition = condition(&text, &known).expect("a condition");
            let bind = &mut |signal: &SignalName, _: Relation, value: &str| {
                Ok::<_, std::convert::Infallible>((signal.as_str() == "On", value.parse::<f64>().unwrap_or(f64::NAN)))
            };
            let judged = Judged::new(&condition, bind).expect("bound");
            let mut memories = judged.nothing_seen();
            let (mut t_ns, mut now) = (0, Vec::new());
            for (dt_ns, x, on) in &samples {
                let x = f64::from(*x);
                block.push(t_ns, 1, 1, [f64::from(u8::from(*on)), x]);
                let holds = &mut |(is_on, limit): &(bool, f64)| if *is_on { *on } else { x > *limit };
                now.push(judged.judge(&mut memories, t_ns, holds));
                let saved = serde_json::to_string(&memories).expect("JSON");
                memories = serde_json::from_str(&saved).expect("memories");
                prop_assert!(judged.fits(&memories));
                t_ns += dt_ns;
            }
            monitor.push(&block);
            let expected: Vec<bool> = monitor.take_said().map(|said| said.worth.truth == Truth::True).collect();
            prop_assert_eq!(now, expected, "{}", text);
        }
    }
}
