//! What a run says to an expectation, in a word.

use crate::colour::{Colour, Coloured};
use serde::{Deserialize, Serialize};

/// Whether an expectation was met.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It holds, whatever would have come next.
    Met,
    /// The run ended before it could be decided.
    Open,
    /// It does not hold.
    Violated,
}

impl Verdict {
    /// As it is written in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::Open => "open",
            Self::Violated => "violated",
        }
    }

    /// The same for a terminal.
    pub fn coloured(self) -> Coloured<'static> {
        let colour = match self {
            Self::Met => Colour::Good,
            Self::Open => Colour::Notable,
            Self::Violated => Colour::Bad,
        };
        colour.of(self.word())
    }
}
