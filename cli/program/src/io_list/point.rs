//! One input or output of a PLC.

use std::fmt;
use std::sync::Arc;

use onescan_base::SignalType;
use serde::Serialize;

/// Which way a value goes, as the PLC sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// The plant writes it, the PLC reads it.
    Input,
    /// The PLC writes it.
    Output,
}

/// A place in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    pub file: Arc<str>,
    /// The line, or the row of a sheet, from 1; nothing where there are none.
    pub line: Option<u32>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file),
            None => f.write_str(&self.file),
        }
    }
}

/// An input or output of elementary type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IoPoint {
    /// Its name as the list spells it, as in `MAIN.Axis[3].Position`.
    pub name: String,
    pub ty: SignalType,
    /// Which way it goes.
    pub direction: Direction,
    /// Its address in the PLC's I/O image, as in `%I0.3`.
    pub address: Option<String>,
    /// How a gateway's map writes it: a symbol, or a node.
    pub symbol: Option<String>,
    /// What the list says about it.
    pub comment: Option<String>,
    /// Where it is in the list.
    pub at: Place,
}

/// Something of the list that is not a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// What it is called.
    pub name: String,
    /// Why it is none.
    pub why: String,
    /// Where it is in the list.
    pub at: Place,
}
