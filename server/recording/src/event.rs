//! What happened in a session beside its steps: `events.jsonl`, a JSON object a line.

use std::path::Path;

use onescan_base::disk::Disk;
use onescan_base::lines::{self, Lines};
use onescan_base::regular::{self, Limit};
use serde::{Deserialize, Serialize};

use onescan_server::end::{Failure, SessionEnd};
use onescan_server::observer::RecordError;
use onescan_server::operation::{Author, Operation, OperatorInput};
use onescan_server::time::{StepCount, VirtualTime};

/// An event, and the step boundary that it belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// The last step committed before it.
    pub step: StepCount,
    #[serde(rename = "t_v_ns")]
    pub t_v: VirtualTime,
    #[serde(flatten)]
    pub what: EventKind,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum EventKind {
    /// The session began, or restarted after a reset.
    Began,
    /// An operator did something.
    Operator {
        #[serde(flatten)]
        operation: Operation,
    },
    /// The session's own timeline did something: a case's force or failure.
    Timeline {
        #[serde(flatten)]
        operation: Operation,
    },
    /// A client failed, which ended the session.
    Failed {
        /// Who, where and why.
        failure: Failure,
    },
    /// The session is over.
    Ended {
        /// `completed`, `stopped` or `failed`.
        status: String,
    },
    /// The run went against an expectation of its scenario.
    Violated { expectation: String },
}

/// The events as they are written.
#[derive(Debug)]
pub(super) struct EventLog {
    lines: Lines,
    path: String,
}

impl EventLog {
    pub(super) fn create(disk: &dyn Disk, path: &Path) -> Result<Self, RecordError> {
        Self::of(path, Lines::create(disk, path))
    }

    fn of(path: &Path, lines: std::io::Result<Lines>) -> Result<Self, RecordError> {
        let path = path.display().to_string();
        match lines {
            Ok(lines) => Ok(Self { lines, path }),
            Err(source) => Err(RecordError { path, source }),
        }
    }

    pub(super) fn push(&mut self, event: &Event) -> Result<(), RecordError> {
        let line = serde_json::to_vec(event).map_err(std::io::Error::from);
        let pushed = line.and_then(|line| self.lines.push(&line));
        pushed.map_err(|source| RecordError { path: self.path.clone(), source })
    }

    pub(super) fn end(&mut self, end: &SessionEnd, step: StepCount, t_v: VirtualTime) -> Result<(), RecordError> {
        let status = match end {
            SessionEnd::Completed { .. } => "completed",
            SessionEnd::Stopped { .. } => "stopped",
            SessionEnd::Failed(failure) => {
                self.push(&Event { step, t_v, what: EventKind::Failed { failure: failure.clone() } })?;
                "failed"
            }
        };
        self.push(&Event { step, t_v, what: EventKind::Ended { status: status.to_owned() } })
    }
}

/// Adds what only became known after the session was over.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn append(disk: &dyn Disk, path: &Path, events: &[Event]) -> Result<(), RecordError> {
    let mut log = EventLog::of(path, Lines::append_to(disk, path))?;
    events.iter().try_for_each(|event| log.push(event))
}

/// All whole events of a file. A line that was cut off, by a kill or a disk without room, is left out.
///
/// # Errors
/// The file cannot be read, or a line is not an event.
pub fn read(path: &Path) -> std::io::Result<Vec<Event>> {
    let bytes = regular::read(path, Limit::DATA)?;
    let mut events = Vec::new();
    for (place, line) in lines::whole(&bytes) {
        match serde_json::from_slice(line) {
            Ok(event) => events.push(event),
            Err(cut) if cut.is_eof() => {}
            Err(wrong) => return Err(std::io::Error::other(format!("line {}: {wrong}", place + 1))),
        }
    }
    Ok(events)
}

/// The inputs of operators among `events`.
pub fn operator_inputs(events: &[Event]) -> Vec<OperatorInput> {
    let mut began = 0_u64;
    let mut inputs = Vec::new();
    for Event { step, t_v, what } in events {
        match what {
            EventKind::Began => began += 1,
            EventKind::Operator { operation } => inputs.push(OperatorInput {
                resets: began.saturating_sub(1),
                step: *step,
                t_v: *t_v,
                author: Author::Operator,
                operation: operation.clone(),
            }),
            // What the timeline did comes along with the case; the rest changes nothing.
            EventKind::Timeline { .. }
            | EventKind::Failed { .. }
            | EventKind::Ended { .. }
            | EventKind::Violated { .. } => {}
        }
    }
    inputs
}
