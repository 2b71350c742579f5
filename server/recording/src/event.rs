//! What happened in a session beside its steps: `events.jsonl`, a JSON object a line.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;

use onescan_base::regular;
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
    file: File,
    path: String,
}

impl EventLog {
    pub(super) fn create(path: &Path) -> Result<Self, RecordError> {
        let error = |source| RecordError { path: path.display().to_string(), source };
        Ok(Self { file: File::create(path).map_err(error)?, path: path.display().to_string() })
    }

    /// Each line is written in one piece, so that a kill leaves whole lines.
    pub(super) fn push(&mut self, event: &Event) -> Result<(), RecordError> {
        let error = |source| RecordError { path: self.path.clone(), source };
        self.file.write_all(&line(event).map_err(error)?).map_err(error)
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

fn line(event: &Event) -> std::io::Result<Vec<u8>> {
    let mut line = serde_json::to_vec(event)?;
    line.push(b'\n');
    Ok(line)
}

/// Adds what only became known after the session was over.
///
/// # Errors
/// The file cannot be written.
pub fn append(path: &Path, events: &[Event]) -> Result<(), RecordError> {
    let error = |source| RecordError { path: path.display().to_string(), source };
    let mut file = OpenOptions::new().append(true).open(path).map_err(error)?;
    for event in events {
        file.write_all(&line(event).map_err(error)?).map_err(error)?;
    }
    Ok(())
}

/// All whole events of a file; a last line that was cut off is left out.
///
/// # Errors
/// The file cannot be read, or a line before the last is not an event.
pub fn read(path: &Path) -> std::io::Result<Vec<Event>> {
    let mut events = Vec::new();
    let mut reader = BufReader::new(regular::open(path)?);
    let mut line = String::new();
    while reader.read_line(&mut line)? > 0 {
        if !line.ends_with('\n') {
            break;
        }
        let wrong = |error| std::io::Error::other(format!("line {}: {error}", events.len() + 1));
        events.push(serde_json::from_str(&line).map_err(wrong)?);
        line.clear();
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
