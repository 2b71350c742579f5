//! What a recording was made of, and whether it can be run again.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use onescan_recording::Recording;
use onescan_recording::event::EventKind;
use onescan_scenario::load::kept_as;
use onescan_scenario::{Mode, Scenario};
use onescan_server::operation::OperatorInput;
use onescan_server::time::VirtualTime;

use super::ViewError;
use crate::error::Usage;
use crate::past::{Kept, store::Mark};
use crate::run::{cut_short, forked};

/// A recording that can be run again.
pub(super) struct Recorded {
    pub(super) recording: Recording,
    pub(super) scenario: Scenario,
    /// What operators did since the session began, or was last reset.
    pub(super) inputs: Vec<OperatorInput>,
    pub(super) end: VirtualTime,
    /// Where the recorded scenario is.
    path: PathBuf,
}

impl Recorded {
    /// Opens a recording, and reads all of it once: what is damaged is found before anything is shown.
    ///
    /// # Errors
    /// It is damaged, or cannot be run again; which client of it cannot is said by name.
    pub(super) fn open(folder: &Path) -> Result<Self, ViewError> {
        let recording = Recording::open(folder)?;
        cut_short::report(&recording);
        let refuse = |why: String| Usage::new(format!("{} cannot be shown: {why}", folder.display()), None);
        let header = recording.header();
        if Mode::named(&header.provenance.mode) != Some(Mode::Lockstep) {
            return Err(refuse(format!("a run in mode {} cannot be repeated", header.provenance.mode)).into());
        }
        if header.first_step.0 != 0 {
            return Err(
                refuse("the run went on from a checkpoint, which is not part of the recording".to_owned()).into()
            );
        }
        let steps = recording.steps().ok_or_else(|| refuse("it has no step".to_owned()))?;
        let kept = &header.provenance;
        let path = kept_as(&recording.scenario(), &kept.scenario, kept.file.as_deref());
        let mut scenario = Scenario::load_case(&path, header.provenance.case.as_deref())?;
        for client in &header.provenance.operated {
            scenario.operate(client)?;
        }
        if let Some(why) = forked::fork_blocker(&scenario, None) {
            return Err(refuse(why).into());
        }
        let mut end = VirtualTime::ZERO;
        recording.each(&[], steps, &mut |_, row| end = row.t_v)?;
        let inputs = last_life(&recording)?;
        Ok(Self { recording, scenario, inputs, end, path })
    }

    /// Leaves what operators did for those who show moments of it.
    pub(super) fn leave_inputs(&self, kept: &Kept) {
        let mut kept = kept.lock();
        kept.keep(0, Mark::beginning());
        self.inputs.iter().for_each(|input| kept.note(input));
    }

    /// When the recorded run was to be complete.
    pub(super) fn until(&self) -> VirtualTime {
        self.recording.header().provenance.until
    }

    /// What is typed to run the recorded scenario.
    pub(super) fn words(&self) -> Vec<OsString> {
        let provenance = &self.recording.header().provenance;
        let mut words: Vec<OsString> = vec![self.path.clone().into()];
        let mut add = |option: &str, value: String| words.extend([option.into(), value.into()]);
        if let Some(case) = &provenance.case {
            add("--case", case.clone());
        }
        for client in &provenance.operated {
            add("--operator", client.to_string());
        }
        words
    }
}

/// What operators did since the session began, or was last reset: the trajectory begins there, too.
fn last_life(recording: &Recording) -> Result<Vec<OperatorInput>, ViewError> {
    let began = recording.events()?.iter().filter(|event| matches!(event.what, EventKind::Began)).count();
    let last = began.saturating_sub(1) as u64;
    let inputs = recording.operator_inputs()?.into_iter().filter(|input| input.resets == last);
    Ok(inputs.map(|input| OperatorInput { resets: 0, ..input }).collect())
}
