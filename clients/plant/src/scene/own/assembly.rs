//! An assembly as it is written: what a component of it has, and the parts that it stands for.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use toml::de::{DeArray, DeTable, DeValue};
use toml::{Spanned, Value};

use super::folder::KindFile;
use super::formula;
use crate::file_place::Source;
use crate::scene::VERSION;
use crate::scene::error::SceneFaultKind;
use crate::scene::faults::Faults;
use crate::scene::format::{ComponentTable, SceneFile};
use crate::scene::placed::Placed;
use crate::scene::text;

/// What stands in front of a text that was given from outside, so that it is not a name of a part.
pub(super) const FOREIGN: char = '\u{1}';

/// Keys of a component that is an assembly, beside what the assembly says.
pub(super) const OWN_KEYS: [&str; 7] =
    ["name", "kind", "signal_type", "position_m", "rpy_deg", "step_m", "turn_about_m"];

/// An assembly.
pub(super) struct Assembly {
    pub(super) name: String,
    pub(super) source: Arc<Source>,
    /// The folder of its file, as its files are named from the scene.
    folder: String,
    pub(super) header: Header,
}

/// What an assembly's file says of itself; its parts are read again for each component.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "tables of parts are named here, so that no other table is taken for one")]
pub(in crate::scene) struct Header {
    version: Placed<i64>,
    /// What it is, in one line.
    pub(super) summary: String,
    /// Where it is from.
    pub(super) source: Option<String>,
    #[serde(default)]
    pub(super) parameter: Vec<ParameterTable>,
    #[serde(default)]
    pub(super) binding: Vec<BindingTable>,
    #[serde(default)]
    pub(super) input: Vec<InputTable>,
    #[serde(default)]
    pub(super) output: Vec<OutputTable>,
    #[serde(default)]
    pub(super) failure_mode: Vec<ModeTable>,
    #[serde(default)]
    body: Unread,
    #[serde(default)]
    shape: Unread,
    #[serde(default)]
    urdf: Unread,
    #[serde(default)]
    joint: Unread,
    #[serde(default)]
    fitting: Unread,
    #[serde(default)]
    coupling: Unread,
    #[serde(default)]
    component: Unread,
}

/// Tables of parts, which are read for each component with its parameters.
#[derive(Debug, Default)]
struct Unread;

impl<'de> Deserialize<'de> for Unread {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::<IgnoredAny>::deserialize(deserializer).map(|_| Self)
    }
}

impl JsonSchema for Unread {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Parts".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": { "type": "object" } })
    }
}

/// `[[parameter]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ParameterTable {
    pub(super) key: Placed<String>,
    pub(super) about: String,
    #[schemars(with = "serde_json::Value")]
    pub(super) preset: Placed<Value>,
    pub(super) least: Option<f64>,
    pub(super) most: Option<f64>,
    pub(super) choice: Option<Vec<String>>,
}

/// `[[binding]]`: a body, joint or other thing of the scene that a component is bound to.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct BindingTable {
    pub(super) key: Placed<String>,
    pub(super) about: String,
    /// What it is if a component does not say, as `ground`.
    pub(super) preset: Option<String>,
}

/// `[[input]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct InputTable {
    pub(super) key: Placed<String>,
    pub(super) about: String,
    /// The inputs of parts that take it, as `part.input`.
    pub(super) to: Vec<Placed<String>>,
    #[schemars(with = "Option<serde_json::Value>")]
    pub(super) preset: Option<Placed<Value>>,
}

/// `[[output]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct OutputTable {
    pub(super) key: Placed<String>,
    pub(super) about: String,
    /// The output of a part, as `part.output`.
    pub(super) from: Placed<String>,
}

/// `[[failure_mode]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ModeTable {
    pub(super) mode: Placed<String>,
    pub(super) about: String,
    /// The mode of a part, as `part.mode`.
    pub(super) of: Placed<String>,
}

/// A parameter or binding with its value.
pub(super) struct Given<'a> {
    pub(super) key: &'a str,
    pub(super) value: Value,
    /// Where the component says so; none for a preset.
    pub(super) at: Option<Range<usize>>,
}

/// What stands in the place of a formula.
struct Computed {
    /// As TOML.
    text: String,
    /// Where it was written, if not in the assembly.
    at: Option<Range<usize>>,
}

/// Tables of the header, which the parts are read without.
const HEADER: [&str; 7] = ["summary", "source", "parameter", "binding", "input", "output", "failure_mode"];

impl Assembly {
    /// The assembly `name` out of its file; none if something is wrong with it.
    pub(super) fn read(
        name: &str,
        file: &KindFile,
        bytes: Vec<u8>,
        kind: &Placed<String>,
        faults: &mut Faults<'_>,
    ) -> Option<Self> {
        let Ok(text) = String::from_utf8(bytes) else {
            let cause = format!("{} is not UTF-8", file.named);
            faults.add(kind.span(), SceneFaultKind::OwnKind { kind: name.to_owned(), cause });
            return None;
        };
        let source = Arc::new(Source { file: file.named.clone(), text: text.into() });
        let base = faults.attach(name, &source, kind.span());
        let document = DeTable::parse(&source.text);
        let header = document.and_then(|document| Header::deserialize(toml::Deserializer::from(document)));
        let header = match header {
            Ok(header) => header,
            Err(error) => {
                faults.add_form(base, &error);
                return None;
            }
        };
        let folder = file.named.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
        let known = header.is_right(base, faults);
        known.then(|| Self { name: name.to_owned(), source, folder, header })
    }

    /// The values of the parameters and bindings of a component; none if one is wrong.
    pub(super) fn values(&self, table: &ComponentTable, faults: &mut Faults<'_>) -> Option<Vec<Given<'_>>> {
        let mut right = true;
        let mut values = Vec::new();
        for parameter in &self.header.parameter {
            let key = text(&parameter.key);
            let written = table.get(key);
            if let Some(value) = written.filter(|value| !parameter.takes(value.get_ref())) {
                let (wanted, value_text) = (parameter.in_words(), value.get_ref().to_string());
                let key = key.to_owned().into();
                faults.add(value.span(), SceneFaultKind::Number { key, wanted, value: value_text });
                right = false;
            }
            let value = written.unwrap_or(&parameter.preset).get_ref().clone();
            values.push(Given { key, value, at: written.map(Placed::span) });
        }
        for BindingTable { key, preset, .. } in &self.header.binding {
            let foreign = |name: &str| Value::String(format!("{FOREIGN}{name}"));
            match (table.get(text(key)).map(|value| (value, value.get_ref().as_str())), preset) {
                (Some((value, Some(name))), _) => {
                    values.push(Given { key: text(key), value: foreign(name), at: Some(value.span()) });
                }
                (Some((value, None)), _) => {
                    faults.add(value.span(), SceneFaultKind::Text { key: text(key).to_owned(), wanted: "a name" });
                    right = false;
                }
                (None, Some(preset)) => {
                    values.push(Given { key: text(key), value: foreign(preset), at: None });
                }
                // a part that names it says so
                (None, None) => {}
            }
        }
        right.then_some(values)
    }

    /// The parts with these values in the place of formulas; places in them begin at `base`.
    pub(super) fn parts(&self, values: &[Given<'_>], base: usize, faults: &mut Faults<'_>) -> Option<SceneFile> {
        // the header was read from the same text
        let mut document = DeTable::parse(&self.source.text).ok()?.into_inner();
        for key in HEADER {
            document.remove(key);
        }
        let known: Vec<(&str, Value)> = values.iter().map(|given| (given.key, given.value.clone())).collect();
        let mut results = BTreeMap::new();
        let mut right = true;
        let whole = Spanned::new(0..0, DeValue::Table(document));
        for (span, formula) in formulas(&whole) {
            match formula::value(&formula, &known) {
                Ok(value) => {
                    // what a component says as it stands is at fault itself
                    let given = values.iter().find(|given| given.key == formula.trim());
                    let at = given.and_then(|given| given.at.clone());
                    results.insert(span.start, Computed { text: value.to_string(), at });
                }
                Err(error) => {
                    let known = self.header.binding.iter().find(|binding| text(&binding.key) == formula.trim());
                    let (cause, hint) = match known {
                        Some(_) => (format!("the component does not say its `{}`", formula.trim()), None),
                        None => (format!("`={formula}`: {}", error.cause), error.hint),
                    };
                    let kind = SceneFaultKind::OwnKind { kind: self.name.clone(), cause };
                    faults.add_hinted(base + span.start..base + span.end, kind, hint);
                    right = false;
                }
            }
        }
        let DeValue::Table(document) = rebuilt(whole, base, &results).into_inner() else { return None };
        if !right {
            return None;
        }
        let document = Spanned::new(base..base + self.source.text.len(), document);
        match SceneFile::deserialize(toml::Deserializer::from(document)) {
            Ok(parts) => Some(self.beside(parts)),
            Err(error) => {
                faults.add_form(0, &error);
                None
            }
        }
    }

    /// The parts with the files that they name as the scene would name them.
    fn beside(&self, mut parts: SceneFile) -> SceneFile {
        let named = |file: &mut Placed<String>| *file.get_mut() = format!("{}/{}", self.folder, file.get_ref());
        parts.body.iter_mut().filter_map(|body| body.get_mut().mesh.as_mut()).for_each(named);
        parts.shape.iter_mut().filter_map(|shape| shape.get_mut().mesh.as_mut()).for_each(named);
        for robot in &mut parts.urdf {
            named(&mut robot.get_mut().file);
            robot.get_mut().packages.iter_mut().flat_map(BTreeMap::values_mut).for_each(named);
        }
        parts
    }
}

impl Header {
    /// Whether keys are words, none of them twice, and presets are allowed.
    fn is_right(&self, base: usize, faults: &mut Faults<'_>) -> bool {
        let mut right = true;
        let mut wrong = |at: &Placed<String>, cause: String| {
            let span = at.span();
            let kind = SceneFaultKind::Form(cause);
            faults.add(base + span.start..base + span.end, kind);
            right = false;
        };
        if *self.version.get_ref() != VERSION {
            let at = Placed::new(self.version.span(), String::new());
            wrong(
                &at,
                format!("version {} of assemblies is not known; this program reads {VERSION}", self.version.get_ref()),
            );
        }
        let inputs = || self.input.iter().map(|one| &one.key);
        let given = self.parameter.iter().map(|one| &one.key).chain(self.binding.iter().map(|one| &one.key));
        let own = OWN_KEYS.iter().copied();
        // what a component has as keys; as signals; as modes
        let groups: [(Vec<&Placed<String>>, Vec<&str>); 3] = [
            (given.chain(inputs()).collect(), own.collect()),
            (inputs().chain(self.output.iter().map(|one| &one.key)).collect(), Vec::new()),
            (self.failure_mode.iter().map(|one| &one.mode).collect(), Vec::new()),
        ];
        for (keys, mut seen) in groups {
            for key in keys {
                let name = text(key);
                let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic())
                    && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
                if !is_word {
                    wrong(key, format!("`{name}` is not a word of letters, digits and `_`"));
                } else if seen.contains(&name) {
                    wrong(key, format!("`{name}` is there twice, or is a key that every component has"));
                }
                seen.push(name);
            }
        }
        for parameter in self.parameter.iter().filter(|parameter| !parameter.takes(parameter.preset.get_ref())) {
            let at = Placed::new(parameter.preset.span(), String::new());
            wrong(&at, format!("the preset of `{}` must be {}", text(&parameter.key), parameter.in_words()));
        }
        right
    }
}

impl ParameterTable {
    /// Whether it may have this value: of the sort of its preset, within its bounds.
    fn takes(&self, value: &Value) -> bool {
        let within = |number: f64| {
            number.is_finite()
                && self.least.is_none_or(|least| number >= least)
                && self.most.is_none_or(|most| number <= most)
        };
        match (self.preset.get_ref(), value) {
            (Value::Integer(_) | Value::Float(_), Value::Integer(whole)) => within(*whole as f64),
            (Value::Float(_), Value::Float(number)) => within(*number),
            (Value::Boolean(_), Value::Boolean(_)) => true,
            (Value::String(_), Value::String(word)) => self.choice.as_ref().is_none_or(|words| words.contains(word)),
            _ => false,
        }
    }

    /// What it may be, in words.
    pub(super) fn in_words(&self) -> String {
        let sort = match self.preset.get_ref() {
            Value::Integer(_) => "a whole number",
            Value::Float(_) => "a number",
            Value::Boolean(_) => return "`true` or `false`".to_owned(),
            Value::String(_) => {
                return match &self.choice {
                    Some(words) => format!("one of \"{}\"", words.join("\", \"")),
                    None => "a text".to_owned(),
                };
            }
            Value::Datetime(_) | Value::Array(_) | Value::Table(_) => {
                return "a number, a text or a truth value".to_owned();
            }
        };
        match (self.least, self.most) {
            (Some(least), Some(most)) => format!("{sort} from {least} to {most}"),
            (Some(least), None) => format!("{sort} from {least}"),
            (None, Some(most)) => format!("{sort} up to {most}"),
            (None, None) => sort.to_owned(),
        }
    }
}

/// Every text that begins with `=`, without that, and where it stands.
fn formulas(value: &Spanned<DeValue<'_>>) -> Vec<(Range<usize>, String)> {
    match value.get_ref() {
        DeValue::String(text) => {
            text.strip_prefix('=').map(|formula| (value.span(), formula.to_owned())).into_iter().collect()
        }
        DeValue::Array(list) => list.iter().flat_map(formulas).collect(),
        DeValue::Table(table) => table.iter().flat_map(|(_, value)| formulas(value)).collect(),
        DeValue::Integer(_) | DeValue::Float(_) | DeValue::Boolean(_) | DeValue::Datetime(_) => Vec::new(),
    }
}

/// The value with `results`, by the place of their formulas, and all of it at places behind `base`.
fn rebuilt<'i>(
    value: Spanned<DeValue<'i>>,
    base: usize,
    results: &'i BTreeMap<usize, Computed>,
) -> Spanned<DeValue<'i>> {
    let span = value.span();
    let shifted = base + span.start..base + span.end;
    if let (DeValue::String(_), Some(Computed { text, at })) = (value.get_ref(), results.get(&span.start))
        && let Ok(computed) = DeValue::parse(text)
    {
        return Spanned::new(at.clone().unwrap_or(shifted), computed.into_inner());
    }
    let inner = match value.into_inner() {
        DeValue::Array(list) => {
            DeValue::Array(list.into_iter().map(|value| rebuilt(value, base, results)).collect::<DeArray<'_>>())
        }
        DeValue::Table(table) => {
            let entries = table.into_iter().map(|(key, value)| {
                let at = key.span();
                (Spanned::new(base + at.start..base + at.end, key.into_inner()), rebuilt(value, base, results))
            });
            DeValue::Table(entries.collect())
        }
        plain => plain,
    };
    Spanned::new(shifted, inner)
}
