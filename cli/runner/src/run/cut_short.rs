//! Recordings that do not hold all of their run: said once to whoever reads one.

use onescan_base::notice::NOTICE;
use onescan_recording::{Recording, place};

use super::record_lock;

/// Says of a recording that its run was cut short, or has not come to its end yet.
pub fn report(recording: &Recording) {
    if recording.is_whole() {
        return;
    }
    let folder = recording.folder();
    let holds = match recording.steps() {
        Some(steps) => format!("it holds steps {} to {}", steps.start(), steps.end()),
        None => "it holds no step".to_owned(),
    };
    if record_lock::is_held(folder) {
        tracing::info!(target: NOTICE, "{} is being recorded: {holds} so far", folder.display());
        return;
    }
    let before = place::kept_in(folder).map(|path| format!("; what it was to replace is in {}", path.display()));
    let before = before.unwrap_or_default();
    tracing::info!(target: NOTICE, "{} is cut short, its run has not come to its end: {holds}{before}", folder.display());
}
