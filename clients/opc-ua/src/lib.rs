//! OPC UA: a real PLC's variables as a link, a soft PLC's variables served, a session served as an information model.
//!
//! | module | subject |
//! |---|---|
//! | [`server`] | endpoints, users and certificates of an OPC UA server |
//! | [`link`] | variables of an OPC UA server as the link to a real PLC |
//! | [`plc_server`] | the variables of a soft PLC on a clock of its own |
//! | [`information_model`] | a session for clients that have nothing but an OPC UA client |
//! | `provider` | all of it behind the interfaces by which the program reaches it |
//!
//! # Invariants
//! - Only the program names this crate, and installs it ([`install`]); everybody else asks `onescan_links`.
//! - A wall clock decides when to give up, never what a step computes.

pub mod information_model;
pub mod link;
pub mod plc_server;
mod provider;
pub mod server;

pub use provider::install;
