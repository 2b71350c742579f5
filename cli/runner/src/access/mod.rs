//! Who may take part in sessions over a network: a folder with tokens and a certificate.
//!
//! | module | subject |
//! |---|---|
//! | [`folder`] | the folder: what lies where, read for a session |
//! | [`tokens`] | its tokens: made, listed, revoked |
//! | [`certificate`] | its certificate: made |
//! | [`revoked`] | certificates of others that are no longer good |
//! | [`admission`] | whether a session may listen where it is to, and whom it lets in |
//! | [`entrance`] | the other side: what is shown to a session |

pub mod admission;
pub mod certificate;
pub mod entrance;
mod error;
pub mod folder;
pub mod revoked;
pub mod tokens;

pub use error::AccessError;
