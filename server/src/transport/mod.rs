//! How frames travel. Clients in the server's process need no transport: they are called.
//!
//! | module | subject |
//! |---|---|
//! | [`tcp`] | clients and operators over TCP |
//! | [`tls`] | certificates, and who is trusted |

pub mod tcp;
pub mod tls;
