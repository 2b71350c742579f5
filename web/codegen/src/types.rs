//! A schema as a type of TypeScript.

use std::fmt::Write as _;

use serde_json::Value;

use super::{Keys, keys, map, members, name_of, tuple, without_null, words};

/// Which way a message goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// The page reads it: the reader puts something in the place of a key that is absent.
    Received,
    /// The page writes it: keys that the server does without may be left out.
    Sent,
}

/// Adds the declaration of a named type to a module.
pub(crate) fn declare(text: &mut String, name: &str, schema: &Value, way: Way) {
    text.push('\n');
    about(text, schema, "");
    if let Some(words) = words(schema) {
        let union: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
        writeln!(text, "export type {name} = {};", union.join(" | ")).expect("a string takes all");
    } else if let Some(members) = members(schema) {
        writeln!(text, "export type {name} =").expect("a string takes all");
        for (place, member) in members.iter().enumerate() {
            about(text, member, "  ");
            let end = if place + 1 == members.len() { ";" } else { "" };
            writeln!(text, "  | {}{end}", of(member, way)).expect("a string takes all");
        }
    } else if schema["properties"].is_object() && schema["oneOf"].is_null() {
        writeln!(text, "export interface {name} {{").expect("a string takes all");
        for (key, schema, is_required) in keys(schema) {
            about(text, schema, "  ");
            writeln!(text, "  readonly {};", member(key, schema, is_required, way)).expect("a string takes all");
        }
        text.push_str("}\n");
    } else {
        writeln!(text, "export type {name} = {};", of(schema, way)).expect("a string takes all");
    }
}

/// What a type, a key or a member of a union means.
fn about(text: &mut String, schema: &Value, indent: &str) {
    if let Some(about) = schema["description"].as_str() {
        writeln!(text, "{indent}/** {} */", about.replace('\n', " ")).expect("a string takes all");
    }
}

fn member(key: &str, schema: &Value, is_required: bool, way: Way) -> String {
    let mark = if way == Way::Sent && !is_required { "?" } else { "" };
    format!("{key}{mark}: {}", of(schema, way))
}

/// The type of a schema.
pub(crate) fn of(schema: &Value, way: Way) -> String {
    if let Some(one) = without_null(schema) {
        return format!("{} | null", of(&one, way));
    }
    if !schema["$ref"].is_null() && schema["properties"].is_null() {
        return name_of(schema).to_owned();
    }
    if let Some(word) = schema["const"].as_str() {
        return format!("\"{word}\"");
    }
    if let Some(words) = words(schema) {
        return words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" | ");
    }
    if schema["properties"].is_object() {
        let all: Vec<String> =
            keys(schema).into_iter().map(|(key, schema, is_required)| member(key, schema, is_required, way)).collect();
        let own = format!("{{ readonly {} }}", all.join("; readonly "));
        return match schema.get("$ref").or(schema.get("oneOf")) {
            None => own,
            Some(Value::Array(members)) => format!("({own} & ({}))", union(members, way)),
            Some(_) => format!("({own} & {})", name_of(schema)),
        };
    }
    if let Some(members) = schema["anyOf"].as_array().or(schema["oneOf"].as_array()) {
        return union(members, way);
    }
    match schema["type"].as_str() {
        Some("string") => "string".to_owned(),
        Some("number" | "integer") => "number".to_owned(),
        Some("boolean") => "boolean".to_owned(),
        Some("null") => "null".to_owned(),
        Some("array") => list(schema, way),
        Some("object") => match map(schema) {
            Some(Keys::Texts(value)) => format!("ReadonlyMap<string, {}>", of(value, way)),
            Some(Keys::Numbers(value)) => format!("ReadonlyMap<number, {}>", of(value, way)),
            None => panic!("an object without keys: {schema}"),
        },
        // A value of any kind.
        None => "Json".to_owned(),
        Some(other) => panic!("{other}: {schema}"),
    }
}

fn union(members: &[Value], way: Way) -> String {
    members.iter().map(|member| of(member, way)).collect::<Vec<_>>().join(" | ")
}

fn list(schema: &Value, way: Way) -> String {
    if let Some(items) = tuple(schema) {
        return format!("readonly [{}]", items.into_iter().map(|item| of(item, way)).collect::<Vec<_>>().join(", "));
    }
    let item = of(&schema["items"], way);
    if schema["uniqueItems"] == true {
        return format!("ReadonlySet<{item}>");
    }
    if item.contains([' ', '|']) { format!("readonly ({item})[]") } else { format!("readonly {item}[]") }
}
