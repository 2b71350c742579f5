//! The manual of each file format names every key that its JSON schema has.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::repository;

/// Schemas and the documents that describe their keys, all in `docs`.
const MANUALS: &[(&str, &[&str])] = &[("plant.schema.json", &["plant.md"])];

/// Keys that a schema lists and that the manual describes as a group.
const GROUPED: &[&str] = &["component"];

/// Adds the names of all properties in `schema`, except what lies below a grouped key.
fn gather(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(entries) => {
            for (key, value) in entries {
                match value.as_object().filter(|_| key == "properties") {
                    None => gather(value, found),
                    Some(properties) => {
                        for (name, property) in properties {
                            found.insert(name.clone());
                            if !GROUPED.contains(&name.as_str()) {
                                gather(property, found);
                            }
                        }
                    }
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| gather(value, found)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// The words of a document that stand in code spans.
fn named(text: &str) -> BTreeSet<&str> {
    let spans = text.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    spans.flat_map(|span| span.split(|letter: char| !letter.is_alphanumeric() && letter != '_')).collect()
}

#[test]
fn the_manuals_name_every_key() {
    let docs = repository().join("docs");
    for (schema, manuals) in MANUALS {
        let schema_text = std::fs::read_to_string(docs.join("schemas").join(schema)).expect("a schema");
        let mut keys = BTreeSet::new();
        gather(&serde_json::from_str(&schema_text).expect("JSON"), &mut keys);
        assert!(!keys.is_empty(), "{schema} has no keys");
        let read = |manual: &&str| std::fs::read_to_string(docs.join(manual)).expect("a manual");
        let text: String = manuals.iter().map(read).collect();
        let named = named(&text);
        let missing: Vec<_> = keys.iter().filter(|key| !named.contains(key.as_str())).collect();
        assert!(missing.is_empty(), "{manuals:?} lack these keys of {schema}: {missing:?}");
    }
}
