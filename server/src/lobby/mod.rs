//! Who comes to a session, who may stay, and for how long: machines without a socket, a clock or a thread.
//!
//! | module | subject |
//! |---|---|
//! | [`acceptor`] | connections, from the first byte until they take part, ask as operators, or are sent away |
//! | `visitor` | one connection in the acceptor |
//! | `places` | how many operators are in, by address |
//! | [`registration`] | the seats of a session that forms: who has one, who is missing, how long that may take |
//!
//! What happens comes in as calls with the time at which it happened; what is to be done comes out as [`Action`]s.
//! [`transport::tcp`](crate::transport::tcp) and [`formation`](crate::formation) do it with sockets and a clock; the proofs
//! (`tests/proofs/lobby`) move the same machines through every order of what clients, operators and strangers may do.

pub mod acceptor;
mod places;
pub mod registration;
mod visitor;

pub use acceptor::{Acceptor, Action, Now, Terms, Visitor};
pub use registration::{Registration, Verdict};
