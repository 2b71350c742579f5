//! A union of messages as a table of a document.

use serde_json::Value;

use super::types::{self, Way};
use super::{Definitions, Types, keys, members, name_of, tag};

impl Types {
    /// The members of a union of these types: name, keys, meaning.
    ///
    /// # Panics
    /// `union` is not a union of these types.
    pub fn table(&self, union: &str) -> String {
        let definitions = self.definitions();
        let members = members(&definitions[union]).unwrap_or_else(|| panic!("{union} is not a union"));
        let rows: String = members.iter().map(|member| row(member, &definitions)).collect();
        format!("| Message | Keys | Meaning |\n|---|---|---|\n{rows}")
    }
}

fn row(member: &Value, definitions: &Definitions) -> String {
    let (tag, word) = tag(member).expect("a member has a tag");
    let mut all: Vec<String> = keys(member)
        .into_iter()
        .filter(|(key, ..)| *key != tag)
        .map(|(key, schema, is_required)| {
            let optional = if is_required { "" } else { "?" };
            format!("`{key}{optional}: {}`", written(schema, definitions))
        })
        .collect();
    let nested = if member["$ref"].is_null() { &member["oneOf"] } else { &definitions[name_of(member)]["oneOf"] };
    all.extend(nested.as_array().into_iter().flatten().map(|one| format!("`{}`", written(one, definitions))));
    let about = member["description"].as_str().unwrap_or_else(|| panic!("`{word}` is not described"));
    format!("| `{word}` | {} | {} |\n", all.join("<br>"), about.replace('\n', " ")).replace("readonly ", "")
}

/// A type as a reader of the document sees it: unions of words are written out.
fn written(schema: &Value, definitions: &Definitions) -> String {
    let mut text = types::of(schema, Way::Received);
    for (name, definition) in definitions {
        if let Some(words) = super::words(definition) {
            let union = words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" \\| ");
            let is_name = text.split(|c: char| !c.is_alphanumeric()).any(|word| word == name);
            if is_name {
                text = text.replace(name.as_str(), &union);
            }
        }
    }
    as_json(text).replace(" | ", " \\| ")
}

/// Sets and maps as they are on the wire: lists, and objects of any keys.
fn as_json(mut text: String) -> String {
    for (name, begin, end) in [("ReadonlySet<", "", "[]"), ("ReadonlyMap<", "{ [", " }")] {
        while let Some((before, rest)) = text.split_once(name) {
            let (inside, after) = rest.split_once('>').expect("it is closed");
            text = format!("{before}{begin}{}{end}{after}", inside.replacen(", ", "]: ", 1));
        }
    }
    text
}
