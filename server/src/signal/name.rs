//! Names of signals and clients: short, printable, one spelling.

use std::fmt;

use onescan_base::foreign::one_line;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Longest name of a signal or client, in bytes.
pub const NAME_BYTES_MAX: usize = 128;

/// Why a text cannot name a signal or client.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "`{}` is not a name: use letters, digits, `_`, `.`, `-`, `[` and `]`, beginning with a letter or `_`, \
     128 characters at most",
    one_line(.0)
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
}
