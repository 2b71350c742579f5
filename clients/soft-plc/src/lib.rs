//! The embedded soft PLC as a client: one turn is one scan.
//!
//! | module | subject |
//! |---|---|
//! | [`bind`] | which signal is which variable of the PLC |
//! | `client` | inputs in, scan, outputs out |
//! | [`journal`] | what it does scan by scan, handed over |
//! | [`ports`] | lines of bytes: serial terminals, connections |
//! | [`files`] | files that its program finds |
//! | [`trace`] | which statements wrote its outputs, which ways decisions went |
//! | [`undriven`] | inputs that nobody drives |
//! | `variables` | variables written and forced by path |
//! | [`watch`] | variables that somebody looks at |

pub mod bind;
mod client;
pub mod files;
pub mod journal;
pub mod ports;
pub mod trace;
pub mod undriven;
mod variables;
pub mod watch;

pub use bind::{BindError, Bindings, Bound, bind, bind_each};
pub use client::{CoverageSink, SoftPlcClient};
pub use trace::{TraceSink, Traced, Ways, Written};
pub use variables::VariableError;
