//! Variables of an OPC UA server (IEC 62541), as the link to a real PLC.
//!
//! | module | subject |
//! |---|---|
//! | `identity` | who the client says it is, and how its connection is secured |
//! | [`value`] | packed values as Variants |
//! | [`connection`] | a session with the server, and what it says when there is none |
//! | [`browse`] | the variables that there are |
//! | [`points`] | one Write and one Read for all points |

pub mod browse;
pub mod connection;
mod identity;
pub mod points;
pub mod value;

pub use points::OpcUaLink;
