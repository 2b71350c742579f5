//! A scenario with everything that it takes in, as one file.

mod error;

use std::io::Write;
use std::path::PathBuf;

use onescan_report::OutputError;
use onescan_scenario::Scenario;

pub use error::ShowError;

use onescan_runner::format::Format;

#[derive(Clone, Debug)]
pub struct ShowConfig {
    pub scenario: PathBuf,
    /// For whom: TOML for people, JSON for machines.
    pub format: Format,
}

/// Writes the scenario so that it loads to the same session.
///
/// # Errors
/// See [`ShowError`].
pub fn write(config: &ShowConfig, out: &mut dyn Write) -> Result<(), ShowError> {
    let scenario = Scenario::load(&config.scenario)?;
    match config.format {
        Format::Human => write!(out, "{}", scenario.to_toml()?).map_err(OutputError)?,
        Format::Json => writeln!(out, "{}", scenario.to_json()?).map_err(OutputError)?,
    }
    Ok(())
}
