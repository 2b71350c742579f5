//! Two data blocks of an S7 over ISO-on-TCP, one a direction, laid out as [`super::tcp::layout`] has it: as a block of
//! standard access, big-endian.
//!
//! | module | subject |
//! |---|---|
//! | [`iso`] | messages in a stream of bytes: TPKT (RFC 1006) and COTP of class 0 (RFC 905) |
//! | [`pdu`] | what is asked for in a message, and what is answered |
//! | [`connection`] | requests and their answers, one at a time |
//! | [`options`] | what a scenario says of the link |
//! | [`link`] | the gateway's side: two blocks, as few requests as the PDU allows |

pub mod connection;
pub mod iso;
pub mod link;
pub mod options;
pub mod pdu;

pub use link::S7Link;
pub use options::Options;
