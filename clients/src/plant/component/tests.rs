//! A rig to run one component without a scene, and what holds for every kind.

use super::behaviour::{Component, Start, Turn};
use super::coupling::{Coordinate, Seen};
use super::declare::{Failed, FailureSet, Value};
use super::kind::{Form, Setting, Values, unit};
use super::library::{ENTRIES, entry, kinds};
use crate::plant::random::Random;

/// What is seen of so many targets.
pub(crate) fn touched(count: u32) -> Seen {
    Seen { target: (count > 0).then_some(0), count, ..Seen::default() }
}

/// A component alone.
pub(crate) struct Rig<C: Component> {
    pub(crate) component: C,
    pub(crate) state: C::State,
    pub(crate) seen: Seen,
    failed: Failed,
}

impl<C: Component> Rig<C> {
    pub(crate) fn new(component: C) -> Self {
        let state = component.initial(&Start { joint: None, seed: 1 });
        Self { component, state, seen: Seen::default(), failed: Failed::default() }
    }

    /// The rig with one more failure.
    pub(crate) fn failing(mut self, mode: impl FailureSet) -> Self {
        self.failed = self.failed.with(mode.index() as usize);
        self
    }

    /// Runs so many turns under the same inputs; the outputs of the last.
    #[expect(clippy::needless_pass_by_value, reason = "inputs are small and written in place")]
    pub(crate) fn run(&mut self, inputs: C::Inputs, dt_s: f64, turns: u32) -> C::Outputs {
        let mut outputs = C::Outputs::default();
        for _ in 0..turns {
            let turn = Turn { dt_s, seen: self.seen, failed: self.failed };
            self.component.drive(&mut self.state, &inputs, &turn);
            outputs = self.component.sense(&mut self.state, &inputs, &turn);
        }
        outputs
    }
}

/// A stream of inputs and sights that no component knows.
struct Weather(Random);

impl Weather {
    fn inputs(&mut self, table: &[super::kind::Signal]) -> Vec<Value> {
        table
            .iter()
            .map(|signal| match signal.values {
                Values::Bool => Value::Bool(self.0.uniform() < 0.5),
                Values::Number => Value::Number(2.0 * self.0.normal()),
                Values::Whole => Value::Whole((self.0.bits() % 5) as i32),
            })
            .collect()
    }

    fn turn(&mut self, modes: usize) -> Turn {
        let joint = Coordinate { position: self.0.normal(), velocity: self.0.normal() };
        let count = (self.0.bits() % 3) as u32;
        let seen = Seen {
            joint: Some(joint),
            hit_m: (self.0.uniform() < 0.5).then(|| 0.1 * self.0.uniform()),
            target: (count > 0).then(|| count - 1),
            count,
        };
        let failed = (0..modes)
            .fold(Failed::default(), |failed, mode| if self.0.uniform() < 0.1 { failed.with(mode) } else { failed });
        Turn { dt_s: 0.01, seen, failed }
    }
}

#[test]
fn every_kind_goes_on_to_the_bit_from_a_saved_state() {
    for kind in kinds() {
        let entry = entry(kind.name).expect("in the table");
        let settings: Vec<Setting> = kind.parameters.iter().map(|parameter| parameter.preset).collect();
        let mut weather = Weather(Random::new(3));
        let mut first = (entry.start)(&settings, &Start { joint: None, seed: 5 });
        let mut second = (entry.start)(&settings, &Start { joint: None, seed: 99 });
        for k in 0..300 {
            let (inputs, turn) = (weather.inputs(&kind.inputs), weather.turn(kind.failures.len()));
            let (mut one, mut other) = (Vec::new(), Vec::new());
            first.drive(&inputs, &turn);
            first.sense(&inputs, &turn, &mut one);
            if k >= 100 {
                second.drive(&inputs, &turn);
                assert_eq!(second.effect(), first.effect(), "{} {k}", kind.name);
                second.sense(&inputs, &turn, &mut other);
                assert_eq!(one, other, "{} {k}", kind.name);
            }
            for value in &one {
                assert!(!matches!(value, Value::Number(number) if !number.is_finite()), "{} {k}", kind.name);
            }
            assert_eq!(one.len(), kind.outputs.len());
            if k == 99 {
                second
                    .restore(&first.save().expect("plain data"))
                    .unwrap_or_else(|error| panic!("{}: {error}", kind.name));
            }
            assert!(k < 99 || second.save() == first.save(), "{} {k}", kind.name);
        }
        let stateless = first.save() == Ok(Vec::new());
        assert_eq!(first.check(&[]).is_ok(), stateless, "{}: a cut state is refused", kind.name);
        assert_eq!(first.restore(&[]).is_ok(), stateless, "{}: a cut state is refused", kind.name);
    }
}

#[test]
fn every_kind_states_itself_well() {
    let words = |text: &str| text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    for (index, kind) in kinds().iter().enumerate() {
        let name = kind.name;
        assert!(words(name) && ENTRIES[..index].iter().all(|entry| entry.name != name), "{name}");
        assert!(!kind.summary.is_empty() && !kind.formula.is_empty() && !kind.source.is_empty(), "{name}");
        assert!(!kind.failures.is_empty() && kind.failures.len() <= 32, "{name}");
        let reserved = ["name", "kind", "signal_type"];
        let bindings = kind.coupling.keys().iter().map(|binding| binding.key);
        let mut keys: Vec<&str> = reserved.into_iter().chain(bindings).collect();
        for parameter in &kind.parameters {
            assert!(words(parameter.key) && !parameter.about.is_empty(), "{name} {}", parameter.key);
            keys.push(parameter.key);
        }
        let inputs = kind.inputs.iter().map(|signal| signal.key);
        let signals: Vec<&str> = inputs.chain(kind.outputs.iter().map(|signal| signal.key)).collect();
        for list in [keys, signals] {
            let mut sorted = list.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), list.len(), "{name}: a key twice in {list:?}");
        }
    }
}

#[test]
fn every_preset_is_allowed_and_goes_with_the_others() {
    for kind in kinds() {
        let settings: Vec<Setting> = kind.parameters.iter().map(|parameter| parameter.preset).collect();
        for parameter in &kind.parameters {
            let written = match parameter.preset {
                Setting::Number(number) => toml::Value::Float(number),
                Setting::Count(whole) => toml::Value::Integer(whole),
                Setting::Flag(flag) => toml::Value::Boolean(flag),
                Setting::Choice(word) => toml::Value::String(word.to_owned()),
            };
            assert_eq!(parameter.form.read(&written), Some(parameter.preset), "{} {}", kind.name, parameter.key);
        }
        assert_eq!((entry(kind.name).expect("known").conflict)(&settings), None, "{}", kind.name);
    }
}

/// Numbers that have no unit, each with a reason to have none.
const WITHOUT_UNIT: &[&str] = &[
    "critical_ratio",
    "polytropic",
    "rated_slip",
    "damping",
    "friction",
    "ratio",
    "fraction",
    "from",
    "to",
    "differential",
    "span",
    "offset",
];

#[test]
fn every_number_has_its_unit_in_its_key() {
    for kind in kinds() {
        for parameter in &kind.parameters {
            let named =
                unit(parameter.key).1.is_some() || WITHOUT_UNIT.iter().any(|word| parameter.key.ends_with(word));
            assert!(!matches!(parameter.form, Form::Number { .. }) || named, "{} {}", kind.name, parameter.key);
        }
    }
}
