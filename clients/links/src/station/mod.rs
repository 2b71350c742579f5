//! A soft PLC on a clock of its own, which serves its variables as a real one does: what a gateway is tried on.
//!
//! | module | subject |
//! |---|---|
//! | [`wires`] | which point is which place in the PLC's memory |
//! | [`controller`] | the PLC between its cycles: points, RUN and STOP, starts |
//! | [`cycle`] | the wall clock that drives it |
//! | [`ads`] | symbols over ADS |
//! | [`modbus`] | registers and coils over Modbus TCP |
//! | [`opcua`] | variables of an OPC UA server, if the program has the protocol |
//! | [`s7`] | data blocks over ISO-on-TCP |
//! | [`tcp`] | data blocks over raw TCP |
//!
//! # Invariants
//! - The PLC never waits for its clients: it runs a cycle when its clock says so.
//! - What one block, one Modbus request or one ADS command writes is in place between two cycles. An OPC UA server takes values one
//!   by one, in their order.
//! - A server listens at the address that it is given and nowhere else. Of two gateways over raw TCP, the one whose first
//!   block came last has the PLC: who only connects takes it from nobody.

pub mod ads;
pub mod controller;
pub mod cycle;
pub mod modbus;
pub mod opcua;
pub mod s7;
pub mod tcp;
pub mod wires;

pub use controller::{Controller, Status};
pub use cycle::Clockwork;
pub use wires::{WireError, Wires};
