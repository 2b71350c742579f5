//! Everything that joins a onescan session: a plant, a soft PLC.
//!
//! | module | subject |
//! |---|---|
//! | [`plant`] | the simulated machine: a scene of rigid bodies, driven axes and sensors |
//! | [`soft_plc`] | the embedded soft PLC, which runs IEC 61131-3 source text |
//! | [`stream`] | ports at which clients send and receive bytes |
//! | [`gateway`] | a real PLC, over the links that it has |
//! | [`station`] | a soft PLC on a clock of its own, for gateways to be tried on |
//! | `information_model` | a session over OPC UA: clients that have nothing but an OPC UA client |
//! | [`inspection`] | the soft PLCs of a session over ADS, for those who only read |
//! | [`opcua_server`] | endpoints, users and certificates of an OPC UA server |
//! | `listener` | listening, for every server |
//! | [`array`] | names with a range, as in `arm[0..9].hold` |
//! | [`replay`] | a client that repeats what another once did |
//! | [`operator`] | switches and set points that nobody else writes |
//!
//! # Invariants
//! - A client is a function of its state, its inputs and `t_v`. None reads a random
//!   source, a thread's identity or the order of a hash map.
//! - Transcendental functions come from `libm`, at set-up as well as in a turn.
//! - Files are read before a session. Nothing but [`gateway`], [`station`], [`inspection`], [`opcua_server`] and
//!   `information_model` opens a socket, starts a thread or reads a wall clock, and what a step computes
//!   does not depend on it.
//! - Bad input is an error with a place, never a panic.

pub mod array;
pub mod gateway;
#[cfg(feature = "opcua")]
pub mod information_model;
pub mod inspection;
mod listener;
pub mod opcua_server;
pub mod operator;
pub mod plant;
#[cfg(test)]
mod published;
pub mod replay;
pub mod soft_plc;
pub mod station;
pub mod stream;
