//! What the server sends to a viewer as text, and how long it waits for one: `web/PROTOCOL.md`.

use std::collections::BTreeSet;
use std::time::Duration;

use axum::extract::ws::{Message, WebSocket};
use serde::Serialize;
use tokio::time::timeout;

use super::maps::Cells;
use super::online::Seen;
use super::seats::SeatView;
use super::verdicts::Standing;

/// How long one message may take to a viewer that does not read before it is left.
const PATIENCE: Duration = Duration::from_secs(20);

/// A text for a viewer, as JSON.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub(super) enum Response {
    Status {
        state: &'static str,
        digest: Option<String>,
        pace: String,
        seat: SeatView,
        #[serde(skip_serializing_if = "BTreeSet::is_empty")]
        failed: BTreeSet<String>,
        #[serde(skip_serializing_if = "Vec::is_empty")]
        forced: Vec<usize>,
        #[serde(skip_serializing_if = "BTreeSet::is_empty")]
        disturbed: BTreeSet<usize>,
        shown_ns: Option<u64>,
        past_ns: Option<[u64; 2]>,
    },
    Looks {
        active: Vec<usize>,
    },
    States {
        drawing: usize,
        instance: usize,
        values: Vec<Option<f64>>,
    },
    View {
        view: String,
    },
    Variables {
        #[serde(flatten)]
        seen: Seen,
    },
    Map {
        #[serde(flatten)]
        cells: Cells,
    },
    Verdict {
        #[serde(flatten)]
        standing: Standing,
    },
    Forked {
        t_ns: u64,
        url: String,
    },
    Event {
        t_ns: u64,
        kind: &'static str,
        text: String,
    },
    Error {
        message: String,
    },
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
