//! Symbols of a TwinCAT PLC over ADS (Beckhoff: TC3 ADS introduction), over TCP and without a router of its own.
//!
//! `[Jacket]`, a kiln-shell monitor, talks to a TwinCAT soft PLC over ADS, without virtual time.
//!
//! | module | subject |
//! |---|---|
//! | [`frame`] | AMS frames in a stream of bytes |
//! | [`command`] | numbers of commands, groups, states and return codes |
//! | [`symbol`] | entries of the table of symbols, and how values stand in memory |
//! | [`options`] | what a scenario says |
//! | `connection` | requests and responses |
//! | [`link`] | the gateway's side |
//!
//! Frames are read here and not by a client library, as what comes from a network must have a bound: see
//! docs/decisions/008-ads-frames.md.

pub mod command;
mod connection;
pub mod frame;
pub mod link;
pub mod options;
pub mod symbol;

pub use link::AdsLink;
pub use options::Options;
