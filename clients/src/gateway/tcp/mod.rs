//! Data blocks of declared layout over a raw TCP connection.
//!
//! `[Nyyssönen]` ch. 3.1 and Figs. 13, 17, 18: two blocks of fixed length, one a direction, without any
//! header; what lies where is declared on both sides. The PLC sends its block when it gets one, and when it has changed.
//!
//! | module | subject |
//! |---|---|
//! | [`layout`] | what lies where in a block |
//! | [`codec`] | blocks in a stream of bytes |
//! | [`link`] | the gateway's side |

pub mod codec;
pub mod layout;
pub mod link;

pub use codec::BlockCodec;
pub use layout::{Declaration, Layout, Layouts};
pub use link::TcpLink;
