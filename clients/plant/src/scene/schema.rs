//! The JSON schema of a scene, for editors: made from the structs that it is read into and from the
//! library's kinds.

use onescan_base::byte_line::{DEFAULT_WINDOW, WINDOW_MAX};
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use super::VERSION;
use super::components::{WINDOW, has_lines};
use super::format::SHOWN_AT;
use super::format::SceneFile;
use super::own::Header;
use crate::component::kind::{Form, Frames, Kind, Parameter, Setting, Signal, Values, unit};
use crate::component::library::kinds;
use crate::coupling::{BindingKey, Names};

/// The schema of a scene (JSON Schema 2020-12).
pub fn schema() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut top = settings.into_generator().into_root_schema_for::<SceneFile>().to_value();
    without_null(&mut top);
    top["title"] = json!("onescan plant");
    top["properties"]["version"] = json!({ "const": VERSION });
    let mut all: Vec<_> = kinds().iter().map(component).collect();
    all.push(own_component());
    top["properties"]["component"] = json!({ "type": "array", "items": { "oneOf": all } });
    top
}

/// The table of a component of a kind of the user's own: its file says what it has.
fn own_component() -> Value {
    let library: Vec<_> = kinds().iter().map(|kind| &kind.name).collect();
    let kind = json!({ "type": TEXT, "not": { "enum": library } });
    json!({
        "type": "object",
        "description": "of a kind of the user's own, in a folder of `libraries`",
        "required": ["name", "kind"],
        "properties": { "name": text(), "kind": kind, "signal_type": { "enum": ["REAL", "LREAL"] }, SHOWN_AT: shown_at() },
    })
}

/// The schema of an assembly, a kind of component of the user's own (JSON Schema 2020-12).
pub fn assembly() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut top = settings.into_generator().into_root_schema_for::<Header>().to_value();
    without_null(&mut top);
    top["title"] = json!("onescan assembly");
    top["description"] = json!("a kind of component, made of parts of a scene");
    top["properties"]["version"] = json!({ "const": VERSION });
    top
}

/// Takes out what TOML does not have: `null` in the place of an absent key, the preset of a list that
/// is absent, and the width of a number.
fn without_null(schema: &mut Value) {
    match schema {
        Value::Object(fields) => {
            // a text: what a scene itself may call so has a schema of its own
            fields.retain(|key, value| !(matches!(key.as_str(), "format" | "title") && value.is_string()));
            if let Some(Value::Array(types)) = fields.get_mut("type") {
                types.retain(|ty| ty != "null");
                if let [one] = &types[..] {
                    let one = one.clone();
                    fields.insert("type".to_owned(), one);
                }
            }
            for key in ["enum", "anyOf", "oneOf"] {
                if let Some(Value::Array(choices)) = fields.get_mut(key) {
                    choices.retain(|choice| !choice.is_null() && choice["type"] != "null");
                }
            }
            fields.values_mut().for_each(without_null);
        }
        Value::Array(list) => list.iter_mut().for_each(without_null),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

const NUMBER: &str = "number";
const TEXT: &str = "string";
const FLAG: &str = "boolean";
const WHOLE: &str = "integer";

fn text() -> Value {
    json!({ "type": TEXT })
}

/// A point of the world.
fn point() -> Value {
    json!({ "type": "array", "items": { "type": NUMBER }, "minItems": 3, "maxItems": 3 })
}

fn shown_at() -> Value {
    described(point(), "where pictures show it, if nothing that it is bound to says so")
}

/// The table of a component of a kind.
fn component(kind: &Kind) -> Value {
    let mut properties = Map::new();
    properties.insert("name".to_owned(), text());
    properties.insert("kind".to_owned(), json!({ "const": kind.name, "description": kind.summary }));
    properties.insert("signal_type".to_owned(), json!({ "enum": ["REAL", "LREAL"] }));
    properties.insert(SHOWN_AT.to_owned(), shown_at());
    for (key, signals) in kind.frames.by_key().into_iter().filter(|(_, signals)| !signals.is_empty()) {
        let members: Vec<_> = signals.iter().map(|signal| Frames::member(signal)).collect();
        let description = format!("a structure of signals with the members {}", members.join(", "));
        properties.insert(key.to_owned(), json!({ "type": TEXT, "description": description }));
    }
    let mut required = vec!["name", "kind"];
    for BindingKey { key, about, names, needed } in kind.coupling.keys() {
        let ty = match names {
            Names::Bodies { .. } => json!({ "type": "array", "items": { "type": TEXT } }),
            Names::Point | Names::Direction | Names::Along => point(),
            Names::DrivenJoint(_)
            | Names::DrivenBeside(_)
            | Names::MeasuredJoint
            | Names::Belt
            | Names::Carrier
            | Names::Body
            | Names::TouchedBody
            | Names::ShapeOfBody => text(),
        };
        properties.insert((*key).to_owned(), described(ty, about));
        required.extend(needed.then_some(*key));
    }
    for parameter in &kind.parameters {
        properties.insert(parameter.key.to_string(), setting(parameter));
    }
    for input in &kind.inputs {
        properties.extend(constant(input).map(|constant| (kind.constant_key(&input.key), constant)));
        properties.insert(format!("{}_signal", input.key), described(text(), &input.about));
        if input.values == Values::Bytes {
            continue;
        }
        let wire = json!({ "type": TEXT, "pattern": r"^.+\..+$" });
        properties.insert(format!("{}_from", input.key), described(wire, &input.about));
    }
    for output in &kind.outputs {
        properties.insert(format!("{}_signal", output.key), described(text(), &output.about));
    }
    if has_lines(kind) {
        let window = json!({ "type": WHOLE, "minimum": 1, "maximum": WINDOW_MAX, "default": DEFAULT_WINDOW });
        properties.insert(WINDOW.to_owned(), described(window, "bytes in the window of each line of bytes"));
    }
    json!({ "type": "object", "additionalProperties": false, "required": required, "properties": properties })
}

fn setting(parameter: &Parameter) -> Value {
    let schema = match &parameter.form {
        Form::Number { least, most } => json!({ "type": NUMBER, "minimum": least, "maximum": most }),
        Form::Count { least, most } => json!({ "type": WHOLE, "minimum": least, "maximum": most }),
        Form::Flag => json!({ "type": FLAG }),
        Form::Choice(words) => json!({ "enum": words }),
    };
    let about = match unit(&parameter.key).1 {
        Some(unit) => format!("{}, {unit}", parameter.about),
        None => parameter.about.clone(),
    };
    let mut schema = described(schema, &about);
    schema["default"] = plain(parameter.preset);
    schema
}

fn constant(input: &Signal) -> Option<Value> {
    let ty = match input.values {
        Values::Bool => FLAG,
        Values::Number => NUMBER,
        Values::Whole => WHOLE,
        Values::Bytes => return None,
    };
    let mut schema = described(json!({ "type": ty }), &input.about);
    if let Some(preset) = input.preset {
        schema["default"] = plain(preset);
    }
    Some(schema)
}

fn plain(setting: Setting) -> Value {
    match setting {
        Setting::Number(number) => json!(number),
        Setting::Count(whole) => json!(whole),
        Setting::Flag(flag) => json!(flag),
        Setting::Choice(word) => json!(word),
    }
}

fn described(mut schema: Value, about: &str) -> Value {
    schema["description"] = json!(about);
    schema
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_published::is_published;

    #[test]
    fn the_published_schema_is_that_of_the_tables() {
        for (file, schema) in [("plant", schema()), ("kinds", assembly())] {
            let made = format!("{}\n", serde_json::to_string_pretty(&schema).expect("JSON"));
            is_published(&format!("docs/schemas/{file}.schema.json"), &made);
        }
    }
}
