//! The digest: two runs are equal if and only if their digests are.
//!
//! The digest of a run is the BLAKE3 hash of one stream of bytes: a preamble that names the version,
//! the step and every signal with its type, then the committed image of every step, the initial one
//! first. Every image of a session has the same size, so a step's place in the stream is its number
//! and its virtual time; neither is written. Anyone can check a digest: write the stream to a file and
//! hash it.
//!
//! | module | subject |
//! |---|---|
//! | [`stream`] | BLAKE3 over a stream that can be saved, copied and read at any byte |
//! | this file | what the stream of a session is |
//!
//! The text of a digest begins with the version of the stream, `d2:`. Version 1 chained a hash from
//! step to step, which hashes each step alone and cannot use the wide path of BLAKE3.

pub mod stream;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use thiserror::Error;

use crate::session::Session;
use stream::HashStream;

/// What every digest of this version begins with in text.
pub const VERSION: &str = "d2";
/// The first bytes of every stream.
const PREAMBLE: &str = "onescan trajectory digest 2\n";

/// A digest after some step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest([u8; 32]);

impl Digest {
    /// The digest of 32 bytes, as a recording keeps them.
    pub const fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// Its 32 bytes, without the version.
    pub const fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{VERSION}:")?;
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Why a text is not a digest that this program can compare.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DigestTextError {
    /// A digest of another version, which cannot be compared with one of this version.
    #[error("a digest of version {found}; this program makes {VERSION}, and the two cannot be compared")]
    Version {
        /// What stands before the colon; `d1` for the first version, which had no prefix.
        found: String,
    },
    #[error("`{0}` is not a digest: `{VERSION}:` and 64 hexadecimal digits are expected")]
    Form(String),
}

impl FromStr for Digest {
    type Err = DigestTextError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let bytes = |hex: &str| blake3::Hash::from_hex(hex).map(|hash| *hash.as_bytes());
        match text.split_once(':') {
            Some((VERSION, hex)) => bytes(hex).map(Self).map_err(|_| DigestTextError::Form(text.to_owned())),
            Some((other, hex)) if bytes(hex).is_ok() => Err(DigestTextError::Version { found: other.to_owned() }),
            None if bytes(text).is_ok() => Err(DigestTextError::Version { found: "d1".to_owned() }),
            _ => Err(DigestTextError::Form(text.to_owned())),
        }
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

/// The digest of a session as it grows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrajectoryDigest {
    stream: HashStream,
}

impl TrajectoryDigest {
    /// The digest of a session whose image holds the initial values.
    pub fn begin(session: &Session) -> Self {
        let mut this = Self { stream: HashStream::new() };
        this.stream.take(PREAMBLE.as_bytes());
        this.stream.take(&session.step().as_nanos().to_le_bytes());
        for signal in session.plan().signals() {
            this.stream.take(signal.name.as_str().as_bytes());
            this.stream.take(b":");
            this.stream.take(signal.ty.to_string().as_bytes());
            this.stream.take(b"\n");
        }
        // A name cannot be empty, so an empty line ends the list.
        this.stream.take(b"\n");
        this.step(session.image());
        this
    }

    /// Takes in the image of the step that was just committed.
    pub fn step(&mut self, image: &[u8]) {
        self.stream.take(image);
    }

    /// Takes in so many steps that all left the same image.
    pub fn steps(&mut self, image: &[u8], steps: u64) {
        for _ in 0..steps {
            self.stream.take(image);
        }
    }

    /// The digest of all steps so far. It finishes a copy: costs a few microseconds, not a copy of
    /// the run.
    #[must_use]
    pub fn value(&self) -> Digest {
        Digest(self.stream.value())
    }

    /// As [`value`](Self::value), for one who asks after every step: what has been hashed for one
    /// answer is not hashed again for the next.
    #[must_use]
    pub fn value_each_step(&mut self) -> Digest {
        self.stream.settle();
        self.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_part_of_the_text() {
        let digest = Digest([7; 32]);
        let text = digest.to_string();
        assert_eq!(text, format!("d2:{}", "07".repeat(32)));
        assert_eq!(text.parse(), Ok(digest));
        let old = "07".repeat(32).parse::<Digest>().unwrap_err();
        assert_eq!(old.to_string(), "a digest of version d1; this program makes d2, and the two cannot be compared");
        assert!(matches!("d2:07".parse::<Digest>(), Err(DigestTextError::Form(_))));
        assert!(matches!("bananas".parse::<Digest>(), Err(DigestTextError::Form(_))));
    }
}
