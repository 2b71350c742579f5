//! Clients that give what people gave: switches and set points, and what somebody once did.
//!
//! | module | subject |
//! |---|---|
//! | [`operator`] | switches and set points that nobody else writes |
//! | [`replay`] | a client that repeats what another once did |

pub mod operator;
pub mod replay;
