//! The past of a session: moments of it are kept at growing distances, and any other is shown by an exact re-run.
//!
//! | module | subject |
//! |---|---|
//! | [`store`] | what is kept, within a budget of memory |
//! | [`keep`] | a running session leaves its past there |
//! | [`rewind`] | a moment of it again, on a thread of its own |
//! | [`trace`] | what signals did in a span of it, in few points |
//!
//! Nothing of this reaches the session that runs: a checkpoint changes nothing in it, and what is re-run is another session.

pub(crate) mod keep;
pub(crate) mod rewind;
pub(crate) mod store;
pub(crate) mod trace;

use std::fmt;
use std::str::FromStr;

pub(crate) use keep::Keeper;
pub(crate) use rewind::{Form, Moment, PastReader, Rewinder};
pub(crate) use store::Kept;
pub(crate) use trace::{Points, Span};

/// How much memory the past of a session may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    pub bytes: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { bytes: 256 << 20 }
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const UNITS: [(usize, &str); 3] = [(1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
        match UNITS.iter().find(|(unit, _)| self.bytes >= *unit && self.bytes.is_multiple_of(*unit)) {
            Some((unit, name)) => write!(f, "{}{name}", self.bytes / unit),
            None => write!(f, "{}B", self.bytes),
        }
    }
}

impl FromStr for Budget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not an amount of memory: write it as in `256MiB`, `4GiB` or `0`");
        let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
        let (number, unit) = text.split_at(end);
        let factor = match unit.trim() {
            "" | "B" => 1,
            "KiB" => 1 << 10,
            "MiB" => 1 << 20,
            "GiB" => 1 << 30,
            _ => return Err(wrong()),
        };
        let bytes = number.parse::<usize>().ok().and_then(|number| number.checked_mul(factor)).ok_or_else(wrong)?;
        Ok(Self { bytes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_written_as_they_are_read() {
        for text in ["256MiB", "3GiB", "10KiB", "17B", "0B"] {
            assert_eq!(text.parse::<Budget>().map(|budget| budget.to_string()), Ok(text.to_owned()));
        }
        for text in ["", "MiB", "256MB", "-1", "99999999999999999999GiB", "18014398509481984KiB"] {
            assert!(text.parse::<Budget>().is_err(), "{text}");
        }
    }
}
