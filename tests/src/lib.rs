//! Fixtures of the end-to-end tests, proofs and benches. Plans and small clients are those of the simulations.

pub mod bench;
pub mod large;

pub use onescan_simulation::{at_ms, client, plan, port, run, span_ms, toy};
