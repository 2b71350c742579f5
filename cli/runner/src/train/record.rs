//! The record of a session: `session.json` beside the recordings of its attempts, `run-1`, `run-2` and so on.

use std::path::{Path, PathBuf};

use onescan_base::regular;
use onescan_report::{FileError, OutputError, file};
use onescan_server::operation::OperatorInput;
use onescan_server::time::{StepCount, VirtualTime};
use serde::{Deserialize, Serialize};

use super::error::{NoRecord, TrainError};
use super::score::Score;
use crate::error::{Unreadable, Usage};
use crate::run::operator_inputs;

/// The file of a session's record.
pub(super) const FILE_NAME: &str = "session.json";
/// The only version of the format so far.
const VERSION: u32 = 1;

/// Somebody's session with a lesson. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionRecord {
    /// Version of the format: 1.
    pub version: u32,
    pub scenario: String,
    pub lesson: String,
    pub trainee: String,
    /// Whether the last attempt passed.
    pub passed: bool,
    /// All attempts, in their order; the last one counts.
    pub attempts: Vec<AttemptRecord>,
    /// What the expert's recording scores, where the lesson has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expert: Option<AttemptRecord>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttemptRecord {
    /// From 1, also that of its recording.
    pub number: u32,
    /// The prepared state that it goes back to.
    pub start: String,
    /// Where it forks from an earlier attempt; nothing if it begins at the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fork: Option<Fork>,
    /// The digest with which it began.
    pub begin_digest: String,
    /// How it ended, in a word: `completed`, `stopped`, `failed`.
    pub end: String,
    /// Why a client failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Steps from the start of the session.
    pub steps: u64,
    /// The digest at its end.
    pub digest: String,
    pub score: Score,
}

/// Where an attempt leaves another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fork {
    /// The attempt that it leaves.
    pub attempt: u32,
    /// The checkpoint, in steps of the session.
    pub step: u64,
    /// The moment to which the trainer went back: until then it repeats the attempt before.
    pub t_v_ns: u64,
}

impl SessionRecord {
    pub(super) fn new(scenario: &str, lesson: &str, trainee: &str) -> Self {
        Self {
            version: VERSION,
            scenario: scenario.to_owned(),
            lesson: lesson.to_owned(),
            trainee: trainee.to_owned(),
            passed: false,
            attempts: Vec::new(),
            expert: None,
        }
    }

    /// The record in `folder`.
    pub(super) fn read(folder: &Path) -> Result<Self, TrainError> {
        let path = folder.join(FILE_NAME);
        let text = regular::read_text(&path).map_err(Unreadable::at(&path))?;
        let record: Self = serde_json::from_str(&text).map_err(|source| NoRecord { path: path.clone(), source })?;
        if record.version != VERSION {
            let message = format!("{}: version {} of the format is not known", path.display(), record.version);
            return Err(Usage::new(message, None).into());
        }
        Ok(record)
    }

    /// Writes it into `folder`.
    pub(super) fn write(&self, folder: &Path) -> Result<(), TrainError> {
        let mut text = serde_json::to_vec_pretty(self).map_err(|error| OutputError(error.into()))?;
        text.push(b'\n');
        Ok(file::write_whole(&folder.join(FILE_NAME), &text)?)
    }

    /// The last attempt: the one that counts.
    pub fn last(&self) -> Option<&AttemptRecord> {
        self.attempts.last()
    }

    /// All that operators did in attempt `number`, from its start on: what came before its fork is in others.
    pub(super) fn inputs(&self, folder: &Path, number: u32) -> Result<Vec<OperatorInput>, TrainError> {
        let Some(attempt) = self.attempts.iter().find(|attempt| attempt.number == number) else {
            let message = format!("{} has no attempt {number}", folder.display());
            return Err(Usage::new(message, None).into());
        };
        let mut inputs = match attempt.fork {
            // It is an earlier one, so this comes to an end.
            Some(fork) if fork.attempt < number => {
                let mut before = self.inputs(folder, fork.attempt)?;
                before.retain(|input| input.step < StepCount(fork.step));
                before
            }
            Some(_) | None => Vec::new(),
        };
        inputs.extend(operator_inputs(&run_folder(folder, number))?);
        Ok(inputs)
    }
}

/// The recording of an attempt.
pub(super) fn run_folder(folder: &Path, number: u32) -> PathBuf {
    folder.join(format!("run-{number}"))
}

/// Makes the folder of a session; refuses to write over an earlier one unless that is asked for.
pub(super) fn begin(folder: &Path, overwrite: bool) -> Result<(), TrainError> {
    if !overwrite && folder.join(FILE_NAME).exists() {
        let help = "record into another folder, or replace what is there with `--overwrite`".to_owned();
        return Err(Usage::new(format!("{} holds an earlier session", folder.display()), Some(help)).into());
    }
    let made: Result<PathBuf, FileError> = file::create_folder(folder);
    Ok(made.map(drop)?)
}

/// A time for people.
pub(super) fn to_text(t_ns: u64) -> String {
    VirtualTime::from_nanos(t_ns).to_string()
}
