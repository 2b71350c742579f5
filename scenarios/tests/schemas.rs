//! The schemas of `scenario.toml` and `cases.toml` take every file of the repository, and refuse what the reader does.

use std::path::{Path, PathBuf};

use onescan_scenario::schema;
use regex::Regex;
use serde_json::{Map, Value};

/// Keywords that inform a reader and refuse nothing.
const ANNOTATIONS: &[&str] = &["$schema", "title", "description", "default"];

/// What of `value` does not keep to `schema`. It knows the keywords that our schemas use, and no others.
fn faults(schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let Value::Object(schema) = schema else {
        assert_eq!(schema, &Value::Bool(true), "{at}: a schema");
        return Vec::new();
    };
    schema.iter().flat_map(|(keyword, wanted)| faults_of(schema, keyword, wanted, value, at)).collect()
}

fn faults_of(schema: &Map<String, Value>, keyword: &str, wanted: &Value, value: &Value, at: &str) -> Vec<String> {
    let kept = match keyword {
        "properties" => {
            let keys = wanted.as_object().into_iter().flatten();
            let below = |(key, schema): (&String, &Value)| {
                value.get(key).map_or_else(Vec::new, |value| faults(schema, value, &format!("{at}.{key}")))
            };
            return keys.flat_map(below).collect();
        }
        "additionalProperties" => {
            let known = |key: &String| schema.get("properties").is_some_and(|keys| keys.get(key).is_some());
            let further = value.as_object().into_iter().flatten().filter(|(key, _)| !known(key));
            return further
                .flat_map(|(key, value)| match wanted {
                    Value::Bool(false) => vec![format!("{at}: no key `{key}`")],
                    schema => faults(schema, value, &format!("{at}.{key}")),
                })
                .collect();
        }
        "items" => {
            let items = value.as_array().into_iter().flatten().enumerate();
            return items.flat_map(|(index, item)| faults(wanted, item, &format!("{at}[{index}]"))).collect();
        }
        "oneOf" | "anyOf" => {
            let choices: Vec<_> =
                wanted.as_array().into_iter().flatten().map(|choice| faults(choice, value, at)).collect();
            let fitting = choices.iter().filter(|faults| faults.is_empty()).count();
            if fitting == 1 || (fitting > 1 && keyword == "anyOf") {
                return Vec::new();
            }
            // The fewest faults are those of the choice that was meant.
            let nearest = choices.into_iter().min_by_key(Vec::len).unwrap_or_default();
            return [vec![format!("{at}: {fitting} of the choices fit")], nearest].concat();
        }
        "if" => {
            let branch = if faults(wanted, value, at).is_empty() { "then" } else { "else" };
            return schema.get(branch).map_or_else(Vec::new, |branch| faults(branch, value, at));
        }
        // what `if` leads to
        "then" | "else" => true,
        "maxItems" => {
            value.as_array().is_none_or(|items| wanted.as_u64().is_some_and(|most| items.len() as u64 <= most))
        }
        "not" => !faults(wanted, value, at).is_empty(),
        "type" => match wanted {
            Value::Array(types) => types.iter().any(|ty| is_of(ty, value)),
            ty => is_of(ty, value),
        },
        "required" => {
            let keys = wanted.as_array().into_iter().flatten().filter_map(Value::as_str);
            keys.into_iter().all(|key| !value.is_object() || value.get(key).is_some())
        }
        "const" => wanted == value,
        "enum" => wanted.as_array().is_some_and(|choices| choices.contains(value)),
        "pattern" => {
            let pattern = Regex::new(wanted.as_str().expect("a text")).expect("a pattern");
            value.as_str().is_none_or(|text| pattern.is_match(text))
        }
        "maxLength" => {
            value.as_str().is_none_or(|text| text.chars().count() as u64 <= wanted.as_u64().expect("a count"))
        }
        "minItems" => value.as_array().is_none_or(|items| items.len() as u64 >= wanted.as_u64().expect("a count")),
        "minimum" => value.as_f64().is_none_or(|number| number >= wanted.as_f64().expect("a number")),
        "maximum" => value.as_f64().is_none_or(|number| number <= wanted.as_f64().expect("a number")),
        keyword => {
            assert!(ANNOTATIONS.contains(&keyword), "{at}: this test does not know `{keyword}`");
            true
        }
    };
    if kept { Vec::new() } else { vec![format!("{at}: {value} is not of {keyword} {wanted}")] }
}

fn is_of(ty: &Value, value: &Value) -> bool {
    match ty.as_str().expect("the name of a type") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        ty => panic!("`{ty}` is not a type of TOML"),
    }
}

fn faults_in(schema: &Value, text: &str) -> Vec<String> {
    let table: toml::Table = text.parse().expect("TOML");
    faults(schema, &serde_json::to_value(table).expect("JSON"), "")
}

/// All files called `name` below `folder`.
fn files(folder: &Path, name: &str, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, name, found);
        } else if path
            .file_name()
            .is_some_and(|file| file == name || file.to_string_lossy().ends_with(&format!(".{name}")))
        {
            found.push(path);
        }
    }
}

#[test]
fn the_files_of_the_repository_keep_to_the_schemas() {
    for (name, schema, least) in [("scenario.toml", schema::scenario(), 6), ("cases.toml", schema::cases(), 2)] {
        let mut found = Vec::new();
        files(Path::new(env!("CARGO_MANIFEST_DIR")), name, &mut found);
        assert!(found.len() >= least, "only {found:?}");
        for path in found {
            let faults = faults_in(&schema, &std::fs::read_to_string(&path).expect("a text"));
            assert!(faults.is_empty(), "{}: {faults:#?}", path.display());
        }
    }
}

/// The fenced TOML of a manual that is a whole file.
fn example(manual: &str) -> String {
    let blocks = manual.split("```toml\n").skip(1).filter_map(|rest| Some(rest.split_once("```")?.0));
    blocks.into_iter().find(|block| block.contains("version = 1")).expect("a whole file").to_owned()
}

#[test]
fn the_manual_of_cases_shows_what_the_schema_takes() {
    let faults = faults_in(&schema::cases(), &example(include_str!("../../docs/cases.md")));
    assert!(faults.is_empty(), "{faults:#?}");
}

const SCENARIO: &str = "version = 1\nstep = \"10ms\"\nuntil = \"2.5 s\"\n";

#[test]
fn every_kind_of_client_is_taken() {
    let clients = "
        coupling = { sequential = [\"plc\", \"plant\"] }
        signals.Sensor = { type = \"STRING[80]\", writer = \"plant\" }
        clients.plant = { kind = \"plant\", scene = \"plant.toml\", period = \"20ms\" }
        clients.plc = { kind = \"soft-plc\", sources = [\"a.st\"], dialect = \"siemens-scl\", word_size_bits = 32, bind = { \"a*\" = \"P.a*\" } }
        clients.real = { kind = \"gateway\", reads = [\"Sensor\"], gateway = { url = \"s7://10.0.0.1\", s7.slot = 2 } }
        clients.panel = { kind = \"operator\", initial = { Start = false, Speed = 0.5, Rest = \"200ms\" } }
        clients.cell = { kind = \"opc-ua\" }
        clients.python = { kind = \"external\", command = [\"python3\", \"plant.py\"] }
        freewheel.update_rate = \"50ms\"";
    let faults = faults_in(&schema::scenario(), &format!("{SCENARIO}{clients}"));
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn what_the_reader_refuses_is_refused() {
    let plant = "clients.plant = { kind = \"plant\", scene = \"plant.toml\" }";
    for (wrong, place) in [
        ("", "required"),
        ("clients.plant = { kind = \"plnt\", scene = \"plant.toml\" }", ".clients.plant"),
        ("clients.plant = { kind = \"plant\", scene = \"plant.toml\", sources = [] }", "no key `sources`"),
        (&format!("{plant}\nsigals = {{}}"), "no key `sigals`"),
        (&format!("{plant}\nseed = -1"), ".seed"),
        (&format!("{plant}\nfreewheel.update_rate = \"50 sec\""), ".freewheel.update_rate"),
        (&format!("{plant}\ncoupling = \"serial\""), ".coupling"),
        (&format!("{plant}\nsignals.a = {{ type = \"FLOAT\", writer = \"plant\" }}"), ".signals.a.type"),
    ] {
        let faults = faults_in(&schema::scenario(), &format!("{SCENARIO}{wrong}"));
        assert!(faults.iter().any(|fault| fault.contains(place)), "{wrong}: {faults:#?}");
    }
    for (wrong, place) in [
        ("name = \"a/b\"", ".name"),
        ("name = \"a\"\nmatrix.seed = 3", ".matrix.seed"),
        ("name = \"a\"\nmatrix.plant.ram.speed_m_s = [1]\nuntill = \"1s\"", "no key `untill`"),
        ("name = \"a\"\nforce = [{ signal = \"x\" }]", "required"),
        ("name = \"a\"\ndisturbance = [{ signal = \"x\", kind = \"loose\" }]", ".kind"),
    ] {
        let faults = faults_in(&schema::cases(), &format!("version = 1\n[[case]]\n{wrong}\n"));
        assert!(faults.iter().any(|fault| fault.contains(place)), "{wrong}: {faults:#?}");
    }
}
