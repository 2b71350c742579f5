//! Links between a session and PLCs of this world: gateways to real ones, and a soft PLC that poses as a real one.
//!
//! | module | subject |
//! |---|---|
//! | `listener` | listening, for every server |
//! | `accept` | connections that come in, each with a place, a time and a thread |
//! | [`opcua`] | OPC UA as plain data, and a session served over it |
//! | [`gateway`] | a real PLC as a client, over the links that it has |
//! | [`station`] | a soft PLC on a clock of its own, for gateways to be tried on |
//! | [`inspection`] | the soft PLCs of a session over ADS, for those who only read |
//!
//! # Invariants
//! - These are the rooms that open sockets, start threads and read a wall clock; what a step computes does not depend
//!   on it.
//! - Bad input is an error with a place, never a panic.

mod accept;
pub mod gateway;
pub mod inspection;
pub mod listener;
pub mod opcua;
pub mod station;
