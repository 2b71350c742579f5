//! The start logic of a scenario, `start`: what must hold before virtual time runs.

use onescan_server::signal::SignalName;

use crate::error::Wrong;
use crate::expect::Present;
use crate::expectations::place_within;
use crate::file::ScenarioFile;

/// What must hold on the initial values, and on what operators write over them.
#[derive(Clone, Debug)]
pub struct StartLogic {
    /// As it is written.
    pub formula: String,
    pub present: Present,
    /// Its signals, in the order of its columns.
    pub signals: Vec<SignalName>,
}

/// The start logic of a file that says of one.
pub(crate) fn bind(file: &ScenarioFile, text: &str) -> Result<Option<StartLogic>, Wrong> {
    let Some(written) = &file.start else { return Ok(None) };
    let mut columns = Vec::new();
    let present = Present::parse(written.get_ref(), &file.known_signals(), &mut columns).map_err(|error| Wrong {
        message: error.to_string(),
        place: place_within(written, text, &error.place),
        help: error.help,
    })?;
    // Columns are names of the file's own signals.
    let signals = columns.iter().filter_map(|column| SignalName::new(column.as_str()).ok()).collect();
    Ok(Some(StartLogic { formula: written.get_ref().clone(), present, signals }))
}
