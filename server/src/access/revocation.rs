//! Certificates that are no longer good, by their fingerprints.

use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use sha2::{Digest as _, Sha256};
use thiserror::Error;

const BYTES: usize = 32;

/// The fingerprint of a certificate: SHA-256 of its DER, written as `openssl x509 -noout -fingerprint -sha256` prints it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Fingerprint([u8; BYTES]);

/// A text that is not a fingerprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("a fingerprint is 32 bytes in base 16, as in `AB:CD:...`, with colons or without")]
pub struct BadFingerprint;

impl Fingerprint {
    /// That of a certificate in DER.
    pub fn of(der: &[u8]) -> Self {
        Self(Sha256::digest(der).into())
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (last, first) = (self.0[BYTES - 1], &self.0[..BYTES - 1]);
        first.iter().try_for_each(|byte| write!(f, "{byte:02X}:"))?;
        write!(f, "{last:02X}")
    }
}

impl FromStr for Fingerprint {
    type Err = BadFingerprint;

    fn from_str(text: &str) -> Result<Self, BadFingerprint> {
        let digits: Vec<u8> = text.bytes().filter(|byte| *byte != b':').collect();
        let mut bytes = [0; BYTES];
        if digits.len() != 2 * BYTES || !digits.iter().all(u8::is_ascii_hexdigit) {
            return Err(BadFingerprint);
        }
        for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
            let pair = std::str::from_utf8(pair).map_err(|_| BadFingerprint)?;
            *byte = u8::from_str_radix(pair, 16).map_err(|_| BadFingerprint)?;
        }
        Ok(Self(bytes))
    }
}

/// The certificates that have been revoked.
pub type Revoked = BTreeSet<Fingerprint>;

/// Where a session learns which certificates have been revoked, also while it runs.
#[derive(Clone)]
pub struct RevocationList(Arc<Read>);

/// All that are revoked now, or why that is not known.
type Read = dyn Fn() -> Result<Revoked, String> + Send + Sync;

impl RevocationList {
    /// The list that `read` gives whenever it is asked.
    pub fn new(read: impl Fn() -> Result<Revoked, String> + Send + Sync + 'static) -> Self {
        Self(Arc::new(read))
    }

    /// All that are revoked now.
    ///
    /// # Errors
    /// The list cannot be read, and why.
    pub fn read(&self) -> Result<Revoked, String> {
        (self.0)()
    }
}

impl fmt::Debug for RevocationList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("RevocationList(…)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `printf abc | openssl dgst -sha256` has it.
    const OF_ABC: &str =
        "BA:78:16:BF:8F:01:CF:EA:41:41:40:DE:5D:AE:22:23:B0:03:61:A3:96:17:7A:9C:B4:10:FF:61:F2:00:15:AD";

    #[test]
    fn a_fingerprint_is_that_of_other_tools_and_comes_back() {
        let fingerprint = Fingerprint::of(b"abc");
        assert_eq!(fingerprint.to_string(), OF_ABC);
        for text in [OF_ABC.to_owned(), OF_ABC.replace(':', ""), OF_ABC.to_lowercase()] {
            assert_eq!(text.parse(), Ok(fingerprint));
        }
        for text in ["", "AB:CD", &OF_ABC[3..], &OF_ABC.replace('B', "G"), &OF_ABC.replace('B', "é")] {
            assert_eq!(text.parse::<Fingerprint>(), Err(BadFingerprint), "{text}");
        }
    }
}
