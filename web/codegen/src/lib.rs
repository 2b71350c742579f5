//! The messages of the pages, described once: TypeScript types, readers that check what arrives, and the tables of
//! `web/PROTOCOL.md`, all made from the JSON schemas of the server's types.
//!
//! | module | subject |
//! |---|---|
//! | `types` | a schema as a type |
//! | `readers` | a schema as a function that reads a value and checks it |
//! | [`table`] | a union of messages as a table of a document |
//! | [`published`] | what is generated, held against the files |
//!
//! Only tests of the server's crates use it. It knows what `schemars` makes of the types that the pages need, and panics at
//! anything else: a new shape of type is added here before it is sent.

pub mod published;
mod readers;
pub mod table;
mod types;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::Value;
use types::Way;

/// The types of one page, by name.
#[derive(Debug)]
pub struct Types {
    generator: SchemaGenerator,
    /// Types that arrive at the page, which reads them.
    incoming: BTreeSet<String>,
}

/// A JSON schema, and those that it refers to.
type Definitions = BTreeMap<String, Value>;

impl Default for Types {
    fn default() -> Self {
        // A key is optional where whoever reads does without it.
        let generator = SchemaSettings::draft2020_12().for_deserialize().into_generator();
        Self { generator, incoming: BTreeSet::new() }
    }
}

impl Types {
    /// Adds a type that the page receives, with all that it refers to.
    pub fn receive<T: JsonSchema>(mut self) -> Self {
        let schema = self.generator.subschema_for::<T>().to_value();
        self.incoming.insert(name_of(&schema).to_owned());
        self
    }

    /// Adds a type that the page sends, with all that it refers to.
    pub fn send<T: JsonSchema>(mut self) -> Self {
        self.generator.subschema_for::<T>();
        self
    }

    fn definitions(&self) -> Definitions {
        self.generator.definitions().iter().map(|(name, schema)| (name.clone(), schema.clone())).collect()
    }

    /// The module of these types, in which `protocol` is the version of the protocol.
    pub fn module(&self, protocol: u32) -> String {
        let definitions = self.definitions();
        let received = reached(&self.incoming, &definitions);
        let (mut body, mut read) = (String::new(), String::new());
        for (name, schema) in &definitions {
            let is_received = received.contains(name);
            types::declare(&mut body, name, schema, if is_received { Way::Received } else { Way::Sent });
            if is_received {
                let reader = readers::declare(name, schema);
                body += &reader;
                read += &reader;
            }
        }
        let mut text = "// Generated from the types of the server; see web/README.md. Do not edit.\n\n".to_owned();
        let words: BTreeSet<&str> = read.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        let used = readers::PRIMITIVES.iter().filter(|word| readers::uses(&read, word)).copied();
        let types = [("Field", "type Field"), ("Json", "type Json")];
        let all: BTreeSet<&str> = body.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        let types = types.into_iter().filter(|(name, _)| all.contains(name)).map(|(_, import)| import);
        let imported: Vec<&str> = used.chain(types).collect();
        if !imported.is_empty() {
            writeln!(text, "import {{ {} }} from \"../field\";", imported.join(", ")).expect("a string takes all");
        }
        let checked: Vec<&str> = words.iter().filter(|word| word.starts_with("check_")).copied().collect();
        if !checked.is_empty() {
            writeln!(text, "import {{ {} }} from \"../checks\";", checked.join(", ")).expect("a string takes all");
        }
        writeln!(text, "\nexport const PROTOCOL = {protocol};").expect("a string takes all");
        text + &body
    }
}

/// The types that are read with these.
fn reached(from: &BTreeSet<String>, definitions: &Definitions) -> BTreeSet<String> {
    let mut reached = BTreeSet::new();
    let mut waiting: Vec<&str> = from.iter().map(String::as_str).collect();
    while let Some(name) = waiting.pop() {
        if reached.insert(name.to_owned()) {
            references(&definitions[name], &mut waiting);
        }
    }
    reached
}

fn references<'s>(schema: &'s Value, found: &mut Vec<&'s str>) {
    match schema {
        Value::Object(keys) => {
            found.extend(keys.get("$ref").map(|_| name_of(schema)));
            keys.values().for_each(|schema| references(schema, found));
        }
        Value::Array(all) => all.iter().for_each(|schema| references(schema, found)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// The type that a schema refers to.
fn name_of(schema: &Value) -> &str {
    let reference = schema["$ref"].as_str().unwrap_or_else(|| panic!("a schema of its own: {schema}"));
    reference.rsplit('/').next().expect("split gives one part")
}

/// The key and its value by which the members of a union are distinguished, and the other keys of a member.
fn tag(member: &Value) -> Option<(&str, &str)> {
    let properties = member["properties"].as_object()?;
    let mut tags = properties.iter().filter_map(|(key, schema)| Some((key.as_str(), schema["const"].as_str()?)));
    tags.next()
}

/// The members of a union of tables.
fn members(schema: &Value) -> Option<&[Value]> {
    let members = schema["oneOf"].as_array().map(Vec::as_slice);
    // A table may be a union of others beside keys of its own.
    members.filter(|members| schema["properties"].is_null() && members.iter().all(|member| tag(member).is_some()))
}

/// The keys of a table, each with its schema and whether it is required: first its tag, then what is required in the order of
/// the Rust type, then the others in alphabetical order. That order does not depend on how `serde_json` keeps its maps.
fn keys(table: &Value) -> Vec<(&str, &Value, bool)> {
    let required: Vec<&str> = table["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let properties = table["properties"].as_object().into_iter().flatten();
    let mut keys: Vec<(&str, &Value, bool)> =
        properties.map(|(key, schema)| (key.as_str(), schema, required.contains(&key.as_str()))).collect();
    let place = |key: &str| required.iter().position(|one| *one == key).unwrap_or(usize::MAX);
    keys.sort_by_key(|(key, schema, _)| (schema["const"].is_null(), place(key), *key));
    keys
}

/// The schema without `null`, if it allows that.
fn without_null(schema: &Value) -> Option<Value> {
    if let Some(types) = schema["type"].as_array() {
        let others: Vec<&Value> = types.iter().filter(|ty| *ty != "null").collect();
        let [only] = others[..] else { panic!("several types: {schema}") };
        let mut one = schema.clone();
        one["type"] = only.clone();
        if let Some(Value::Array(words)) = one.get_mut("enum") {
            words.retain(|word| !word.is_null());
        }
        return (others.len() < types.len()).then_some(one);
    }
    let all = schema["anyOf"].as_array()?;
    let others: Vec<&Value> = all.iter().filter(|one| one["type"] != "null").collect();
    match others[..] {
        [only] if others.len() < all.len() => Some(only.clone()),
        _ => None,
    }
}

/// The words of a schema that is one of some words; those that are described stand apart from the others.
fn words(schema: &Value) -> Option<Vec<&str>> {
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().map(Value::as_str).collect();
    }
    if let Some(word) = schema["const"].as_str() {
        return Some(vec![word]);
    }
    let all: Option<Vec<Vec<&str>>> = schema["oneOf"].as_array()?.iter().map(words).collect();
    Some(all?.concat())
}

/// The schemas of the items of a list of a fixed length.
fn tuple(schema: &Value) -> Option<Vec<&Value>> {
    if let Some(items) = schema["prefixItems"].as_array() {
        return Some(items.iter().collect());
    }
    let (least, most) = (schema["minItems"].as_u64()?, schema["maxItems"].as_u64()?);
    (least == most).then(|| (0..least).map(|_| &schema["items"]).collect())
}

/// What the keys of a map are, if a table is one: any text, or whole numbers.
enum Keys<'s> {
    Texts(&'s Value),
    Numbers(&'s Value),
}

fn map(schema: &Value) -> Option<Keys<'_>> {
    if let Some(patterns) = schema["patternProperties"].as_object() {
        return patterns.values().next().map(Keys::Numbers);
    }
    let values = &schema["additionalProperties"];
    (schema["properties"].is_null() && (values.is_object() || *values == true)).then_some(Keys::Texts(values))
}

#[cfg(test)]
mod tests {
    #![expect(dead_code, reason = "types of which only the schema counts")]

    use std::collections::{BTreeMap, BTreeSet};

    use super::*;

    /// What arrives.
    #[derive(JsonSchema)]
    #[serde(tag = "type", rename_all = "lowercase")]
    enum Message {
        /// How it is.
        Status {
            state: State,
            #[schemars(default)]
            failed: BTreeSet<String>,
            past_ns: Option<[u64; 2]>,
        },
        /// Where something is.
        Shape { shape: Shape },
        /// Values.
        Values {
            #[serde(flatten)]
            seen: Seen,
        },
    }

    #[derive(JsonSchema)]
    #[serde(rename_all = "lowercase")]
    enum State {
        Run,
        /// Held.
        Hold,
    }

    #[derive(JsonSchema)]
    struct Seen {
        values: Vec<(usize, Option<String>)>,
        names: BTreeMap<i64, String>,
    }

    #[derive(JsonSchema)]
    #[schemars(extend("x-check" = "shape"))]
    struct Shape {
        at_m: [f64; 3],
        #[schemars(regex(pattern = "^#[0-9a-f]{6}$"))]
        colour: String,
        more: serde_json::Value,
        #[schemars(default = "span")]
        span: [u32; 2],
    }

    fn span() -> [u32; 2] {
        [1, 1]
    }

    /// What is asked.
    #[derive(JsonSchema)]
    #[serde(tag = "type", rename_all = "lowercase")]
    enum Ask {
        /// Looks at these.
        Watch { variables: Vec<usize>, one: Option<f64> },
        /// Decides.
        Train(Turn),
        /// Nothing.
        Live,
    }

    #[derive(JsonSchema)]
    #[serde(tag = "turn", rename_all = "lowercase")]
    enum Turn {
        Repeat,
        Back { t_ns: f64 },
    }

    #[test]
    fn a_module_has_types_and_readers() {
        let types = Types::default().receive::<Message>().send::<Ask>();
        let made = format!("{}{}{}", types.module(1), types.table("Message"), types.table("Ask"));
        for line in [
            "import { json, list, matching, nullable, number, numbered, one_of, set, text, tuple, whole, type Field, type Json }",
            "export const PROTOCOL = 1;",
            r#"  | { readonly type: "status"; readonly state: State; readonly failed: ReadonlySet<string>; readonly past_ns: readonly [number, number] | null }"#,
            r#"        state: readState(field.at("state")),"#,
            r#"        failed: set(text)(field.at("failed", [])),"#,
            r#"export type State = "run" | "hold";"#,
            r#"  return one_of("run", "hold")(field);"#,
            "readonly names: ReadonlyMap<number, string>",
            r#"values: list(tuple(whole, nullable(text)))(field.at("values"))"#,
            r#"colour: matching(/^#[0-9a-f]{6}$/)(field.at("colour"))"#,
            r#"more: json(field.at("more"))"#,
            r#"span: tuple(whole, whole)(field.at("span", [1,1]))"#,
            "check_shape(field, ",
            r#"      return field.unknown("type", type);"#,
            r#"  | { readonly type: "watch"; readonly variables: readonly number[]; readonly one?: number | null }"#,
            r#"  | ({ readonly type: "train" } & Turn)"#,
            r#"| `status` | `state: "run" \| "hold"`<br>`failed?: string[]`<br>`past_ns?: [number, number] \| null` | How it is. |"#,
            "| `live` |  | Nothing. |",
        ] {
            assert!(made.contains(line), "{line}\n{made}");
        }
        assert!(!made.contains("readAsk"), "the page does not read what it sends");
    }
}
