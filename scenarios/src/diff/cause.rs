//! Who wrote what differs.
//!
//! The recorded scenarios are run again up to the first difference, with statements that tell what
//! they write. A re-run whose digest is not that of the recording says nothing, and is not believed.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::PoisonError;

use onescan_clients::soft_plc::Written;
use onescan_server::recording::Recording;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;

use super::first::Difference;
use crate::run::rerun::{Rerun, rerun};
use crate::scenario::Scenario;
use crate::scenario::file::ClientFile;

/// Who wrote one signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cause {
    /// The signal.
    pub signal: SignalName,
    /// Its writer.
    pub client: Option<ClientName>,
    /// The statement that wrote it last, in each run; nothing where none did, or where the writer is
    /// no soft PLC.
    pub written: [Option<Written>; 2],
}

/// What is known of the causes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Causes {
    /// One for each signal that differs.
    pub signals: Vec<Cause>,
    /// Why statements are not known, for each run of which they are not.
    pub unknown: [Option<String>; 2],
}

/// Finds who wrote `differences` at `at`.
pub(super) fn causes(recordings: &[Recording; 2], differences: &[Difference], at: VirtualTime) -> Causes {
    let signals: BTreeSet<SignalName> = differences.iter().map(|difference| difference.signal.clone()).collect();
    let mut unknown = [None, None];
    let mut written: [BTreeMap<SignalName, Written>; 2] = Default::default();
    for (index, recording) in recordings.iter().enumerate() {
        match writers(recording, &signals, at) {
            Ok(found) => written[index] = found,
            Err(why) => unknown[index] = Some(why),
        }
    }
    let cause = |difference: &Difference| Cause {
        signal: difference.signal.clone(),
        client: difference.writer.clone(),
        written: [0, 1].map(|index: usize| written[index].get(&difference.signal).cloned()),
    };
    Causes { signals: differences.iter().map(cause).collect(), unknown }
}

/// Runs a recorded scenario again up to `at`. An error says in words why that cannot be.
fn writers(
    recording: &Recording,
    signals: &BTreeSet<SignalName>,
    at: VirtualTime,
) -> Result<BTreeMap<SignalName, Written>, String> {
    let header = recording.header();
    if header.provenance.mode != "lockstep" {
        return Err(format!("a run in mode {} cannot be repeated", header.provenance.mode));
    }
    let mut scenario = Scenario::load_case(&recording.scenario(), header.provenance.case.as_deref())
        .map_err(|error| error.to_string())?;
    let plc_writes = header.signals.iter().any(|signal| {
        let writer = signal.writer.as_ref().and_then(|writer| scenario.file().clients.get(writer));
        signals.contains(&signal.name) && matches!(writer.map(toml::Spanned::get_ref), Some(ClientFile::SoftPlc { .. }))
    });
    if !plc_writes {
        return Ok(BTreeMap::new());
    }
    if header.first_step.0 != 0 {
        return Err("the run went on from a checkpoint".to_owned());
    }
    let sink = scenario.trace(signals.clone());
    let inputs = recording.operator_inputs().map_err(|error| error.to_string())?;
    let Rerun { steps, digest } = rerun(&scenario, at, inputs).map_err(|error| error.to_string())?;
    let recorded = recording.digest(steps.0).map_err(|error| error.to_string())?;
    if digest != Some(recorded) {
        return Err(format!("run again, the scenario has another digest at step {steps}"));
    }
    let found = sink.lock().unwrap_or_else(PoisonError::into_inner).clone();
    Ok(found)
}
