//! A schema as a function that reads a value and checks it: nothing that arrives is trusted.

use std::fmt::Write as _;

use serde_json::Value;

use super::{Keys, keys, map, members, name_of, tag, tuple, without_null, words};

/// What `web/src/field.ts` has for readers.
pub(crate) const PRIMITIVES: &[&str] = &[
    "flag", "json", "list", "map", "matching", "nullable", "number", "numbered", "one_of", "set", "text", "tuple",
    "whole",
];

/// Whether a primitive is called, or handed to another one; keys and words may have its name, too.
pub(crate) fn uses(code: &str, primitive: &str) -> bool {
    code.match_indices(primitive).any(|(at, _)| {
        let (before, after) = (code[..at].chars().next_back(), code[at + primitive.len()..].chars().next());
        matches!(before, Some(' ' | '(')) && matches!(after, Some('(' | ')' | ','))
    })
}

/// The reader of a named type.
pub(crate) fn declare(name: &str, schema: &Value) -> String {
    let mut text = String::new();
    writeln!(text, "\nexport function read{name}(field: Field): {name} {{").expect("a string takes all");
    // A rule that no schema can state is in web/src/checks.ts.
    let check = schema["x-check"].as_str();
    if let Some(members) = members(schema) {
        let (key, _) = tag(&members[0]).expect("a member has a tag");
        let give = |value: &str| match check {
            Some(check) => format!("return check_{check}(field, {value});"),
            None => format!("return {value};"),
        };
        writeln!(text, "  const {key} = field.at(\"{key}\").text();\n  switch ({key}) {{").expect("a string takes all");
        for member in members {
            let (_, word) = tag(member).expect("a member has a tag");
            writeln!(text, "    case \"{word}\":\n      {}", give(&table(member, Some(key), "      ")))
                .expect("a string takes all");
        }
        writeln!(text, "    default:\n      return field.unknown(\"{key}\", {key});\n  }}")
            .expect("a string takes all");
    } else if let Some(check) = check {
        writeln!(text, "  return check_{check}(field, {});", read(schema, "field")).expect("a string takes all");
    } else {
        writeln!(text, "  return {};", read(schema, "field")).expect("a string takes all");
    }
    text.push_str("}\n");
    text
}

/// An expression that reads a schema from `field`.
fn read(schema: &Value, field: &str) -> String {
    if schema["properties"].is_object() && schema["$ref"].is_null() {
        return table(schema, None, "  ");
    }
    format!("{}({field})", reader(schema))
}

/// The keys of a table; its tag, where it has one, has been read. Lines after the first are indented.
fn table(schema: &Value, tag: Option<&str>, indent: &str) -> String {
    assert!(schema["$ref"].is_null() && schema["oneOf"].is_null(), "keys of another type are not read yet: {schema}");
    let mut parts: Vec<String> = tag.map(str::to_owned).into_iter().collect();
    for (key, schema, is_required) in keys(schema) {
        if tag == Some(key) {
            continue;
        }
        let at = match preset(schema).filter(|_| !is_required) {
            Some(preset) => format!("field.at(\"{key}\", {preset})"),
            None => format!("field.at(\"{key}\")"),
        };
        parts.push(format!("{key}: {}({at})", reader(schema)));
    }
    let one_line = format!("{{ {} }}", parts.join(", "));
    let lines = || format!("{{\n{indent}  {},\n{indent}}}", parts.join(&format!(",\n{indent}  ")));
    if one_line.len() < 100 { one_line } else { lines() }
}

/// What is read where an optional key is absent; nothing where the reader takes that. A schema does not have the default of a
/// key that the server leaves out where it is empty.
fn preset(schema: &Value) -> Option<Value> {
    let default = schema.get("default").filter(|default| !default.is_null());
    default.cloned().or_else(|| match schema["type"].as_str()? {
        "array" => Some(Value::Array(Vec::new())),
        "object" => Some(Value::Object(serde_json::Map::new())),
        "number" | "integer" => Some(Value::from(0)),
        "boolean" => Some(Value::Bool(false)),
        "string" => Some(Value::from("")),
        _ => None,
    })
}

/// A reader of a schema.
fn reader(schema: &Value) -> String {
    if let Some(one) = without_null(schema) {
        return format!("nullable({})", reader(&one));
    }
    if !schema["$ref"].is_null() {
        return format!("read{}", name_of(schema));
    }
    if let Some(words) = words(schema) {
        let all: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
        return format!("one_of({})", all.join(", "));
    }
    if schema["properties"].is_object() {
        return format!("(field: Field) => ({})", table(schema, None, "    "));
    }
    match schema["type"].as_str() {
        Some("string") => match schema["pattern"].as_str() {
            Some(pattern) => format!("matching(/{}/)", pattern.replace('/', "\\/")),
            None => "text".to_owned(),
        },
        Some("number") => "number".to_owned(),
        Some("integer") => "whole".to_owned(),
        Some("boolean") => "flag".to_owned(),
        Some("array") => list(schema),
        Some("object") => match map(schema) {
            Some(Keys::Texts(value)) => format!("map({})", reader(value)),
            Some(Keys::Numbers(value)) => format!("numbered({})", reader(value)),
            None => panic!("an object without keys: {schema}"),
        },
        None if schema["anyOf"].is_null() && schema["oneOf"].is_null() => "json".to_owned(),
        _ => panic!("a type that no page receives yet: {schema}"),
    }
}

fn list(schema: &Value) -> String {
    if let Some(items) = tuple(schema) {
        return format!("tuple({})", items.into_iter().map(reader).collect::<Vec<_>>().join(", "));
    }
    let all = if schema["uniqueItems"] == true { "set" } else { "list" };
    format!("{all}({})", reader(&schema["items"]))
}
