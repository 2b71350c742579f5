//! What is varied as a cube: a point of it, each number from 0 to 1, is a case.

use std::collections::BTreeSet;

use onescan_scenario::Scenario;
use onescan_scenario::case::written::{Entry, List, Written, to_text};
use onescan_scenario::falsify::{Shape, Varied, VariedInput};
use onescan_server::random::Random;
use onescan_server::signal::SignalType;
use onescan_server::time::{TimeSpan, VirtualTime};
use toml::{Table, Value};

use crate::forest::{SearchKind, form};
use onescan_runner::run::SearchError;

/// A point of the cube.
pub(super) type Point = Vec<f64>;

/// The name of each case of a search.
pub(super) const NAME: &str = "falsified";
/// So many corners are looked at, at most.
const CORNERS_MAX: usize = 16;

/// What is varied, and the case to which it comes.
pub(super) struct Space<'a> {
    scenario: &'a Scenario,
    written: Written,
    pub(super) until: VirtualTime,
}

impl<'a> Space<'a> {
    pub(super) fn new(scenario: &'a Scenario, written: Written, until: VirtualTime) -> Self {
        Self { scenario, written, until }
    }

    fn varied(&self) -> &'a Varied {
        self.scenario.varied()
    }

    /// How many numbers a point has: the control points of each input, then the parameters.
    pub(super) fn dimensions(&self) -> usize {
        self.widths().sum()
    }

    /// How many numbers each input and each parameter has.
    fn widths(&self) -> impl Iterator<Item = usize> + '_ {
        let inputs = self.varied().inputs.iter().map(|input| input.points as usize);
        inputs.chain(self.varied().parameters.iter().map(|_| 1))
    }

    /// Corners of the cube in which each input stays as it is: all of them, or some where there are many.
    pub(super) fn corners(&self, random: &mut Random) -> Vec<Point> {
        let widths: Vec<usize> = self.widths().collect();
        let corner = |bits: u64| -> Point {
            let value = |place: usize| if place < 64 && (bits >> place) & 1 == 1 { 1.0 } else { 0.0 };
            widths.iter().enumerate().flat_map(|(place, width)| std::iter::repeat_n(value(place), *width)).collect()
        };
        if 1 << widths.len().min(32) > CORNERS_MAX {
            return (0..CORNERS_MAX).map(|_| corner(random.bits())).collect();
        }
        let mut all: Vec<Point> = (0..1_u64 << widths.len()).map(corner).collect();
        // The order is drawn, so that none is always the last.
        for last in (1..all.len()).rev() {
            all.swap(last, (random.bits() % (last as u64 + 1)) as usize);
        }
        all
    }

    /// When inputs may change.
    pub(super) fn instants(&self) -> BTreeSet<VirtualTime> {
        self.varied()
            .inputs
            .iter()
            .flat_map(|input| (0..input.points).map(|piece| self.control(input, piece)))
            .collect()
    }

    /// Time of a control point, on the grid of steps.
    fn control(&self, input: &VariedInput, number: u32) -> VirtualTime {
        let pieces = if input.shape == Shape::Linear { input.points.saturating_sub(1) } else { input.points };
        let end = input.until.unwrap_or(self.until);
        let length_ns = u128::from(end.as_nanos().saturating_sub(input.from.as_nanos()));
        let passed_ns = length_ns * u128::from(number) / u128::from(pieces.max(1));
        on_grid(input.from.as_nanos().saturating_add(passed_ns as u64), self.step())
    }

    pub(super) fn step(&self) -> TimeSpan {
        self.scenario.plan().step()
    }

    /// A point as entries of a case.
    fn entries(&self, point: &[f64]) -> Vec<Entry> {
        let mut entries = self.written.entries.clone();
        let mut rest = point;
        for input in &self.varied().inputs {
            let (own, others) = rest.split_at_checked(input.points as usize).unwrap_or((rest, &[]));
            rest = others;
            let mut before: Option<Value> = None;
            for (at, share) in self.course(input, own) {
                let value = value_of(input, share);
                // A case says what changes.
                if before.as_ref() != Some(&value) {
                    let signal = Value::from(input.signal.as_str());
                    let keys = [("at", Value::from(to_text(at))), ("signal", signal), ("value", value.clone())];
                    entries.push(Entry { list: List::Input, keys: table(keys) });
                }
                before = Some(value);
            }
        }
        for (parameter, share) in self.varied().parameters.iter().zip(rest) {
            let [least, greatest] = parameter.range;
            let value = least + share.clamp(0.0, 1.0) * (greatest - least);
            entries.push(set(&parameter.path, value, parameter.is_whole));
        }
        entries
    }

    /// What an input is over time, each number from 0 to 1.
    fn course(&self, input: &VariedInput, own: &[f64]) -> Vec<(VirtualTime, f64)> {
        let controls: Vec<(VirtualTime, f64)> =
            own.iter().zip(0..).map(|(share, number)| (self.control(input, number), *share)).collect();
        if input.shape == Shape::PiecewiseConstant {
            return controls;
        }
        let mut course = Vec::new();
        for pair in controls.windows(2) {
            let [(from, first), (until, second)] = *pair else { continue };
            let length_ns = until.as_nanos().saturating_sub(from.as_nanos()).max(1);
            let every_ns = input.every.as_nanos().max(1);
            for number in 0..length_ns.div_ceil(every_ns) {
                let passed_ns = number * every_ns;
                let share = first + (second - first) * (passed_ns as f64 / length_ns as f64);
                course.push((VirtualTime::from_nanos(from.as_nanos() + passed_ns), share));
            }
        }
        course.extend(controls.last());
        course
    }

    /// A point as a case.
    pub(super) fn text(&self, about: Option<&str>, point: &[f64]) -> String {
        let mut written = self.written.clone();
        written.until = Some(self.until);
        written.about = about.map(str::to_owned).or(written.about);
        written.to_toml(NAME, &self.entries(point))
    }

    /// The scenario with a case alone.
    ///
    /// # Errors
    /// The case is wrong.
    pub(super) fn applied(&self, text: &str) -> Result<Scenario, SearchError> {
        Ok(self.scenario.with_last_of(text)?)
    }

    /// Refuses a scenario that cannot run in this process, and parameters that are not there or cannot be what their
    /// ranges say.
    ///
    /// # Errors
    /// All of these.
    pub(super) fn check(&self) -> Result<(), SearchError> {
        let (written, bare) = (&self.written, self.applied(&self.written.to_toml(NAME, &self.written.entries))?);
        form(SearchKind::Falsify, &bare, self.until, [])?;
        for parameter in &self.varied().parameters {
            for end in parameter.range {
                let mut entries = written.entries.clone();
                entries.push(set(&parameter.path, end, parameter.is_whole));
                let applied = self.applied(&written.to_toml(NAME, &entries));
                let form = |applied: &Scenario| form(SearchKind::Falsify, applied, self.until, []).map(drop);
                let formed = applied.and_then(|applied| Ok(form(&applied)?));
                if let Err(error) = formed {
                    return Err(self.scenario.wrong_parameter(parameter, error.to_string(), None).into());
                }
            }
        }
        Ok(())
    }
}

fn on_grid(ns: u64, step: TimeSpan) -> VirtualTime {
    VirtualTime::from_nanos(ns - ns % step.as_nanos())
}

/// The value of an input whose share of its range is this.
fn value_of(input: &VariedInput, share: f64) -> Value {
    let [least, greatest] = input.range;
    let value = least + share.clamp(0.0, 1.0) * (greatest - least);
    match input.ty {
        SignalType::BOOL => Value::Boolean(share >= 0.5),
        SignalType::REAL | SignalType::LREAL => Value::Float(value),
        _ => Value::Integer(value.round() as i64),
    }
}

fn set(path: &str, value: f64, is_whole: bool) -> Entry {
    let value = if is_whole { Value::Integer(value.round() as i64) } else { Value::Float(value) };
    Entry { list: List::Set, keys: table([(path, value)]) }
}

fn table<'k>(keys: impl IntoIterator<Item = (&'k str, Value)>) -> Table {
    keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
