//! Whose state it is: what a plant is made of, kept with each state that it saves, so that a refusal
//! can name what differs.
//!
//! Failures are not part of it. A state of the healthy plant restores into the same plant with any
//! `[[failure]]`, and the reverse.

use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::component::instance::{Component, Wire};
use super::component::kind::Kind;
use super::scene::Scene;

/// What a plant's state depends on, beside its inputs, operations and failures.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Identity {
    name: String,
    period_ns: u64,
    seed: u64,
    /// The scene as JSON, in which every value has a key: settings by parameter, wires by signal.
    scene: String,
}

impl Identity {
    /// # Errors
    /// A scene that is not plain data, which no checked scene is.
    pub(super) fn new(scene: &Scene, name: &ClientName, period: TimeSpan) -> Result<Self, serde_json::Error> {
        let scene = serde_json::to_string(&tree(scene)?)?;
        Ok(Self { name: name.to_string(), period_ns: period.as_nanos(), seed: 0, scene })
    }

    pub(super) fn seed(&mut self, seed: u64) {
        self.seed = seed;
    }

    /// What first differs from the identity `saved` with a state, in words; none if nothing does.
    pub(super) fn difference(&self, saved: &Self) -> Option<String> {
        let another = |what: &str, saved: String, own: String| {
            Some(format!("it belongs to a plant with another {what}, {saved} in the state and {own} here"))
        };
        let Self { name, period_ns, seed, scene } = self;
        if *name != saved.name {
            return another("name", format!("`{}`", saved.name), format!("`{name}`"));
        }
        if *period_ns != saved.period_ns {
            return another("period", format!("{} ns", saved.period_ns), format!("{period_ns} ns"));
        }
        if *seed != saved.seed {
            return another("seed", saved.seed.to_string(), seed.to_string());
        }
        if *scene == saved.scene {
            return None;
        }
        let trees = [&saved.scene, scene].map(|scene| serde_json::from_str(scene).ok());
        let found = match &trees {
            [Some(saved), Some(own)] => scene_difference(saved, own),
            // the state's own digest holds, so this is a form that another program wrote
            _ => None,
        };
        Some(match found {
            Some(found) => format!("it belongs to a plant with another scene: {found}"),
            None => "it belongs to a plant with another scene".to_owned(),
        })
    }
}

/// The scene as a tree of keys and values.
fn tree(scene: &Scene) -> Result<Value, serde_json::Error> {
    let mut tree = serde_json::to_value(scene)?;
    if let Some(components) = tree.get_mut("components").and_then(Value::as_array_mut) {
        for (described, component) in scene.components.iter().zip(components) {
            name_values(described, component)?;
        }
    }
    for sort in ["bodies", "shapes"] {
        for thing in tree.get_mut(sort).and_then(Value::as_array_mut).into_iter().flatten() {
            shorten_meshes(&mut thing["shape"]);
        }
    }
    Ok(tree)
}

/// Gives each setting and wire of a component its key, and leaves failures out.
fn name_values(described: &Component, tree: &mut Value) -> Result<(), serde_json::Error> {
    let Some(fields) = tree.as_object_mut() else { return Ok(()) };
    fields.remove("failures");
    let Kind { parameters, inputs, outputs, .. } = &*described.kind;
    let keyed =
        |keys: Vec<String>, values: Vec<Value>| Value::Object(keys.into_iter().zip(values).collect::<Map<_, _>>());
    let settings = described.settings.iter().map(serde_json::to_value).collect::<Result<Vec<_>, _>>()?;
    let settings = settings.into_iter().map(bare).collect();
    let keys = parameters.iter().map(|parameter| parameter.key.to_string()).collect();
    fields.insert("settings".to_owned(), keyed(keys, settings));
    let wire = |wire: &Wire| match wire {
        Wire::Constant(setting) => serde_json::to_value(setting).map(bare),
        Wire::Open | Wire::Signal(_) | Wire::Output { .. } => serde_json::to_value(wire),
    };
    let wires = described.inputs.iter().map(wire).collect::<Result<_, _>>()?;
    fields.insert("inputs".to_owned(), keyed(inputs.iter().map(|input| input.key.to_string()).collect(), wires));
    let wires = described.outputs.iter().map(serde_json::to_value).collect::<Result<_, _>>()?;
    fields.insert("outputs".to_owned(), keyed(outputs.iter().map(|output| output.key.to_string()).collect(), wires));
    Ok(())
}

/// A value without the name of its variant.
fn bare(tagged: Value) -> Value {
    match tagged {
        Value::Object(fields) if fields.len() == 1 => fields.into_iter().next().map_or(Value::Null, |(_, value)| value),
        other => other,
    }
}

/// Puts a digest in the place of a mesh's corners and triangles, of which there may be a million.
fn shorten_meshes(shape: &mut Value) {
    for fields in shape.as_object_mut().into_iter().flat_map(Map::values_mut).filter_map(Value::as_object_mut) {
        for key in ["corners_m", "triangles"] {
            if let Some(list) = fields.get_mut(key) {
                *list = Value::String(blake3::hash(list.to_string().as_bytes()).to_hex().to_string());
            }
        }
    }
}

/// The parts of a scene that are lists of named things, and what one of them is called. Signals come
/// last: they follow from the others.
const LISTS: &[(&str, &str)] = &[
    ("bodies", "body"),
    ("shapes", "shape"),
    ("joints", "joint"),
    ("axes", "axis"),
    ("sensors", "sensor"),
    ("components", "component"),
    ("conditions", "signal"),
    ("reads", "signal"),
    ("writes", "signal"),
];

fn scene_difference(saved: &Value, own: &Value) -> Option<String> {
    let (saved, own) = (saved.as_object()?, own.as_object()?);
    let lists = LISTS.iter().find_map(|(list, thing)| {
        let things = |tree: &Map<String, Value>| tree.get(*list).and_then(Value::as_array).cloned();
        list_difference(thing, &things(saved)?, &things(own)?)
    });
    let whole = || {
        let keys = own.keys().filter(|key| LISTS.iter().all(|(list, _)| list != key));
        let differing = keys.into_iter().find_map(|key| value_difference(key, saved.get(key)?, &own[key]));
        differing.map(|found| found.in_words(""))
    };
    whole().or(lists)
}

fn list_difference(thing: &str, saved: &[Value], own: &[Value]) -> Option<String> {
    let name = |value: &Value| ["name", "signal"].iter().find_map(|key| value[*key].as_str().map(str::to_owned));
    let names = |list: &[Value]| list.iter().filter_map(name).collect::<Vec<_>>();
    let (saved_names, own_names) = (names(saved), names(own));
    if let Some(lost) = saved_names.iter().find(|name| !own_names.contains(name)) {
        return Some(format!("{thing} `{lost}` is in the state and not here"));
    }
    if let Some(new) = own_names.iter().find(|name| !saved_names.contains(name)) {
        return Some(format!("{thing} `{new}` is here and not in the state"));
    }
    if saved_names != own_names {
        return Some(format!("another order, from {thing} `{}` on", first_differing(&saved_names, &own_names)?));
    }
    saved.iter().zip(own).zip(own_names).find_map(|((saved, own), name)| {
        let found = value_difference(thing, saved, own)?;
        Some(found.in_words(&format!(" at {thing} `{name}`")))
    })
}

fn first_differing<'n>(saved: &[String], own: &'n [String]) -> Option<&'n str> {
    saved.iter().zip(own).find(|(saved, own)| saved != own).map(|(_, own)| own.as_str())
}

/// A value that differs, with the innermost key it stands behind.
struct Differing<'v> {
    key: &'v str,
    saved: &'v Value,
    own: &'v Value,
}

impl Differing<'_> {
    fn in_words(&self, place: &str) -> String {
        format!("another `{}`{place}, {} in the state and {} here", self.key, self.saved, self.own)
    }
}

fn value_difference<'v>(key: &'v str, saved: &'v Value, own: &'v Value) -> Option<Differing<'v>> {
    if saved == own {
        return None;
    }
    match (saved, own) {
        (Value::Object(before), Value::Object(now)) if before.keys().eq(now.keys()) => {
            // the name of a variant, as of a shape's form, is not a key of a scene
            let inner = |inner: &'v str| if inner.starts_with(char::is_uppercase) { key } else { inner };
            now.iter().find_map(|(key, own)| value_difference(inner(key), before.get(key)?, own))
        }
        _ => Some(Differing { key, saved, own }),
    }
}
