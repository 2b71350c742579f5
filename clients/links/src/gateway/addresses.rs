//! Addresses as `[clients.NAME.gateway.map]` writes them: one, a list, or a table by variable.

use std::borrow::Cow;
use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer};

/// The key of a table that stands for all variables of a signal: the PLC has one for them all.
pub const ALL: &str = "*";

/// Where the points of a signal are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Addresses {
    /// The address of the only one.
    One(String),
    /// Those of all, in the order of the variables' paths.
    List(Vec<String>),
    /// Those of all, by the variables' paths.
    Table(BTreeMap<String, String>),
    /// Something else, in words: it is refused where its line is known.
    Wrong(String),
}

impl Addresses {
    fn of(value: &toml::Value) -> Self {
        let wrong = |value: &toml::Value| Self::Wrong(format!("{value} ({})", value.type_str()));
        let text = |value: &toml::Value| value.as_str().map(str::to_owned);
        match value {
            toml::Value::String(address) => Self::One(address.clone()),
            toml::Value::Array(all) => {
                all.iter().map(text).collect::<Option<_>>().map_or_else(|| wrong(value), Self::List)
            }
            toml::Value::Table(all) => {
                let entries = all.iter().map(|(path, address)| Some((path.clone(), text(address)?)));
                entries.collect::<Option<_>>().map_or_else(|| wrong(value), Self::Table)
            }
            _ => wrong(value),
        }
    }
}

impl<'de> Deserialize<'de> for Addresses {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        toml::Value::deserialize(deserializer).map(|value| Self::of(&value))
    }
}

impl JsonSchema for Addresses {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Addresses".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let text = || json_schema!({ "type": "string" });
        json_schema!({ "anyOf": [
            text(),
            { "type": "array", "items": text(), "minItems": 1 },
            { "type": "object", "additionalProperties": text() }
        ] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_a_list_and_a_table_are_distinguished() {
        let text = "a = \"hr:1\"\nb = [\"x\", \"y\"]\nc = { P = \"z\" }\nd = 3\ne = [\"x\", 1]\nf = { P = true }\n";
        let read: BTreeMap<String, Addresses> = toml::from_str(text).unwrap();
        let table = Addresses::Table([("P".to_owned(), "z".to_owned())].into());
        assert_eq!(read["a"], Addresses::One("hr:1".to_owned()));
        assert_eq!(read["b"], Addresses::List(vec!["x".to_owned(), "y".to_owned()]));
        assert_eq!(read["c"], table);
        for wrong in ["d", "e", "f"] {
            assert!(matches!(read[wrong], Addresses::Wrong(_)), "{wrong}: {:?}", read[wrong]);
        }
    }
}
