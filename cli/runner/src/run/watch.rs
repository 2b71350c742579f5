//! What watched variables were, for people and machines.

use std::io::Write;

use onescan_scenario::Scenario;
use onescan_server::time::VirtualTime;
use serde::Serialize;

use super::config::{Watch, WatchOn};

/// A value of a watched variable. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WatchedValue {
    /// The variable, as it was asked for.
    pub path: String,
    /// Its value as a literal.
    pub value: String,
    /// The step after which it had the value first.
    #[serde(rename = "since_ns")]
    pub since: VirtualTime,
}

/// All that was seen of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct WatchReport {
    /// The values at the end, or all changes in the order of time.
    pub values: Vec<WatchedValue>,
    /// Changes that are left out because there were too many.
    #[serde(skip_serializing_if = "is_zero")]
    pub left_out: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

impl WatchReport {
    /// What the run that has ended showed; nothing if nothing is watched.
    pub(super) fn take(watch: &Watch, scenario: &Scenario) -> Option<Self> {
        if watch.variables.is_empty() {
            return None;
        }
        let mut seen = scenario.take_sightings();
        if watch.on == WatchOn::End {
            seen.list.sort_by_key(|sighting| sighting.watch);
        }
        let values = seen.list.into_iter().filter_map(|sighting| {
            let request = watch.variables.get(sighting.watch)?;
            let client = request.client.iter().map(|client| format!("{client}:"));
            let path: String = client.chain([request.watch.path.clone()]).collect();
            Some(WatchedValue { path, value: sighting.value, since: sighting.since })
        });
        Some(Self { values: values.collect(), left_out: seen.left_out })
    }

    pub(super) fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        for WatchedValue { path, value, since } in &self.values {
            writeln!(out, "  {since}  {path} = {value}")?;
        }
        match self.left_out {
            0 => Ok(()),
            count => writeln!(out, "  {count} more changes"),
        }
    }
}
