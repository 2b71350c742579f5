//! How frames travel. Clients in the server's process need no transport: they are called.
//!
//! | module | subject |
//! |---|---|
//! | [`door`] | how many connections a listener keeps, and who leaves for one who comes |
//! | [`tcp`] | clients and operators over TCP |
//! | [`tls`] | certificates, and who is trusted |

pub mod door;
pub mod tcp;
pub mod tls;
