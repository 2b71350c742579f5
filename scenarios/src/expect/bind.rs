//! Names to signals, units to factors: a formula that can be evaluated.

use std::ops::Range;

use onescan_server::signal::{SignalType, did_you_mean};

use super::error::{FormulaError, FormulaErrorKind};
use super::formula::{Arithmetic, Formula, Term, TermKind};
use super::parser::{Written, parse};
use super::unit::Unit;

type Bound<T> = Result<T, FormulaError>;

/// A signal that formulas may name.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownSignal {
    pub name: String,
    pub ty: SignalType,
    /// The unit of its values.
    pub unit: Option<String>,
}

/// A formula over the signals of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    formula: Formula<usize>,
    signals: Vec<(String, usize)>,
    unit: Option<String>,
}

impl Expectation {
    /// The expectation written in `text`, on signals of `known`. `columns` are the names of the
    /// columns of the [`super::Trace`] it will be judged by; signals that have none get one.
    ///
    /// # Errors
    /// The text is not a formula, or names what is not known.
    pub fn parse(text: &str, known: &[KnownSignal], columns: &mut Vec<String>) -> Result<Self, FormulaError> {
        let mut binder = Binder { known, columns, signals: Vec::new(), compared: Vec::new() };
        let formula = binder.formula(parse(text)?)?;
        let mut units = binder.compared.iter().map(Measure::name);
        let unit = units.next().filter(|unit| !unit.is_empty() && units.all(|other| other == *unit));
        Ok(Self { formula, signals: binder.signals, unit })
    }

    pub(super) fn formula(&self) -> &Formula<usize> {
        &self.formula
    }

    /// How long the past of a run may matter to what is open of it, in nanoseconds, for samples that are `step_ns` apart.
    /// Nothing if all of it may.
    ///
    /// Two runs that have been alike for longer than that, and of which the same is settled, have the same verdict if they
    /// go on alike.
    pub fn memory_ns(&self, step_ns: u64) -> Option<u64> {
        super::reach::memory_ns(&self.formula, step_ns)
    }

    /// True if memory for it grows with every step of a run; it then says little more than one with a window.
    pub fn keeps_every_sample(&self) -> bool {
        self.formula.keeps_every_sample()
    }

    /// The names and columns of its signals, in the order in which they are written.
    pub fn signals(&self) -> &[(String, usize)] {
        &self.signals
    }

    /// What its margin is measured in, if all that it compares has one unit.
    pub fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }
}

/// What the values of a term are measured in.
#[derive(Clone, Debug)]
enum Measure {
    /// A plain number, which takes whatever unit it is compared with.
    Plain,
    Unit(Unit),
    /// A unit that only its signal knows.
    Named(String),
    /// A product of units, which is not checked.
    Derived,
}

impl KnownSignal {
    /// The unit in which formulas and reports have its values; times are seconds.
    pub(crate) fn unit_of_value(&self) -> Option<&str> {
        if self.is_time() { Some("s") } else { self.unit.as_deref() }
    }

    fn is_time(&self) -> bool {
        use SignalType as E;
        matches!(self.ty, E::TIME | E::LTIME | E::TOD | E::LTOD)
    }
}

impl Measure {
    fn of_signal(signal: &KnownSignal) -> Self {
        match &signal.unit {
            _ if signal.is_time() => Unit::find("s").map_or(Self::Derived, Self::Unit),
            Some(name) => Unit::find(name).map_or_else(|| Self::Named(name.clone()), Self::Unit),
            None => Self::Plain,
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Unit(unit) => unit.name.to_owned(),
            Self::Named(name) => name.clone(),
            Self::Plain | Self::Derived => String::new(),
        }
    }

    fn per_second(&self) -> Self {
        match self {
            Self::Unit(unit) => Unit::find(&format!("{}/s", unit.name)).map_or(Self::Derived, Self::Unit),
            Self::Plain => Self::Plain,
            Self::Named(_) | Self::Derived => Self::Derived,
        }
    }
}

struct Binder<'a> {
    known: &'a [KnownSignal],
    columns: &'a mut Vec<String>,
    signals: Vec<(String, usize)>,
    /// What each comparison so far is made in.
    compared: Vec<Measure>,
}

type Measured = (Box<Term<usize>>, Measure);
/// Two terms in one unit.
type Alike = (Box<Term<usize>>, Box<Term<usize>>, Measure);

impl<'a> Binder<'a> {
    fn formula(&mut self, formula: Formula<Written>) -> Bound<Formula<usize>> {
        let boxed = |binder: &mut Self, inner: Box<Formula<Written>>| binder.formula(*inner).map(Box::new);
        Ok(match formula {
            Formula::Constant(value) => Formula::Constant(value),
            Formula::Signal(signal) => Formula::Signal(self.bool_signal(&signal)?),
            Formula::Compare(comparison, left, right) => {
                let (left, right, measure) = self.alike(*left, *right)?;
                self.compared.push(measure);
                Formula::Compare(comparison, left, right)
            }
            Formula::Not(inner) => Formula::Not(boxed(self, inner)?),
            Formula::And(left, right) => Formula::And(boxed(self, left)?, boxed(self, right)?),
            Formula::Or(left, right) => Formula::Or(boxed(self, left)?, boxed(self, right)?),
            Formula::Implies(left, right) => Formula::Implies(boxed(self, left)?, boxed(self, right)?),
            Formula::Iff(left, right) => Formula::Iff(boxed(self, left)?, boxed(self, right)?),
            Formula::Always(window, inner) => Formula::Always(window, boxed(self, inner)?),
            Formula::Eventually(window, inner) => Formula::Eventually(window, boxed(self, inner)?),
            Formula::Until(window, left, right) => Formula::Until(window, boxed(self, left)?, boxed(self, right)?),
            Formula::Historically(window, inner) => Formula::Historically(window, boxed(self, inner)?),
            Formula::Once(window, inner) => Formula::Once(window, boxed(self, inner)?),
            Formula::Since(window, left, right) => Formula::Since(window, boxed(self, left)?, boxed(self, right)?),
            Formula::Edge(edge, inner) => Formula::Edge(edge, boxed(self, inner)?),
        })
    }

    fn signal(&mut self, written: &Written) -> Bound<(usize, &'a KnownSignal)> {
        let Some(signal) = self.known.iter().find(|signal| signal.name == written.name) else {
            let help = did_you_mean(&written.name, self.known.iter().map(|signal| signal.name.as_str()));
            let kind = FormulaErrorKind::UnknownSignal(written.name.clone());
            return Err(FormulaError::new(kind, written.place.clone()).with_help(help));
        };
        if matches!(signal.ty, SignalType::String(_) | SignalType::Wstring(_)) {
            let kind = FormulaErrorKind::Text(signal.name.clone(), signal.ty.to_string());
            return Err(FormulaError::new(kind, written.place.clone()));
        }
        let column = self.column(&signal.name);
        if self.signals.iter().all(|(_, named)| *named != column) {
            self.signals.push((signal.name.clone(), column));
        }
        Ok((column, signal))
    }

    fn column(&mut self, name: &str) -> usize {
        self.columns.iter().position(|column| column == name).unwrap_or_else(|| {
            self.columns.push(name.to_owned());
            self.columns.len() - 1
        })
    }

    fn bool_signal(&mut self, written: &Written) -> Bound<usize> {
        match self.signal(written)? {
            (column, signal) if signal.ty == SignalType::BOOL => Ok(column),
            (_, signal) => {
                let kind = FormulaErrorKind::NotABool(signal.name.clone());
                Err(FormulaError::new(kind, written.place.clone()))
            }
        }
    }

    fn term(&mut self, term: Term<Written>) -> Bound<Measured> {
        let place = term.place;
        let (kind, measure) = match term.kind {
            TermKind::Number(value, unit) => (TermKind::Number(value, None), self.literal_measure(unit, &place)?),
            TermKind::Signal(written) => match self.signal(&written)? {
                (_, signal) if signal.ty == SignalType::BOOL => {
                    let kind = FormulaErrorKind::NotANumber(signal.name.clone());
                    let help = "write the BOOL alone, or `iff` between two of them".to_owned();
                    return Err(FormulaError::new(kind, written.place.clone()).with_help(Some(help)));
                }
                (column, signal) => (TermKind::Signal(column), Measure::of_signal(signal)),
            },
            TermKind::Negate(inner) => {
                let (inner, measure) = self.term(*inner)?;
                (TermKind::Negate(inner), measure)
            }
            TermKind::Abs(inner) => {
                let (inner, measure) = self.term(*inner)?;
                (TermKind::Abs(inner), measure)
            }
            TermKind::Rate(inner) => {
                let (inner, measure) = self.term(*inner)?;
                (TermKind::Rate(inner), measure.per_second())
            }
            TermKind::Binary(operator, left, right) => self.binary(operator, *left, *right)?,
            TermKind::Scaled(inner, times, by) => {
                let (inner, measure) = self.term(*inner)?;
                (TermKind::Scaled(inner, times, by), measure)
            }
        };
        Ok((Box::new(Term { kind, place }), measure))
    }

    fn literal_measure(&self, unit: Option<String>, place: &Range<usize>) -> Bound<Measure> {
        let Some(name) = unit else { return Ok(Measure::Plain) };
        if let Some(unit) = Unit::find(&name) {
            return Ok(Measure::Unit(unit));
        }
        let units = self.known.iter().filter_map(|signal| signal.unit.as_deref());
        if units.clone().any(|unit| unit == name) {
            return Ok(Measure::Named(name));
        }
        let help = did_you_mean(&name, Unit::names().chain(units));
        Err(FormulaError::new(FormulaErrorKind::UnknownUnit(name), place.clone()).with_help(help))
    }

    fn binary(
        &mut self,
        operator: Arithmetic,
        left: Term<Written>,
        right: Term<Written>,
    ) -> Bound<(TermKind<usize>, Measure)> {
        if matches!(operator, Arithmetic::Multiply | Arithmetic::Divide) {
            let ((left, left_measure), (right, right_measure)) = (self.term(left)?, self.term(right)?);
            let measure = match (left_measure, right_measure) {
                (measure, Measure::Plain) => measure,
                (Measure::Plain, measure) if operator == Arithmetic::Multiply => measure,
                _ => Measure::Derived,
            };
            return Ok((TermKind::Binary(operator, left, right), measure));
        }
        let (left, right, measure) = self.alike(left, right)?;
        Ok((TermKind::Binary(operator, left, right), measure))
    }

    /// Two terms in one unit: that of the left one, unless the left one is a number and the right
    /// one is not, so that what is measured is compared as it is.
    fn alike(&mut self, left: Term<Written>, right: Term<Written>) -> Bound<Alike> {
        let place = left.place.start..right.place.end;
        let ((left, left_measure), (right, right_measure)) = (self.term(left)?, self.term(right)?);
        let incommensurable = || {
            let (left, right) = (left_measure.name(), right_measure.name());
            FormulaError::new(FormulaErrorKind::Incommensurable { left, right }, place.clone())
        };
        match (&left_measure, &right_measure) {
            (Measure::Plain, _) => Ok((left, right, right_measure)),
            (_, Measure::Plain | Measure::Derived) | (Measure::Derived, _) => Ok((left, right, left_measure)),
            (Measure::Named(one), Measure::Named(other)) if one == other => Ok((left, right, left_measure)),
            (Measure::Unit(one), Measure::Unit(other)) => {
                if matches!(left.kind, TermKind::Number(..)) {
                    let factor = one.factor_to(*other).ok_or_else(incommensurable)?;
                    return Ok((Box::new(scaled(*left, factor)), right, right_measure));
                }
                let factor = other.factor_to(*one).ok_or_else(incommensurable)?;
                Ok((left, Box::new(scaled(*right, factor)), left_measure))
            }
            _ => Err(incommensurable()),
        }
    }
}

fn scaled(term: Term<usize>, (times, by): (f64, f64)) -> Term<usize> {
    if times == by {
        return term;
    }
    let place = term.place.clone();
    Term { kind: TermKind::Scaled(Box::new(term), times, by), place }
}
