//! The client that speaks for a real PLC: one lockstep handshake over the links that PLCs have.
//!
//! | module | subject |
//! |---|---|
//! | [`handshake`] | what is to be written and read next, and what the PLC's words mean: sans-IO |
//! | [`answer`] | what its scheduler says of a grant |
//! | [`fault`] | what can be wrong with a link, distinguished by name |
//! | [`byte_order`] | which byte of a number comes first |
//! | [`exchange`] | the signals and synchronisation words in their order, as packed bytes |
//! | [`addresses`] | the addresses of a signal as a scenario writes them |
//! | [`mapping`] | the variables of each signal, and the address of each |
//! | [`layout_number`] | a number that says whether two mappings are the same |
//! | [`listing`] | all points of a link with their places |
//! | [`link`] | the interface of all links |
//! | `contact` | the first contact with a PLC |
//! | [`client`] | handshake and link as a client of a session |
//! | [`settings`] | what a scenario says of a link, and the link made of it |
//! | [`ads`] | symbols of a TwinCAT PLC |
//! | [`modbus`] | registers and coils over Modbus TCP |
//! | [`opcua`] | variables of an OPC UA server, if the program has the protocol |
//! | [`s7`] | data blocks of an S7 |
//! | `socket` | the TCP connection that several links begin with |
//! | [`counted`] | a PLC that is not instrumented: a step for each of its blocks |
//! | [`freewheel`] | a PLC that is not driven, to compare |
//! | [`tcp`] | data blocks of declared layout over a raw TCP connection |
//!
//! # Invariants
//! - The handshake knows no socket and no clock. A link knows nothing of grants: it moves bytes.
//! - No step is run twice and none is skipped, wherever the connection breaks.
//! - A wall clock decides when to give up, never what a step computes.

pub mod addresses;
pub mod ads;
pub mod answer;
pub mod byte_order;
pub mod client;
mod contact;
pub mod counted;
pub mod exchange;
pub mod fault;
pub mod freewheel;
pub mod handshake;
pub mod layout_number;
pub mod link;
pub mod listing;
pub mod mapping;
pub mod modbus;
pub mod opcua;
pub mod s7;
pub mod settings;
mod socket;
pub mod tcp;

pub use addresses::Addresses;
pub use client::{Gateway, Patience};
pub use counted::CountedGateway;
pub use exchange::{Direction, Exchange, Point};
pub use fault::{GatewayFault, LinkFault, MappingFault};
pub use freewheel::FreeGateway;
pub use link::Link;
pub use settings::{BadUrl, HandshakeKind, Settings, SettingsFault};
