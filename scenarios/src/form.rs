//! The forms of values in the files, for their JSON schemas: types of other crates are to an editor what a person
//! writes, and values that are written as text.

use std::borrow::Cow;
use std::str::FromStr;

use onescan_base::ElementaryType;
use onescan_iec::{Dialect, MemoryLimit};
use onescan_iec_project::mutate::MutantKind;
use onescan_links::gateway::settings::Text;
use onescan_server::signal::name::NAME_BYTES_MAX;
use onescan_server::time::TimeSpan;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer};
use serde_json::json;

/// A time, as in `"10ms"`.
pub(crate) type Time = Text<TimeSpan>;

/// A form whose schema is always written out where it is used.
macro_rules! form {
    ($(#[$doc:meta])* $name:ident, $schema:expr) => {
        $(#[$doc])*
        pub(crate) struct $name;

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                $schema
            }
        }
    };
}

form!(
    /// The name of a signal or client.
    Name,
    json_schema!({
        "type": "string",
        "pattern": r"^[A-Za-z_][A-Za-z0-9_.,\[\]-]*$",
        "maxLength": NAME_BYTES_MAX,
    })
);

form!(
    /// The name of a case, which is also that of a file.
    CaseName,
    json_schema!({ "type": "string", "pattern": r"^[A-Za-z0-9_-][A-Za-z0-9_.-]*$" })
);

form!(
    /// The type of a signal. The reader takes small letters, too; an editor offers the standard's spelling.
    Type,
    json_schema!({
        "type": "string",
        "anyOf": [
            { "enum": ElementaryType::ALL.iter().map(|ty| ty.name()).collect::<Vec<_>>() },
            { "pattern": r"^((W?STRING|BYTES)(\[ *[0-9]{1,5} *\])?|L?TIME_OF_DAY|L?DATE_AND_TIME)$" },
        ],
    })
);

form!(
    /// The dialect of a PLC's sources.
    DialectName,
    json_schema!({ "type": "string", "enum": Dialect::ALL.map(Dialect::name) })
);

form!(
    /// Bits of the registers of a PLC.
    WordBits,
    json_schema!({ "type": "integer", "enum": [32, 64] })
);

form!(
    /// What is changed in a mutant.
    MutantWord,
    json_schema!({ "type": "string", "enum": MutantKind::ALL.map(MutantKind::word) })
);

form!(
    /// How much memory the variables of a PLC may take.
    Mebibytes,
    json_schema!({ "type": "integer", "minimum": 1, "maximum": MemoryLimit::GREATEST_MIB })
);

form!(
    /// The value of a signal or variable.
    Scalar,
    json_schema!({ "type": ["boolean", "number", "string"] })
);

form!(
    /// By how much a disturbance changes a signal: a number, or a time as text.
    Amount,
    json_schema!({ "type": ["number", "string"] })
);

form!(
    /// How often something happens, as a part of all times.
    Rate,
    json_schema!({ "type": "number", "minimum": 0, "maximum": 1 })
);

form!(
    /// A standard deviation.
    Deviation,
    json_schema!({ "type": "number", "minimum": 0 })
);

form!(
    /// Which one, from 1.
    Ordinal,
    json_schema!({ "type": "integer", "minimum": 1 })
);

form!(
    /// Values by path. A path is a quoted key or tables in one another, so only the first part is seen here.
    Settings,
    json_schema!({
        "type": "object",
        "properties": { "seed": seed("Seed of all randomness.") },
        "additionalProperties": true,
    })
);

form!(
    /// Values by path.
    Values,
    json_schema!({ "type": "object", "additionalProperties": true })
);

form!(
    /// Lists of values by path.
    Matrix,
    json_schema!({
        "type": "object",
        "properties": {
            "seed": {
                "description": "Seeds of all randomness: a list, or a range with both ends as `1..20`.",
                "anyOf": [
                    { "type": "array", "items": seed("One seed."), "minItems": 1 },
                    { "type": "string", "pattern": r"^ *[0-9]+ *\.\. *[0-9]+ *$" },
                ],
            },
        },
        "additionalProperties": {
            "anyOf": [{ "type": "array", "minItems": 1 }, { "type": "object" }],
        },
    })
);

fn seed(about: &str) -> serde_json::Value {
    json!({ "description": about, "type": "integer", "minimum": 0 })
}

/// A value that is written as text, as a time is.
pub(crate) fn from_text<'de, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr,
    T::Err: std::fmt::Display,
{
    String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
}

/// The same for a key that may be absent.
pub(crate) fn from_optional_text<'de, D, T>(deserializer: D) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr,
    T::Err: std::fmt::Display,
{
    from_text(deserializer).map(Some)
}
