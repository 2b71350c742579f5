//! A rig to run one component without a scene, and what holds for every kind.

use super::behaviour::{self, Component, SeenBy, Start, Turn};
use super::declare::{Failed, FailureSet, ParameterSet, SignalSet, Value};
use super::kind::{Form, Setting, Values, unit};
use super::library::{ENTRIES, kinds};
use super::origin::Origin;
use crate::coupling::{Carried, Coordinate, Grasp, Hit, InField, InTags, Interrupted, Load, Moving, Pressing, Targets};
use crate::effort::Motion;
use crate::temperature_field::TemperatureField;
use onescan_server::random::Random;

/// What is seen of so many targets.
pub(crate) fn touched(count: u32) -> Targets {
    Targets { first: (count > 0).then_some(0), count }
}

/// What a holder sees of so many targets, of which holding one takes a force.
pub(crate) fn grasped(count: u32, force_n: f64) -> Grasp {
    let force_n = if count > 0 { force_n } else { 0.0 };
    Grasp { targets: touched(count), load: Load { force_n, pull_n: None, beside_m: 0.0 } }
}

pub(crate) struct Rig<C: Component> {
    pub(crate) component: C,
    pub(crate) state: C::State,
    pub(crate) seen: SeenBy<C>,
    pub(crate) failed: Failed,
}

impl<C: Component> Rig<C> {
    pub(crate) fn new(component: C) -> Self {
        let state = component.initial(&Start { seen: SeenBy::<C>::default(), seed: 1 });
        Self { component, state, seen: SeenBy::<C>::default(), failed: Failed::default() }
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
                Values::Bytes => Value::Bytes,
            })
            .collect()
    }

    fn turn<S: Sight>(&mut self, modes: usize) -> Turn<S> {
        let seen = S::in_weather(&mut self.0);
        let failed = (0..modes)
            .fold(Failed::default(), |failed, mode| if self.0.uniform() < 0.1 { failed.with(mode) } else { failed });
        Turn { dt_s: 0.01, seen, failed }
    }
}

/// What a component may see, at random.
pub(crate) trait Sight {
    fn in_weather(random: &mut Random) -> Self;
}

impl Sight for () {
    fn in_weather(_: &mut Random) {}
}

impl Sight for u32 {
    fn in_weather(random: &mut Random) -> Self {
        (random.bits() % 3) as u32
    }
}

impl Sight for Coordinate {
    fn in_weather(random: &mut Random) -> Self {
        Self { position: random.normal(), velocity: random.normal() }
    }
}

impl Sight for Option<Coordinate> {
    fn in_weather(random: &mut Random) -> Self {
        Some(Coordinate::in_weather(random))
    }
}

impl Sight for Option<Carried> {
    fn in_weather(random: &mut Random) -> Self {
        Some(Carried { position: random.normal(), force_n: 1e4 * random.normal() })
    }
}

impl Sight for Option<[Carried; 3]> {
    fn in_weather(random: &mut Random) -> Self {
        Some([(); 3].map(|()| Carried { position: random.normal(), force_n: 1e4 * random.normal() }))
    }
}

impl Sight for Interrupted {
    fn in_weather(random: &mut Random) -> Self {
        Self(if random.uniform() < 0.5 { 0 } else { random.bits() })
    }
}

impl Sight for Pressing {
    fn in_weather(random: &mut Random) -> Self {
        Self { kg: 50.0 * random.uniform() }
    }
}

impl Sight for InTags {
    fn in_weather(random: &mut Random) -> Self {
        Self { targets: Targets::in_weather(random), data: random.bits() as i32 }
    }
}

impl Sight for TemperatureField {
    fn in_weather(random: &mut Random) -> Self {
        Self { angle_rad: 10.0 * random.uniform(), length_m: 60.0, ..Self::default() }
    }
}

impl Sight for Hit {
    fn in_weather(random: &mut Random) -> Self {
        Self { hit_m: (random.uniform() < 0.5).then(|| 0.1 * random.uniform()) }
    }
}

impl Sight for Targets {
    fn in_weather(random: &mut Random) -> Self {
        let count = (random.bits() % 3) as u32;
        Self { first: (count > 0).then(|| count - 1), count }
    }
}

impl Sight for Grasp {
    fn in_weather(random: &mut Random) -> Self {
        let force_n = 1000.0 * random.uniform();
        let pull_n = (random.uniform() < 0.5).then(|| force_n * random.uniform());
        let load = Load { force_n, pull_n, beside_m: 0.1 * random.uniform() };
        Self { targets: Targets::in_weather(random), load }
    }
}

impl Sight for Moving {
    fn in_weather(random: &mut Random) -> Self {
        let mut any = || [(); 3].map(|()| random.normal());
        Self { position_m: any(), rpy_deg: any(), velocity_m_s: any(), turning_rad_s: any(), felt_m_s2: any() }
    }
}

impl Sight for InField {
    fn in_weather(random: &mut Random) -> Self {
        let position_m = [(); 3].map(|()| random.normal());
        Self { targets: Targets::in_weather(random), position_m, turned_deg: 100.0 * random.normal() }
    }
}

/// What holds for every kind: from a saved state it goes on to the bit, and its outputs are finite
/// numbers.
pub(crate) fn laws<C: Component>()
where
    SeenBy<C>: Sight,
{
    let (inputs, modes) = (C::Inputs::table(), C::Failure::table().len());
    let new = |seed| {
        let component = C::new(C::Parameters::default());
        let state = component.initial(&Start { seen: SeenBy::<C>::default(), seed });
        (component, state)
    };
    let mut weather = Weather(Random::new(3));
    let ((first, mut state), (second, mut other)) = (new(5), new(99));
    for k in 0..300 {
        let taken = C::Inputs::read(&weather.inputs(&inputs));
        let turn = weather.turn(modes);
        let (mut one, mut again) = (Vec::new(), Vec::new());
        first.drive(&mut state, &taken, &turn);
        let motion = Motion { position: 0.1, velocity: 0.01 * f64::from(k % 7), mass: 5.0, exerted: 1.0 };
        let dt_s = first.longest_s().min(1e-3);
        let own = first.advance(&mut state, &taken, &turn, motion, dt_s);
        if k >= 100 {
            second.drive(&mut other, &taken, &turn);
            let effort = second.advance(&mut other, &taken, &turn, motion, dt_s);
            assert_eq!(effort, own, "{} {k}", C::NAME);
            assert!(effort.force.is_finite() && effort.slope >= 0.0, "{} {k}: {effort:?}", C::NAME);
            assert_eq!(second.effect(&other), first.effect(&state), "{} {k}", C::NAME);
            second.sense(&mut other, &taken, &turn).write(&mut again);
        }
        first.sense(&mut state, &taken, &turn).write(&mut one);
        assert!(k < 100 || one == again, "{} {k}: {one:?} {again:?}", C::NAME);
        for value in &one {
            assert!(!matches!(value, Value::Number(number) if !number.is_finite()), "{} {k}", C::NAME);
        }
        assert_eq!(one.len(), C::Outputs::table().len());
        if k == 99 {
            let saved = postcard::to_stdvec(&state).expect("plain data");
            other = postcard::from_bytes(&saved).expect("a state");
            let cut = postcard::from_bytes::<C::State>(&[]);
            assert_eq!(cut.is_ok(), saved.is_empty(), "{}: a cut state is refused", C::NAME);
        }
        assert!(k < 99 || state == other, "{} {k}", C::NAME);
    }
    goes_on_with_others::<C>(&state);
}

/// A component goes on from any state with the least and the greatest value of each parameter that may change.
fn goes_on_with_others<C: Component>(state: &C::State)
where
    SeenBy<C>: Sight,
{
    let table = behaviour::kind::<C>().parameters;
    let known = |key: &&str| table.iter().any(|parameter| parameter.key == **key);
    assert!(C::INITIAL.iter().all(known), "{} begins with a parameter that it does not have", C::NAME);
    let (inputs, modes) = (C::Inputs::table(), C::Failure::table().len());
    for (place, parameter) in table.iter().enumerate().filter(|(_, parameter)| !parameter.initial) {
        let ends = match parameter.form {
            Form::Number { least, most } => vec![Setting::Number(least), Setting::Number(most)],
            Form::Count { least, most } => vec![Setting::Count(least), Setting::Count(most)],
            Form::Flag => vec![Setting::Flag(false), Setting::Flag(true)],
            Form::Choice(words) => words.iter().map(|word| Setting::Choice(word)).collect(),
        };
        for end in ends {
            let mut settings: Vec<Setting> = table.iter().map(|parameter| parameter.preset).collect();
            settings[place] = end;
            let changed = C::Parameters::read(&settings);
            if C::conflict(&changed).is_some() {
                continue;
            }
            let (changed, mut state, mut weather) = (C::new(changed), state.clone(), Weather(Random::new(8)));
            for _ in 0..20 {
                let taken = C::Inputs::read(&weather.inputs(&inputs));
                let turn = weather.turn(modes);
                changed.drive(&mut state, &taken, &turn);
                let mut given = Vec::new();
                changed.sense(&mut state, &taken, &turn).write(&mut given);
                assert_eq!(given.len(), C::Outputs::table().len(), "{} {} {end}", C::NAME, parameter.key);
            }
        }
    }
}

#[test]
fn every_kind_keeps_the_laws() {
    for entry in ENTRIES {
        (entry.laws)();
    }
}

#[test]
fn every_kind_states_itself_well() {
    let words = |text: &str| text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    for (index, kind) in kinds().iter().enumerate() {
        let name = &*kind.name;
        assert!(words(name) && ENTRIES[..index].iter().all(|entry| entry.name != name), "{name}");
        assert!(!kind.summary.is_empty() && !kind.formula.is_empty() && !kind.source.is_empty(), "{name}");
        assert!(!kind.failures.is_empty() && kind.failures.len() <= 32, "{name}");
        let reserved = ["name", "kind", "signal_type"];
        let bindings = kind.coupling.keys().iter().map(|binding| binding.key);
        let mut keys: Vec<&str> = reserved.into_iter().chain(bindings).collect();
        for parameter in &kind.parameters {
            assert!(words(&parameter.key) && !parameter.about.is_empty(), "{name} {}", parameter.key);
            keys.push(&parameter.key);
        }
        let inputs = kind.inputs.iter().map(|signal| &*signal.key);
        let signals: Vec<&str> = inputs.chain(kind.outputs.iter().map(|signal| &*signal.key)).collect();
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
        assert_eq!(Origin::of_library(&kind.name).expect("known").conflict(&settings), None, "{}", kind.name);
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
                unit(&parameter.key).1.is_some() || WITHOUT_UNIT.iter().any(|word| parameter.key.ends_with(word));
            assert!(!matches!(parameter.form, Form::Number { .. }) || named, "{} {}", kind.name, parameter.key);
        }
    }
}
