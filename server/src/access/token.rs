//! A token, and its hash, which is what is kept.
//!
//! A token is 256 random bits, so nobody can try all of them, and nobody has chosen it: a hash that is slow on purpose,
//! as passwords need, would protect nothing more. BLAKE3 under a context of its own is what is kept at rest.

use std::fmt;
use std::str::FromStr;

use subtle::ConstantTimeEq;
use thiserror::Error;

const PREFIX: &str = "onescan_";
const HASH_PREFIX: &str = "b3:";
const CONTEXT: &str = "onescan 2026 token at rest";
const BYTES: usize = 32;

/// What somebody shows to be let in. It is never printed but on purpose.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

/// What is kept of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TokenHash([u8; BYTES]);

/// A text that is neither a token nor the hash of one.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BadToken {
    /// Not a token. The text is not repeated: it may be another secret.
    #[error("not a token: a token is `onescan_` and 64 digits of base 16, as `onescan token new` prints it")]
    Token,
    #[error("not the hash of a token: it is `b3:` and 64 digits of base 16")]
    Hash,
    #[error("the operating system gives no random numbers: {0}")]
    NoRandomness(String),
}

impl Token {
    /// A token that nobody has seen.
    ///
    /// # Errors
    /// The operating system gives no random numbers.
    pub fn generate() -> Result<Self, BadToken> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes).map_err(|error| BadToken::NoRandomness(error.to_string()))?;
        Ok(Self(format!("{PREFIX}{}", hex(&bytes))))
    }

    /// The token as it is shown to a server: the secret itself.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// What is kept of it.
    pub fn hash(&self) -> TokenHash {
        TokenHash::of(&self.0)
    }
}

impl FromStr for Token {
    type Err = BadToken;

    fn from_str(text: &str) -> Result<Self, BadToken> {
        let digits = text.strip_prefix(PREFIX).ok_or(BadToken::Token)?;
        unhex(digits).ok_or(BadToken::Token)?;
        Ok(Self(text.to_owned()))
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(…)")
    }
}

impl TokenHash {
    /// The hash of whatever somebody showed.
    pub fn of(shown: &str) -> Self {
        Self(blake3::derive_key(CONTEXT, shown.as_bytes()))
    }

    /// True if both are of one token. Takes as long whether they are or not, wherever they differ.
    pub fn matches(&self, other: &Self) -> subtle::Choice {
        self.0.ct_eq(&other.0)
    }
}

impl fmt::Display for TokenHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{HASH_PREFIX}{}", hex(&self.0))
    }
}

impl FromStr for TokenHash {
    type Err = BadToken;

    fn from_str(text: &str) -> Result<Self, BadToken> {
        text.strip_prefix(HASH_PREFIX).and_then(unhex).map(Self).ok_or(BadToken::Hash)
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn unhex(digits: &str) -> Option<[u8; BYTES]> {
    let mut bytes = [0; BYTES];
    if digits.len() != 2 * BYTES || !digits.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f')) {
        return None;
    }
    for (byte, pair) in bytes.iter_mut().zip(digits.as_bytes().chunks_exact(2)) {
        *byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_comes_back_from_its_text_and_is_not_printed() {
        let (one, other) = (Token::generate().unwrap(), Token::generate().unwrap());
        assert_ne!(one, other);
        assert_eq!(one.reveal().parse(), Ok(one.clone()));
        assert_eq!(format!("{one:?}"), "Token(…)");
        for text in ["", "onescan_", "onescan_00", &one.reveal()[8..], &one.reveal().to_uppercase()] {
            assert_eq!(text.parse::<Token>(), Err(BadToken::Token), "{text}");
        }
    }

    #[test]
    fn a_hash_comes_back_and_matches_its_token_only() {
        let (one, other) = (Token::generate().unwrap(), Token::generate().unwrap());
        let kept: TokenHash = one.hash().to_string().parse().unwrap();
        assert!(bool::from(kept.matches(&TokenHash::of(one.reveal()))));
        assert!(!bool::from(kept.matches(&other.hash())));
        assert_eq!("b3:00".parse::<TokenHash>(), Err(BadToken::Hash));
    }

    /// Stores that people have must stay good.
    #[test]
    fn the_hash_of_a_token_stays_the_same() {
        let token = format!("onescan_{}", "0".repeat(64));
        assert_eq!(
            TokenHash::of(&token).to_string(),
            "b3:ef451c1f3fbc4b32bdc9cf6bf2315d3da84cc4553466c73cc32bfed06d321e0a"
        );
    }
}
