//! Who may do what to a session: tokens, and what their holders are let in for.
//!
//! | module | subject |
//! |---|---|
//! | [`role`] | what a token lets its holder do |
//! | [`token`] | a token and its hash |
//! | [`day`] | the day on which a token ends |
//! | [`certificate`] | whom the certificate of a client is for |
//! | [`revocation`] | certificates that are no longer good |
//! | [`register`] | all tokens of a session, and the question whether one lets somebody in |
//!
//! Nothing here reads a clock or a file, and only [`Token::generate`] asks for random numbers: never on the path of a
//! session.

pub mod certificate;
pub mod day;
pub mod register;
pub mod revocation;
pub mod role;
pub mod token;

pub use certificate::BadSubject;
pub use day::Day;
pub use register::{Holder, Pass, Proof, Register, RegisterError, TokenRefusal};
pub use revocation::{BadFingerprint, Fingerprint, RevocationList, Revoked};
pub use role::Role;
pub use token::{BadToken, Token, TokenHash};
