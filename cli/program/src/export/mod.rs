//! `onescan export`: a recording's trajectory in another form.

mod error;

use std::path::PathBuf;

use onescan_recording::{ExportFormat, Recording, RecordingError};
use onescan_report::file;
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::time::VirtualTime;

pub use error::ExportError;

use onescan_runner::error::Usage;
use onescan_runner::run::cut_short;

/// What is exported, and where to.
#[derive(Clone, Debug)]
pub struct ExportConfig {
    pub recording: PathBuf,
    pub format: ExportFormat,
    /// The file; it appears whole or not at all.
    pub output: PathBuf,
    /// The signals; all without patterns.
    pub signals: Vec<SignalPattern>,
    /// The first and the last virtual time.
    pub times: [VirtualTime; 2],
}

/// Writes the file.
///
/// # Errors
/// A recording that cannot be read, a signal that it has not, times without a step, a file that
/// cannot be written.
pub fn export(config: &ExportConfig) -> Result<(), ExportError> {
    let recording = Recording::open(&config.recording)?;
    cut_short::report(&recording);
    let [from, to] = config.times;
    let Some(steps) = recording.steps_between(from, to)? else {
        let span = if to == VirtualTime::MAX { format!("from {from} on") } else { format!("from {from} to {to}") };
        let message = format!("{} has no step {span}", recording.folder().display());
        return Err(Usage::new(message, None).into());
    };
    let output = file::followed(&config.output);
    let file = file::begin_whole(&output)?;
    let out = file.reopen().map_err(RecordingError::Output)?;
    recording.export(config.format, &config.signals, steps, out)?;
    file::end_whole(file, &output)?;
    file::wrote(&config.output);
    Ok(())
}
