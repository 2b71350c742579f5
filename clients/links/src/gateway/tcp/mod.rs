//! Data blocks of declared layout over a raw TCP connection.
//!
//! `[Nyyssönen]` ch. 3.1 and Figs. 13, 17, 18: two blocks of fixed length, one a direction, without any
//! header; what lies where is declared on both sides. The PLC sends its block when it gets one, when it has changed, or
//! at an interval of its own.
//!
//! | module | subject |
//! |---|---|
//! | `place` | a bit, a number, a number in parts |
//! | [`layout`] | what lies where in a block |
//! | [`codec`] | blocks in a stream of bytes |
//! | [`plc_listener`] | where a PLC connects that is the TCP client |
//! | [`link`] | the gateway's side |

pub mod codec;
pub mod layout;
pub mod link;
mod place;
pub mod plc_listener;

pub use codec::{BlockCodec, StreamFault};
pub use layout::{Declaration, Layout, Layouts};
pub use link::TcpLink;
