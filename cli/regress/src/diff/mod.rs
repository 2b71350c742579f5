//! `onescan diff`: where two recordings part, and why; where two snapshots do.
//!
//! | module | subject |
//! |---|---|
//! | [`first`] | the first step that differs, by digest or by value |
//! | [`cause`] | who wrote what differs there: client, statement, calls |
//! | [`parting`] | the first decision of a PLC that went another way |
//! | [`sources`] | what differs between the recorded scenarios |
//! | [`report`] | for people and machines |
//! | [`trajectory`] | two snapshots of trajectories |

pub mod cause;
mod error;
pub mod first;
pub mod parting;
pub mod report;
pub mod sources;
pub mod trajectory;

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_recording::event::EventKind;
use onescan_recording::{Recording, RecordingError};
use onescan_report::OutputError;
use onescan_server::end::Failure;
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::time::VirtualTime;

pub use error::DiffError;

use onescan_runner::error::ExitCode;
use onescan_runner::error::Usage;
use onescan_runner::format::Format;
use onescan_runner::run::cut_short;

use first::{Comparison, Divergence};
use report::Report;
use trajectory::TrajectoryReport;

/// What is compared, and how the result is shown.
#[derive(Clone, Debug)]
pub struct DiffConfig {
    /// The two recordings, or two files with snapshots.
    pub recordings: [PathBuf; 2],
    /// What was before does not count.
    pub since: VirtualTime,
    /// Only these signals count; all without patterns.
    pub signals: Vec<SignalPattern>,
    /// For whom the report is.
    pub format: Format,
}

/// Compares, and writes what was found to `out`.
///
/// # Errors
/// A recording that cannot be read, a signal that neither has.
pub fn diff(config: &DiffConfig, out: &mut dyn Write) -> Result<ExitCode, DiffError> {
    let [a, b] = &config.recordings;
    match [a, b].map(|path| path.is_file()) {
        [true, true] => return snapshots(config, out),
        [false, false] => {}
        [is_snapshot, _] => {
            let (file, folder) = if is_snapshot { (a, b) } else { (b, a) };
            let message = format!("{} is a file and {} is not", file.display(), folder.display());
            let help = "compare two recordings, which are folders, or two snapshots".to_owned();
            return Err(Usage::new(message, Some(help)).into());
        }
    }
    let report = compare(a, b, config.since, &config.signals)?;
    match config.format {
        Format::Human => report.write(out),
        Format::Json => report.write_json(out),
    }
    .map_err(OutputError)?;
    Ok(if report.is_equal() { ExitCode::Ok } else { ExitCode::Unmet })
}

fn snapshots(config: &DiffConfig, out: &mut dyn Write) -> Result<ExitCode, DiffError> {
    let [a, b] = &config.recordings;
    let report = TrajectoryReport::of([a, b], config.since, &config.signals)?;
    match config.format {
        Format::Human => report.write(out),
        Format::Json => report.write_json(out),
    }
    .map_err(OutputError)?;
    Ok(if report.is_equal() { ExitCode::Ok } else { ExitCode::Unmet })
}

/// Compares two recordings and asks for the cause.
///
/// # Errors
/// A recording that cannot be read, a signal that neither has.
pub fn compare(a: &Path, b: &Path, since: VirtualTime, signals: &[SignalPattern]) -> Result<Report, DiffError> {
    let recordings = [Recording::open(a)?, Recording::open(b)?];
    recordings.iter().for_each(cut_short::report);
    let comparison = Comparison::new(&recordings, since, signals)?;
    let divergence = comparison.first()?;
    let compared = comparison.compared();
    let causes = match &divergence {
        Some(Divergence { differences, at, ended, .. }) => {
            cause::causes(&recordings, differences, (*at, ended.is_some()))
        }
        None => cause::Causes::default(),
    };
    let around = match &divergence {
        Some(found) => comparison.around(found)?,
        // Recordings that are equal part nowhere, so that there is nothing around it.
        None => first::Around::default(),
    };
    let files = sources::differing(&recordings);
    let ended = divergence.as_ref().and_then(|found| found.ended);
    let failure = ended.map(|ended| failure_of(&recordings[ended])).transpose()?.flatten();
    Ok(Report { recordings, compared, divergence, failure, causes, around, files })
}

/// How a client of a recorded run failed, if one did.
fn failure_of(recording: &Recording) -> Result<Option<Failure>, RecordingError> {
    let events = recording.events()?;
    Ok(events.into_iter().rev().find_map(|event| match event.what {
        EventKind::Failed { failure } => Some(failure),
        _ => None,
    }))
}
