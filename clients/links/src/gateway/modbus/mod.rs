//! Registers and coils over Modbus TCP (Modbus Application Protocol 1.1b3).
//!
//! | module | subject |
//! |---|---|
//! | [`map`] | which point is which register or coil |
//! | [`registers`] | values in registers |
//! | [`link`] | the gateway's side: as few requests as the map allows |

pub mod link;
pub mod map;
pub mod registers;

pub use link::ModbusLink;
pub use map::{Options, RegisterMap};
