//! The embedded soft PLC as a client: one turn is one scan.
//!
//! | module | subject |
//! |---|---|
//! | [`bind`] | which signal is which variable of the PLC |
//! | `client` | inputs in, scan, outputs out |
//! | [`watch`] | variables that somebody looks at |

pub mod bind;
mod client;
pub mod watch;

pub use bind::{BindError, Bindings, Bound, bind};
pub use client::{CoverageSink, SoftPlcClient, WriterSink, Written};
