//! The plant's state as bytes: a header that says whose it is, then the state.
//!
//! | bytes | meaning |
//! |---|---|
//! | 8 | `onescanP` |
//! | 4 | version of this form, little-endian |
//! | 32 | digest of all that follows |
//! | rest | the plant's identity, then the engine's sets and the plant's own memory |
//!
//! Nothing is read before the digest agrees, and the engine's sets only after the identity does, so
//! that they cannot be anything but what this plant saved.

use onescan_server::client::StateError;
use rapier3d::prelude::PhysicsWorld;
use serde::{Deserialize, Serialize};

use super::identity::Identity;
use super::machine::Memory;

const MAGIC: [u8; 8] = *b"onescanP";
const VERSION: u32 = 9;
const DIGEST_BYTES: usize = blake3::OUT_LEN;
const HEADER_BYTES: usize = MAGIC.len() + size_of::<u32>() + DIGEST_BYTES;

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
pub(super) fn to_bytes(identity: &Identity, physics: &PhysicsWorld, memory: &Memory) -> Result<Vec<u8>, StateError> {
    let unsaved = |error: postcard::Error| corrupt(&format!("the plant cannot be saved: {error}"));
    let mut bytes = vec![0; HEADER_BYTES];
    bytes = postcard::to_extend(identity, bytes).map_err(unsaved)?;
    bytes = postcard::to_extend(&Saved { physics, memory }, bytes).map_err(unsaved)?;
    let digest = blake3::hash(&bytes[HEADER_BYTES..]);
    bytes[..MAGIC.len()].copy_from_slice(&MAGIC);
    bytes[MAGIC.len()..HEADER_BYTES - DIGEST_BYTES].copy_from_slice(&VERSION.to_le_bytes());
    bytes[HEADER_BYTES - DIGEST_BYTES..HEADER_BYTES].copy_from_slice(digest.as_bytes());
    Ok(bytes)
}

/// The state in bytes that [`to_bytes`] gave to a plant of this identity.
pub(super) fn from_bytes(identity: &Identity, bytes: &[u8]) -> Result<Restored, StateError> {
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
    let (digest, rest) = rest.split_first_chunk::<DIGEST_BYTES>().ok_or_else(short)?;
    if blake3::hash(rest) != blake3::Hash::from_bytes(*digest) {
        return Err(corrupt("it is cut short or damaged"));
    }
    let (whose, payload) = postcard::take_from_bytes::<Identity>(rest).map_err(|error| corrupt(&error.to_string()))?;
    if let Some(difference) = identity.difference(&whose) {
        return Err(corrupt(&difference));
    }
    postcard::from_bytes(payload).map_err(|error| corrupt(&error.to_string()))
}

fn corrupt(why: &str) -> StateError {
    StateError::Corrupt(why.to_owned())
}
