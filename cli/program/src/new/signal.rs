//! What a list becomes: signals, and who runs as the PLC.

use crate::io_list::IoPoint;

/// A signal of the scenario.
#[derive(Clone, Debug)]
pub struct Signal {
    pub name: String,
    /// What it is in the list.
    pub point: IoPoint,
}

/// Who runs as the PLC. `bind` has the variables of signals that are called otherwise.
#[derive(Clone, Debug)]
pub enum Plc {
    /// A program with inputs and outputs and nothing in it.
    StandIn {
        /// Signals and their variables.
        bind: Vec<(String, String)>,
    },
    /// The sources that the list was read from.
    Sources {
        /// Their places, seen from the scenario's folder.
        files: Vec<String>,
        /// The programs, if the sources do not say when they run.
        programs: Vec<String>,
        /// Signals and their variables.
        bind: Vec<(String, String)>,
    },
}
