//! The digest: two runs are equal if and only if their digests are.
//!
//! `d_0 = H(signature, initial image)` and `d_k = H(d_{k-1}, k, t_v, image_k)` with BLAKE3, where the
//! signature names the step and every signal with its type. Integers are 64-bit little-endian.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::session::Session;

/// A digest after some step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest(pub(crate) [u8; 32]);

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl FromStr for Digest {
    type Err = blake3::HexError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        blake3::Hash::from_hex(text).map(|hash| Self(*hash.as_bytes()))
    }
}

impl Serialize for Digest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Digest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

/// The chain as it grows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DigestChain {
    last: Digest,
}

impl DigestChain {
    /// The chain of a session whose image holds the initial values.
    pub fn begin(session: &Session) -> Self {
        let mut hasher = blake3::Hasher::new_derive_key("onescan trajectory digest 1");
        hasher.update(&session.step().as_nanos().to_le_bytes());
        for signal in session.plan().signals() {
            hasher.update(signal.name.as_str().as_bytes());
            hasher.update(b":");
            hasher.update(signal.ty.to_string().as_bytes());
            hasher.update(b"\n");
        }
        hasher.update(session.image());
        Self { last: Digest(*hasher.finalize().as_bytes()) }
    }

    /// Goes on from a digest that was saved.
    pub fn resume(last: Digest) -> Self {
        Self { last }
    }

    /// Takes in the step that was just committed.
    pub fn step(&mut self, session: &Session) {
        let mut hasher = blake3::Hasher::new();
        let mut header = [0; 48];
        header[..32].copy_from_slice(&self.last.0);
        header[32..40].copy_from_slice(&session.cycle().steps().0.to_le_bytes());
        header[40..].copy_from_slice(&session.t_v().as_nanos().to_le_bytes());
        hasher.update(&header);
        hasher.update(session.image());
        self.last = Digest(*hasher.finalize().as_bytes());
    }

    /// The digest of all steps so far.
    pub fn last(&self) -> Digest {
        self.last
    }
}
