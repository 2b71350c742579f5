//! How frames travel. Clients in the server's process need no transport: they are called.
//!
//! | module | subject |
//! |---|---|
//! | [`accept`] | connections that come in, each with a place and a time |
//! | [`connection_limit`] | how many connections a listener keeps, and which gives way to one that comes |
//! | [`listeners`] | what each listener allows those who come |
//! | [`runtime`] | what listeners and links run on |
//! | [`tcp`] | clients and operators over TCP |
//! | [`tls`] | certificates, and who is trusted |

pub mod accept;
pub mod connection_limit;
pub mod listeners;
pub mod runtime;
pub mod tcp;
pub mod tls;
