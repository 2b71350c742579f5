//! onescan-server
pub mod client;
pub mod signal;
pub mod time;
