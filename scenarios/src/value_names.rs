//! Names of a signal's values, as a PLC's enumeration has them: plots show them in place of numbers.

use std::collections::BTreeMap;

use onescan_base::SignalType;
use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

/// `{ 0 = "Idle", 1 = "Running" }`.
#[derive(Clone, Debug, Default, PartialEq, Eq, JsonSchema)]
pub struct ValueNames(BTreeMap<i64, String>);

impl<'de> Deserialize<'de> for ValueNames {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written = BTreeMap::<String, String>::deserialize(deserializer)?;
        let number = |(value, name): (String, String)| match value.parse() {
            Ok(value) => Ok((value, name)),
            Err(_) => Err(D::Error::custom(format!("`{value}` is not a whole number; names are given as {EXAMPLE}"))),
        };
        written.into_iter().map(number).collect::<Result<_, _>>().map(Self)
    }
}

const EXAMPLE: &str = "`{ 0 = \"Idle\", 1 = \"Running\" }`";

impl ValueNames {
    /// Values and their names, by value.
    pub fn pairs(&self) -> Vec<(i64, String)> {
        self.0.iter().map(|(value, name)| (*value, name.clone())).collect()
    }

    /// Whether there are any.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Why a signal of this type cannot have these names, and what to do.
    pub(crate) fn misfit(&self, ty: SignalType) -> Option<(String, String)> {
        if self.0.is_empty() {
            return None;
        }
        let range = match ty {
            SignalType::Elementary(ty) if ty.is_integer() || ty.is_bits() => ty.range(),
            _ => None,
        };
        let Some((least, greatest)) = range else {
            let help = "integers and bit strings have values with names, as those of an enumeration";
            return Some((format!("values of {ty} have no names"), help.to_owned()));
        };
        let outside = self.0.keys().find(|value| !(least..=greatest).contains(&i128::from(**value)))?;
        Some((format!("{outside} is not a value of {ty}"), format!("{ty} goes from {least} to {greatest}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Result<ValueNames, toml::de::Error> {
        #[derive(Deserialize)]
        struct Signal {
            names: ValueNames,
        }
        toml::from_str::<Signal>(text).map(|signal| signal.names)
    }

    #[test]
    fn names_are_sorted_by_value() {
        let read = names("names = { 10 = \"Stop\", -1 = \"Fault\", 2 = \"Run\" }").expect("names");
        let pairs = [(-1, "Fault"), (2, "Run"), (10, "Stop")].map(|(value, name)| (value, name.to_owned()));
        assert_eq!(read.pairs(), pairs);
        assert_eq!(read.misfit(SignalType::INT), None);
    }

    #[test]
    fn what_does_not_fit_is_reported() {
        let wrong = names("names = { a = \"Stop\" }").expect_err("no number");
        assert!(wrong.message().contains("`a` is not a whole number"), "{wrong}");
        let read = names("names = { 300 = \"Stop\" }").expect("names");
        assert!(read.misfit(SignalType::USINT).is_some_and(|(message, _)| message == "300 is not a value of USINT"));
        assert!(read.misfit(SignalType::LREAL).is_some_and(|(message, _)| message == "values of LREAL have no names"));
    }
}
