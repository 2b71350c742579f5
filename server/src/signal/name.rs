//! Names of signals and clients: short, printable, one spelling.

use std::fmt;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Longest name of a signal or client, in bytes.
pub const NAME_BYTES_MAX: usize = 128;

/// Why a text cannot name a signal or client.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "`{0}` is not a name: use letters, digits, `_`, `.`, `-`, `[` and `]`, beginning with a letter or `_`, \
     128 characters at most"
)]
pub struct BadName(pub String);

fn validate(text: String) -> Result<String, BadName> {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let inside = |c: char| letter(c) || c.is_ascii_digit() || matches!(c, '.' | '-' | '[' | ']' | ',');
    let good = text.starts_with(letter) && text.chars().all(inside) && text.len() <= NAME_BYTES_MAX;
    if good { Ok(text) } else { Err(BadName(text)) }
}

macro_rules! name {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "String")]
        pub struct $name(String);

        impl $name {
            /// The name in `text`.
            ///
            /// # Errors
            /// A text that is empty, too long or has other characters than a name may have.
            pub fn new(text: impl Into<String>) -> Result<Self, BadName> {
                validate(text.into()).map(Self)
            }

            /// The name as text.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl TryFrom<String> for $name {
            type Error = BadName;

            fn try_from(text: String) -> Result<Self, BadName> {
                Self::new(text)
            }
        }

        impl From<$name> for String {
            fn from(name: $name) -> Self {
                name.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }
    };
}

name! {
    /// The name of a signal, unique in its session; `Sensor_1`, `Shear.Strokes`, `axis[3].position`.
    SignalName
}
name! {
    /// The name of a client, unique in its session; `plant`, `plc`.
    ClientName
}

/// The candidate nearest to `wanted`, if any is near enough to have been meant.
pub fn nearest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|candidate| {
            (strsim::normalized_damerau_levenshtein(&wanted.to_lowercase(), &candidate.to_lowercase()), candidate)
        })
        .filter(|(score, _)| *score >= 0.6)
        .max_by(|(a, name_a), (b, name_b)| a.total_cmp(b).then(name_b.cmp(name_a)))
        .map(|(_, candidate)| candidate)
}

/// The nearest of `candidates` as a hint, if any is near enough to have been meant.
pub fn did_you_mean<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(wanted, candidates).map(|name| format!("did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        assert!(SignalName::new("axis[3].position").is_ok());
        assert!(SignalName::new("_x").is_ok());
        for bad in ["", "3x", "a b", "é", ".x"] {
            assert!(SignalName::new(bad).is_err(), "{bad}");
        }
        assert!(SignalName::new("x".repeat(129)).is_err());
    }

    #[test]
    fn the_nearest_name_is_found() {
        let names = ["Sensor_1", "Sensor_2", "Position_1"];
        assert_eq!(nearest("Senosr_1", names), Some("Sensor_1"));
        assert_eq!(nearest("sensor_2", names), Some("Sensor_2"));
        assert_eq!(nearest("conveyor", names), None);
    }
}
