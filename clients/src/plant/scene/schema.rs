//! The JSON schema of a scene, for editors: made from the tables that also check a scene.

use serde_json::{Map, Value, json};

use super::VERSION;
use crate::plant::component::kind::{Form, Kind, Parameter, Setting, unit};
use crate::plant::component::library::kinds;
use crate::plant::coupling::{BindingKey, Names};

const NUMBER: &str = "number";
const TEXT: &str = "string";
const NUMBERS: &str = "three numbers";
const FLAG: &str = "boolean";
const WHOLE: &str = "integer";
const TEXTS: &str = "names";
const PAIR: &str = "two numbers";
const TENSOR: &str = "six numbers";

/// Key and type of a fixed table; `!` marks what must be there.
type Table = &'static [(&'static str, &'static str)];

const TOP: Table = &[
    ("version!", WHOLE),
    ("gravity_m_s2", NUMBERS),
    ("extent_m", NUMBER),
    ("substeps", WHOLE),
    ("solver_iterations", WHOLE),
];

const BODY: Table = &[
    ("name!", TEXT),
    ("kind!", "fixed|dynamic|kinematic"),
    ("shape", "box|sphere|cylinder|capsule|mesh"),
    ("size_m", NUMBERS),
    ("radius_m", NUMBER),
    ("length_m", NUMBER),
    ("mesh", TEXT),
    ("unit_m", NUMBER),
    ("hull", FLAG),
    ("position_m", NUMBERS),
    ("rpy_deg", NUMBERS),
    ("velocity_m_s", NUMBERS),
    ("mass_kg", NUMBER),
    ("density_kg_m3", NUMBER),
    ("centre_m", NUMBERS),
    ("inertia_kg_m2", TENSOR),
    ("friction", NUMBER),
    ("restitution", NUMBER),
    ("collides", FLAG),
    ("group", TEXT),
    ("turn_about_m", NUMBERS),
    ("step_m", NUMBERS),
];

const SHAPE: Table = &[
    ("name!", TEXT),
    ("body!", TEXT),
    ("shape!", "box|sphere|cylinder|capsule|mesh"),
    ("size_m", NUMBERS),
    ("radius_m", NUMBER),
    ("length_m", NUMBER),
    ("mesh", TEXT),
    ("unit_m", NUMBER),
    ("hull", FLAG),
    ("position_m", NUMBERS),
    ("rpy_deg", NUMBERS),
    ("mass_kg", NUMBER),
    ("friction", NUMBER),
    ("restitution", NUMBER),
    ("collides", FLAG),
    ("turn_about_m", NUMBERS),
    ("step_m", NUMBERS),
];

const URDF: Table = &[
    ("name!", TEXT),
    ("file!", TEXT),
    ("position_m", NUMBERS),
    ("rpy_deg", NUMBERS),
    ("fixed", FLAG),
    ("collides", FLAG),
    ("friction", NUMBER),
];

const JOINT: Table = &[
    ("name!", TEXT),
    ("kind!", "prismatic|revolute|fixed|slot|ball"),
    ("parent!", TEXT),
    ("child!", TEXT),
    ("anchor_m", NUMBERS),
    ("axis", NUMBERS),
    ("slide", NUMBERS),
    ("initial_m", NUMBER),
    ("initial_rad", NUMBER),
    ("lower_m", NUMBER),
    ("lower_rad", NUMBER),
    ("upper_m", NUMBER),
    ("upper_rad", NUMBER),
    ("contacts", FLAG),
];

const AXIS: Table = &[
    ("name!", TEXT),
    ("joint", TEXT),
    ("belt", TEXT),
    ("direction", NUMBERS),
    ("drive!", "bidirectional|velocity|position"),
    ("forward_signal", TEXT),
    ("reverse_signal", TEXT),
    ("command_signal", TEXT),
    ("speed_m_s", NUMBER),
    ("speed_rad_s", NUMBER),
    ("acceleration_m_s2", NUMBER),
    ("acceleration_rad_s2", NUMBER),
    ("force_max_n", NUMBER),
    ("torque_max_nm", NUMBER),
    ("position_signal", TEXT),
    ("velocity_signal", TEXT),
    ("signal_type", "REAL|LREAL"),
];

const SENSOR: Table = &[
    ("name!", TEXT),
    ("kind!", "end_position|proximity"),
    ("signal!", TEXT),
    ("joint", TEXT),
    ("from_m", NUMBER),
    ("from_rad", NUMBER),
    ("to_m", NUMBER),
    ("to_rad", NUMBER),
    ("hysteresis_m", NUMBER),
    ("hysteresis_rad", NUMBER),
    ("body", TEXT),
    ("point_m", NUMBERS),
    ("direction", NUMBERS),
    ("range_m", NUMBER),
    ("targets", TEXTS),
];

const FAILURE: Table =
    &[("component!", TEXT), ("mode!", TEXT), ("signal", TEXT), ("from_s", NUMBER), ("until_s", NUMBER)];

const SIGNAL: Table = &[
    ("name!", TEXT),
    ("type", TEXT),
    ("range", PAIR),
    ("raw", PAIR),
    ("delay_s", NUMBER),
    ("jitter_s", NUMBER),
    ("sample_s", NUMBER),
    ("quantum", NUMBER),
    ("noise_mean", NUMBER),
    ("noise_sigma", NUMBER),
];

/// The fixed tables by their names in a scene.
const TABLES: &[(&str, Table)] = &[
    ("body", BODY),
    ("shape", SHAPE),
    ("urdf", URDF),
    ("joint", JOINT),
    ("axis", AXIS),
    ("sensor", SENSOR),
    ("failure", FAILURE),
    ("signal", SIGNAL),
];

/// The schema of a scene (JSON Schema 2020-12).
pub fn schema() -> Value {
    let mut top = object(TOP);
    top["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    top["title"] = json!("onescan plant");
    top["properties"]["version"] = json!({ "const": VERSION });
    for (name, table) in TABLES {
        top["properties"][*name] = json!({ "type": "array", "items": object(table) });
    }
    let kinds: Vec<_> = kinds().iter().map(component).collect();
    top["properties"]["component"] = json!({ "type": "array", "items": { "oneOf": kinds } });
    top
}

fn of(ty: &str) -> Value {
    let numbers =
        |count: usize| json!({ "type": "array", "items": { "type": NUMBER }, "minItems": count, "maxItems": count });
    match ty {
        NUMBER | TEXT | FLAG | WHOLE => json!({ "type": ty }),
        NUMBERS => numbers(3),
        PAIR => numbers(2),
        TENSOR => numbers(6),
        TEXTS => json!({ "type": "array", "items": { "type": TEXT } }),
        words => json!({ "enum": words.split('|').collect::<Vec<_>>() }),
    }
}

fn object(table: Table) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    for (key, ty) in table {
        let name = key.trim_end_matches('!');
        properties.insert(name.to_owned(), of(ty));
        if name != *key {
            required.push(name);
        }
    }
    json!({ "type": "object", "additionalProperties": false, "required": required, "properties": properties })
}

/// The table of a component of a kind.
fn component(kind: &Kind) -> Value {
    let mut properties = Map::new();
    properties.insert("name".to_owned(), json!({ "type": TEXT }));
    properties.insert("kind".to_owned(), json!({ "const": kind.name, "description": kind.summary }));
    properties.insert("signal_type".to_owned(), of("REAL|LREAL"));
    let mut required = vec!["name", "kind"];
    for BindingKey { key, about, names, needed } in kind.coupling.keys() {
        let ty = match names {
            Names::Bodies { .. } => TEXTS,
            Names::Point | Names::Direction => NUMBERS,
            Names::DrivenJoint(_)
            | Names::MeasuredJoint
            | Names::Belt
            | Names::Carrier
            | Names::Body
            | Names::TouchedBody
            | Names::ShapeOfBody => TEXT,
        };
        properties.insert((*key).to_owned(), described(of(ty), about));
        required.extend(needed.then_some(*key));
    }
    for parameter in &kind.parameters {
        properties.insert(parameter.key.to_owned(), setting(parameter));
    }
    for input in &kind.inputs {
        properties.insert(format!("{}_signal", input.key), described(of(TEXT), &input.about));
        let wire = json!({ "type": TEXT, "pattern": r"^.+\..+$" });
        properties.insert(format!("{}_from", input.key), described(wire, &input.about));
    }
    for output in &kind.outputs {
        properties.insert(format!("{}_signal", output.key), described(of(TEXT), &output.about));
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
    let about = match unit(parameter.key).1 {
        Some(unit) => format!("{}, {unit}", parameter.about),
        None => parameter.about.clone(),
    };
    let mut schema = described(schema, &about);
    schema["default"] = match parameter.preset {
        Setting::Number(number) => json!(number),
        Setting::Count(whole) => json!(whole),
        Setting::Flag(flag) => json!(flag),
        Setting::Choice(word) => json!(word),
    };
    schema
}

fn described(mut schema: Value, about: &str) -> Value {
    schema["description"] = json!(about);
    schema
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_schema_is_that_of_the_tables() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/schemas/plant.schema.json");
        let made = format!("{}\n", serde_json::to_string_pretty(&schema()).expect("JSON"));
        if std::env::var_os("UPDATE_DOCS").is_some() {
            std::fs::write(path, &made).expect("written");
        }
        let published = std::fs::read_to_string(path).expect("published");
        assert!(published == made, "run with UPDATE_DOCS=1 and read the difference");
    }

    /// The keys that the reader itself names when it meets one that it does not know.
    fn keys_of_the_reader(scene: &str) -> Vec<String> {
        let message = toml::from_str::<super::super::format::SceneFile>(scene).expect_err("an unknown key").to_string();
        let line = message.lines().find(|line| line.contains("expected one of")).expect("the keys").to_owned();
        let mut keys: Vec<_> = line.split('`').skip(1).step_by(2).skip(1).map(str::to_owned).collect();
        keys.sort();
        keys
    }

    #[test]
    fn every_fixed_table_has_the_keys_that_the_reader_takes() {
        for (name, table) in TABLES {
            let mut keys: Vec<_> = table.iter().map(|(key, _)| key.trim_end_matches('!').to_owned()).collect();
            keys.sort();
            assert_eq!(keys, keys_of_the_reader(&format!("version = 1\n[[{name}]]\nno_such_key = 1\n")), "{name}");
        }
        let mut keys: Vec<_> = TOP.iter().map(|(key, _)| key.trim_end_matches('!').to_owned()).collect();
        keys.extend(TABLES.iter().map(|(name, _)| (*name).to_owned()));
        keys.push("component".to_owned());
        keys.sort();
        assert_eq!(keys, keys_of_the_reader("no_such_key = 1\n"));
    }
}
