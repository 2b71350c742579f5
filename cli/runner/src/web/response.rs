//! What the server sends to a viewer as text, and how long it waits for one: `web/PROTOCOL.md`.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use axum::extract::ws::{Message, WebSocket};
use schemars::JsonSchema;
use serde::Serialize;
use tokio::time::timeout;

use super::KeptCase;
use super::alarms::Change;
use super::lesson::{Attempt, Drive};
use super::maps::Cells;
use super::online::Seen;
use super::seats::SeatView;
use super::verdicts::Standing;
use crate::past::Points;

/// How long one message may take to a viewer that does not read before it is left.
const PATIENCE: Duration = Duration::from_secs(20);

/// A text for a viewer, as JSON.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "lowercase")]
#[schemars(rename = "Message")]
pub(super) enum Response {
    /// How the session is. `seat` is as this viewer sees it; `failed` are the failures at work, as `component.mode`; `forced` and
    /// `disturbed` are the numbers of the signals that are forced and of the faults on the way of signals that are at work;
    /// `changed` are the parameters of components that were changed, as `component.key`, with their values; `shown_ns` is null at the live edge, `past_ns` where no past is kept.
    Status {
        state: SessionState,
        digest: Option<String>,
        #[schemars(default)]
        pace: String,
        #[schemars(default)]
        seat: SeatView,
        #[serde(skip_serializing_if = "BTreeSet::is_empty")]
        #[schemars(default)]
        failed: BTreeSet<String>,
        #[serde(skip_serializing_if = "BTreeSet::is_empty")]
        #[schemars(default)]
        forced: BTreeSet<usize>,
        #[serde(skip_serializing_if = "BTreeSet::is_empty")]
        #[schemars(default)]
        disturbed: BTreeSet<usize>,
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        #[schemars(default)]
        changed: BTreeMap<String, String>,
        shown_ns: Option<u64>,
        past_ns: Option<[u64; 2]>,
    },
    /// The places of the looks whose condition holds.
    Looks { active: Vec<usize> },
    /// The values of the states of a drawing, in their order; null where there is none.
    States { drawing: usize, instance: usize, values: Vec<Option<f64>> },
    /// Somebody shows this view to all.
    View { view: String },
    /// Values of variables that have changed, by their numbers; all variables that are forced; file and line of all statements
    /// that have been executed, if the run notes it.
    Variables {
        #[serde(flatten)]
        seen: Seen,
    },
    /// Where the cells of a map lie: one edge more than cells. It comes before their values, and again when it changes.
    Map {
        #[serde(flatten)]
        cells: Cells,
    },
    /// What has become of an expectation: `pass`, `fail` or `open`.
    Verdict {
        #[serde(flatten)]
        standing: Standing,
    },
    /// Where the page is of a session that goes on from a moment of the past.
    Forked {
        t_ns: u64,
        /// It becomes a link, so nothing else than a page's address is one.
        #[schemars(regex(pattern = r#"^https?://[^\s"'<>]+$"#))]
        url: String,
    },
    /// What signals did in a span of the past, by their order in the question: times in ns with values, each until the next.
    Trace { from_ns: u64, until_ns: u64, values: Vec<Points> },
    /// What operators have done, as a case: its text, and the file that it belongs into. `may_save` says whether this session
    /// writes it there, `saved` that it has.
    Case {
        #[serde(flatten)]
        kept: KeptCase,
    },
    /// Changes of alarms, in the order of virtual time; `all` says that none came before these.
    Alarms { all: bool, changes: Vec<Change> },
    /// How the attempt at a lesson goes: `result` comes when it is over.
    Lesson {
        #[serde(flatten)]
        attempt: Attempt,
    },
    /// How far real PLCs are on their way to where an attempt at a lesson begins; null when they are there. Nobody operates
    /// anything meanwhile.
    Drive { now: Option<Drive> },
    /// Marked in the trends, and listed below the alarms.
    Event { t_ns: u64, kind: &'static str, text: String },
    /// Shown to the viewer.
    Error { message: String },
}

/// How a session is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum SessionState {
    Run,
    Hold,
    End,
    Recorded,
    /// Real PLCs are driven to where an attempt at a lesson begins.
    Driven,
}

/// The viewer is gone, or does not read.
pub(super) struct Gone;

/// Sends a text.
///
/// # Errors
/// The viewer is gone, or does not read.
pub(super) async fn notify(socket: &mut WebSocket, response: &Response) -> Result<(), Gone> {
    let text = serde_json::to_string(response).map_err(|_| Gone)?;
    send(socket, Message::Text(text.into())).await
}

/// Sends a message, and waits until the viewer has taken it, [`PATIENCE`] at most.
///
/// # Errors
/// The viewer is gone, or does not read.
pub(super) async fn send(socket: &mut WebSocket, message: Message) -> Result<(), Gone> {
    match timeout(PATIENCE, socket.send(message)).await {
        Ok(Ok(())) => Ok(()),
        Ok(Err(_)) | Err(_) => Err(Gone),
    }
}
