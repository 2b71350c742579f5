//! The plant's state as bytes: a header that says whose it is, then the state.
//!
//! | bytes | meaning |
//! |---|---|
//! | 8 | `onescanP` |
//! | 4 | version of this form, little-endian |
//! | 32 | digest of the plant's identity: scene, period and name |
//! | 32 | digest of the payload |
//! | rest | payload: the engine's sets and the plant's own memory |
//!
//! The payload is read only after both digests agree, so that it cannot be anything but a state that
//! this plant saved.

use onescan_server::client::StateError;
use rapier3d::prelude::PhysicsWorld;
use serde::{Deserialize, Serialize};

use super::machine::Memory;

const MAGIC: [u8; 8] = *b"onescanP";
const VERSION: u32 = 2;
const DIGEST_BYTES: usize = blake3::OUT_LEN;

#[derive(Serialize)]
struct Saved<'s> {
    physics: &'s PhysicsWorld,
    memory: &'s Memory,
}

/// A state that was read back.
#[derive(Deserialize)]
pub(super) struct Restored {
    pub(super) physics: PhysicsWorld,
    pub(super) memory: Memory,
}

/// A state as bytes.
pub(super) fn to_bytes(identity: blake3::Hash, physics: &PhysicsWorld, memory: &Memory) -> Result<Vec<u8>, StateError> {
    let payload = postcard::to_stdvec(&Saved { physics, memory }).map_err(|error| corrupt(&error.to_string()))?;
    let mut bytes = Vec::with_capacity(MAGIC.len() + 4 + 2 * DIGEST_BYTES + payload.len());
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(identity.as_bytes());
    bytes.extend_from_slice(blake3::hash(&payload).as_bytes());
    bytes.extend_from_slice(&payload);
    Ok(bytes)
}

/// The state in bytes that [`to_bytes`] gave to a plant of this identity.
pub(super) fn from_bytes(identity: blake3::Hash, bytes: &[u8]) -> Result<Restored, StateError> {
    let short = || corrupt("it is cut short");
    let (magic, rest) = bytes.split_first_chunk::<8>().ok_or_else(short)?;
    if *magic != MAGIC {
        return Err(corrupt("it is not the state of a plant"));
    }
    let (version, rest) = rest.split_first_chunk::<4>().ok_or_else(short)?;
    let version = u32::from_le_bytes(*version);
    if version != VERSION {
        return Err(corrupt(&format!("its form has version {version}, this program reads {VERSION}")));
    }
    let (whose, rest) = rest.split_first_chunk::<DIGEST_BYTES>().ok_or_else(short)?;
    if blake3::Hash::from_bytes(*whose) != identity {
        return Err(corrupt("it belongs to a plant with another scene, period or name"));
    }
    let (digest, payload) = rest.split_first_chunk::<DIGEST_BYTES>().ok_or_else(short)?;
    if blake3::hash(payload) != blake3::Hash::from_bytes(*digest) {
        return Err(corrupt("it is cut short or damaged"));
    }
    postcard::from_bytes(payload).map_err(|error| corrupt(&error.to_string()))
}

fn corrupt(why: &str) -> StateError {
    StateError::Corrupt(why.to_owned())
}
