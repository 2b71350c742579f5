//! Who wrote what differs.
//!
//! The recorded scenarios are run again up to the first difference, with statements that report what
//! they write and which way they go. A re-run whose digest is not that of the recording says nothing, and is not believed.

use std::collections::BTreeSet;
use std::sync::PoisonError;

use onescan_recording::Recording;
use onescan_scenario::load::kept_as;
use onescan_scenario::{Mode, Scenario, ScenarioError};
use onescan_server::operation::OperatorInput;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;
use onescan_soft_plc::{Traced, Written};

use super::first::Difference;
use super::parting::{Parting, parting};
use crate::why::{self, Side, Why};
use onescan_runner::run::rerun::{Rerun, rerun};

/// Who wrote one signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cause {
    pub signal: SignalName,
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
    /// Where the PLCs that wrote them first went another way, if they did.
    pub partings: Vec<Parting>,
    /// The way from a signal back to where the PLCs' memories first part.
    pub why: Option<Why>,
    /// Why statements are not known, for each run of which they are not.
    pub unknown: [Option<String>; 2],
}

/// Finds who wrote `differences` at `at`. Where one of the runs `ended` there, it is looked into the step in which it did:
/// a PLC that stops has gone another way before.
pub(super) fn causes(
    recordings: &[Recording; 2],
    differences: &[Difference],
    (at, ended): (VirtualTime, bool),
) -> Causes {
    let signals: BTreeSet<SignalName> = differences.iter().map(|difference| difference.signal.clone()).collect();
    let mut unknown = [None, None];
    let mut traced: [Traced; 2] = Default::default();
    let mut runs = [None, None];
    for (index, recording) in recordings.iter().enumerate() {
        match repeatable(recording).and_then(|run| Ok((again(recording, &run, &signals, at)?, run))) {
            Ok((found, run)) => (traced[index], runs[index]) = (found, Some(run)),
            Err(why) => unknown[index] = Some(why),
        }
    }
    let why = way_back(&runs, differences, (at, ended));
    if let Err(error) = &why {
        unknown[1].get_or_insert_with(|| error.to_string());
    }
    let cause = |difference: &Difference| Cause {
        signal: difference.signal.clone(),
        client: difference.writer.clone(),
        written: traced.each_ref().map(|traced| traced.writers.get(&difference.signal).cloned()),
    };
    let writers: BTreeSet<&ClientName> = differences.iter().filter_map(|one| one.writer.as_ref()).collect();
    let [a, b] = &traced;
    let parted = writers.into_iter().filter_map(|client| parting(client, a.ways.get(client)?, b.ways.get(client)?));
    let partings = parted.collect();
    Causes { signals: differences.iter().map(cause).collect(), partings, why: why.unwrap_or(None), unknown }
}

/// A recorded run that can be done again.
struct Repeatable {
    scenario: Scenario,
    inputs: Vec<OperatorInput>,
}

/// The way back from the signals that differ, if both runs can be done again.
fn way_back(
    runs: &[Option<Repeatable>; 2],
    differences: &[Difference],
    (at, ended): (VirtualTime, bool),
) -> Result<Option<Why>, ScenarioError> {
    let [Some(a), Some(b)] = runs else { return Ok(None) };
    let at = if ended { at + a.scenario.plan().step() } else { at };
    let sides = [a, b].map(|run| Side { scenario: &run.scenario, inputs: run.inputs.clone() });
    let signals: Vec<SignalName> = differences.iter().map(|difference| difference.signal.clone()).collect();
    why::explain(sides.each_ref(), &signals, at)
}

/// What a recording was made of. An error says in words why it cannot be run again.
fn repeatable(recording: &Recording) -> Result<Repeatable, String> {
    let header = recording.header();
    if Mode::named(&header.provenance.mode) != Some(Mode::Lockstep) {
        return Err(format!("a run in mode {} cannot be repeated", header.provenance.mode));
    }
    let kept = &header.provenance;
    let path = kept_as(&recording.scenario(), &kept.scenario, kept.file.as_deref());
    let scenario = Scenario::load_case(&path, kept.case.as_deref()).map_err(|error| error.to_string())?;
    if header.first_step.0 != 0 {
        return Err("the run went on from a checkpoint".to_owned());
    }
    let inputs = recording.operator_inputs().map_err(|error| error.to_string())?;
    Ok(Repeatable { scenario, inputs })
}

/// Runs a recorded scenario again up to `at`. An error says in words why it is not believed.
fn again(
    recording: &Recording,
    run: &Repeatable,
    signals: &BTreeSet<SignalName>,
    at: VirtualTime,
) -> Result<Traced, String> {
    let mut scenario = run.scenario.clone();
    let sink = scenario.trace(signals.clone());
    let Rerun { steps, digest } = rerun(&scenario, at, run.inputs.clone()).map_err(|error| error.to_string())?;
    let recorded = recording.digest(steps.0).map_err(|error| error.to_string())?;
    if digest != Some(recorded) {
        return Err(format!("run again, the scenario has another digest at step {steps}"));
    }
    let found = sink.lock().unwrap_or_else(PoisonError::into_inner).clone();
    Ok(found)
}
