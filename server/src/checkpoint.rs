//! A checkpoint: everything that a session is at a step boundary, as a value.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::client::StateError;
use crate::record::Digest;
use crate::session::SessionState;
use crate::signal::ClientName;
use crate::time::VirtualTime;

const MAGIC: &[u8; 16] = b"onescan state 2\n";
const CHECK_BYTES: usize = 32;

/// The state of a session and of all its clients.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// A hash of the plan: a checkpoint fits only the session it was taken from.
    pub(crate) plan: [u8; 32],
    pub(crate) session: SessionState,
    pub(crate) digest: Digest,
    pub(crate) clients: Vec<(ClientName, Vec<u8>)>,
}

/// Why there is no checkpoint, or why it cannot be taken up.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CheckpointError {
    /// Not a checkpoint at all.
    #[error("not a checkpoint of onescan")]
    Foreign,
    /// A checkpoint that was cut or changed.
    #[error("the checkpoint is damaged: its check sum does not fit its bytes")]
    Damaged,
    /// A checkpoint of another session.
    #[error("the checkpoint belongs to a session with other signals, clients or another step")]
    OtherSession,
    /// Not now.
    #[error("a checkpoint can be taken only at a step boundary of a session that goes on")]
    NotNow,
    /// A client cannot.
    #[error("client `{client}`: {source}")]
    Client {
        /// Who.
        client: ClientName,
        /// Why.
        source: StateError,
    },
}

impl Checkpoint {
    /// Virtual time at which it was taken.
    pub fn t_v(&self) -> VirtualTime {
        self.session.t_v()
    }

    /// The digest up to there.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// The checkpoint as a file's bytes.
    ///
    /// # Errors
    /// None for a checkpoint that a session gave.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CheckpointError> {
        let body = postcard::to_stdvec(self).map_err(|_| CheckpointError::Damaged)?;
        let mut bytes = Vec::with_capacity(MAGIC.len() + CHECK_BYTES + body.len());
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(blake3::hash(&body).as_bytes());
        bytes.extend_from_slice(&body);
        Ok(bytes)
    }

    /// The checkpoint in a file's bytes.
    ///
    /// # Errors
    /// Bytes of anything else, cut or changed bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Foreign)?;
        let (check, body) = rest.split_at_checked(CHECK_BYTES).ok_or(CheckpointError::Damaged)?;
        if blake3::hash(body).as_bytes() != check {
            return Err(CheckpointError::Damaged);
        }
        postcard::from_bytes(body).map_err(|_| CheckpointError::Damaged)
    }
}
