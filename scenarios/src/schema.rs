//! The JSON schemas of `scenario.toml`, `cases.toml` and `lessons.toml`, for editors, and of a run's report, for programs: made from the
//! structs that are read and written.

use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

use crate::base::BaseFile;
use crate::case;
use crate::case::cases_file::CasesFile;
use crate::file::{self, ScenarioFile};
use crate::lesson;
use crate::lesson::file::LessonsFile;
use crate::report::Report;

/// The schema of `scenario.toml` (JSON Schema 2020-12).
pub fn scenario() -> Value {
    let mut top = schema::<ScenarioFile>("onescan scenario", file::VERSION);
    let whole = needed(&top);
    relax(&mut top);
    let own = into_schema::<BaseFile>();
    if let (Value::Object(keys), Value::Object(own)) = (&mut top["properties"], &own["properties"]) {
        keys.extend(own.clone());
    }
    top["required"] = json!(["version"]);
    top["if"] = json!({ "required": ["base"] });
    top["else"] = whole;
    top
}

/// Lets a schema take a part of what it describes: the base of a scenario states the rest. A list without names is never taken in
/// in parts.
fn relax(schema: &mut Value) {
    let Value::Object(keywords) = schema else { return };
    if let Some(Value::Array(keys)) = keywords.get_mut("required") {
        keys.retain(|key| key == "name");
    }
    if let Some(Value::Object(keys)) = keywords.get_mut("properties") {
        keys.values_mut().for_each(relax);
    }
    if let Some(values) = keywords.get_mut("additionalProperties") {
        relax(values);
    }
    if let Some(items) = keywords.get_mut("items").filter(|items| is_named(items)) {
        relax(items);
    }
    // A part may fit several kinds.
    if let Some(Value::Array(mut choices)) = keywords.remove("oneOf") {
        choices.iter_mut().for_each(relax);
        keywords.insert("anyOf".to_owned(), choices.into());
    }
    keywords.retain(|_, value| *value != json!([]));
}

fn is_named(items: &Value) -> bool {
    items["required"].as_array().is_some_and(|keys| keys.iter().any(|key| key == "name"))
}

/// Of a schema only what must be there.
fn needed(schema: &Value) -> Value {
    let mut all = serde_json::Map::new();
    for (keyword, value) in schema.as_object().into_iter().flatten() {
        let kept = match (keyword.as_str(), value) {
            ("required" | "const", value) => value.clone(),
            ("properties", Value::Object(keys)) => {
                let keys = keys.iter().map(|(key, value)| (key.clone(), needed(value)));
                Value::Object(keys.filter(|(_, value)| *value != json!({})).collect())
            }
            ("items" | "additionalProperties", Value::Object(_)) => needed(value),
            ("oneOf", Value::Array(choices)) => {
                all.insert("anyOf".to_owned(), choices.iter().map(needed).collect());
                continue;
            }
            _ => continue,
        };
        if kept != json!({}) {
            all.insert(keyword.clone(), kept);
        }
    }
    Value::Object(all)
}

/// The schema of `cases.toml` (JSON Schema 2020-12).
pub fn cases() -> Value {
    schema::<CasesFile>("onescan cases", case::cases_file::VERSION)
}

/// The schema of `lessons.toml` (JSON Schema 2020-12).
pub fn lessons() -> Value {
    schema::<LessonsFile>("onescan lessons", lesson::file::VERSION)
}

/// The schema of `report` in the line of a run, and of `onescan report` (JSON Schema 2020-12).
pub fn report() -> Value {
    let mut top = into_schema::<Report>();
    top["title"] = json!("onescan report");
    top
}

fn into_schema<File: JsonSchema>() -> Value {
    // References are resolved, since not every editor follows them.
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut top = settings.into_generator().into_root_schema_for::<File>();
    as_written(&mut top);
    top.to_value()
}

fn schema<File: JsonSchema>(title: &str, version: u32) -> Value {
    let mut top = into_schema::<File>();
    top["title"] = json!(title);
    let about = top["properties"]["version"]["description"].take();
    top["properties"]["version"] = json!({ "const": version, "description": about });
    top
}

/// Brings a schema of Rust's types to what a person writes in TOML.
fn as_written(schema: &mut Schema) {
    // There is no null: an absent key is absent.
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|ty| ty != "null");
        if let [one] = &types[..] {
            let one = one.clone();
            schema.insert("type".to_owned(), one);
        }
    }
    if let Some(Value::Array(choices)) = schema.get_mut("enum") {
        choices.retain(|choice| !choice.is_null());
    }
    for key in ["anyOf", "oneOf"] {
        let Some(Value::Array(choices)) = schema.get_mut(key) else { continue };
        choices.retain(|choice| choice["type"] != "null");
        if let [Value::Object(only)] = &choices[..] {
            let only = only.clone();
            schema.remove(key);
            for (keyword, value) in only {
                if schema.get(&keyword).is_none() {
                    schema.insert(keyword, value);
                }
            }
        }
    }
    // The width of a number says nothing beside its bounds.
    schema.remove("format");
    if schema.get("default").is_some_and(|default| !is_informative(default, schema.get("type"))) {
        schema.remove("default");
    }
    // An editor shows at `kind` what the table is.
    let about = schema.get("description").cloned();
    if let (Some(about), Some(kind)) = (about, schema.get_mut("properties").and_then(|keys| keys.get_mut("kind")))
        && kind.get("const").is_some()
    {
        kind["description"] = about;
    }
    transform_subschemas(&mut as_written, schema);
}

/// True for a default that informs a reader. Emptiness does not, nor does a value in another form than that in
/// which it is written, as the nanoseconds of a time.
fn is_informative(default: &Value, ty: Option<&Value>) -> bool {
    match (default, ty.and_then(Value::as_str)) {
        (Value::Bool(_), Some("boolean")) | (Value::Number(_), Some("integer" | "number")) => true,
        (Value::String(text), Some("string")) => !text.is_empty(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_published(name: &str, schema: &Value) {
        let path = format!("{}/../docs/schemas/{name}.schema.json", env!("CARGO_MANIFEST_DIR"));
        let made = format!("{}\n", serde_json::to_string_pretty(schema).expect("JSON"));
        if std::env::var_os("UPDATE_DOCS").is_some() {
            std::fs::write(&path, &made).expect("written");
        }
        let published = std::fs::read_to_string(&path).expect("published");
        assert!(published == made, "run with UPDATE_DOCS=1 and read the difference in {path}");
    }

    #[test]
    fn the_published_schemas_are_those_of_the_structs() {
        is_published("scenario", &scenario());
        is_published("cases", &cases());
        is_published("training", &lessons());
        is_published("report", &report());
    }

    /// The keys without a description.
    fn undescribed(schema: &Value, at: &str, found: &mut Vec<String>) {
        match schema {
            Value::Object(fields) => {
                for (key, value) in fields {
                    // It repeats which keys must be there, and describes none.
                    if key == "else" {
                        continue;
                    }
                    if key != "properties" {
                        undescribed(value, at, found);
                        continue;
                    }
                    for (name, property) in value.as_object().expect("keys") {
                        let at = format!("{at}.{name}");
                        if property["description"].as_str().is_none_or(str::is_empty) {
                            found.push(at.clone());
                        }
                        undescribed(property, &at, found);
                    }
                }
            }
            Value::Array(list) => list.iter().for_each(|value| undescribed(value, at, found)),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }

    #[test]
    fn every_key_is_described() {
        let mut found = Vec::new();
        undescribed(&scenario(), "scenario", &mut found);
        undescribed(&cases(), "cases", &mut found);
        undescribed(&lessons(), "lessons", &mut found);
        undescribed(&report(), "report", &mut found);
        assert!(found.is_empty(), "{found:?}");
    }
}
