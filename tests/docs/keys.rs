//! The manual of each file format names every key that its JSON schema has: `docs/schemas/NAME.schema.json` and
//! `docs/NAME.md`.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde_json::Value;

use crate::markdown::code;
use crate::repository;

/// Manuals that describe a part of another format.
const FURTHER: &[(&str, &str)] =
    &[("cases", "campaigns.md"), ("scenario", "gateway-links.md"), ("scenario", "report.md"), ("training", "cases.md")];

/// Keys that a manual describes as a group: the parameters and signals of each component are in the library's pages.
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

/// The schemas and the names of their formats.
fn schemas() -> Vec<(String, PathBuf)> {
    let folder = repository().join("docs/schemas");
    let entries = std::fs::read_dir(folder).expect("docs/schemas");
    let schema = |path: PathBuf| {
        let name = path.file_name()?.to_str()?.strip_suffix(".schema.json")?.to_owned();
        Some((name, path))
    };
    let mut found: Vec<_> = entries.filter_map(|entry| schema(entry.expect("an entry").path())).collect();
    found.sort();
    found
}

#[test]
fn the_manuals_name_every_key() {
    let docs = repository().join("docs");
    let schemas = schemas();
    assert!(!schemas.is_empty(), "there are no schemas");
    for (format, path) in schemas {
        let schema = std::fs::read_to_string(&path).expect("a schema");
        let mut keys = BTreeSet::new();
        gather(&serde_json::from_str(&schema).expect("JSON"), &mut keys);
        assert!(!keys.is_empty(), "{} has no keys", path.display());
        let further = FURTHER.iter().filter(|(of, _)| *of == format).map(|(_, manual)| (*manual).to_owned());
        let mut named = BTreeSet::new();
        for manual in std::iter::once(format!("{format}.md")).chain(further) {
            let text = std::fs::read_to_string(docs.join(&manual));
            let text = text.unwrap_or_else(|error| panic!("docs/{manual} describes {}: {error}", path.display()));
            let code = code(&text);
            let words = code.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
            named.extend(words.map(str::to_owned));
        }
        let missing: Vec<_> = keys.iter().filter(|key| !named.contains(*key)).collect();
        assert!(missing.is_empty(), "docs/{format}.md lacks these keys of {}: {missing:?}", path.display());
    }
}
