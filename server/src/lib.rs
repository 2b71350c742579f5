//! The SDSP server of onescan: it owns virtual time and takes all clients through one step of it
//! together, every time.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`time`] | virtual time, integer nanoseconds |
//! | [`signal`] | typed values with one writer, and the ports through which clients see them |
//! | [`client`] | the interface of everything that takes part |
//! | [`plan`] | a session before anybody joins |
//! | [`join`] | who may join, and why not |
//! | [`image`] | all values in one byte layout; staged, then committed |
//! | [`state`] | the states of seed 004, Figs. 8 and 9 |
//! | [`cycle`] | the barrier: states, virtual time, delays |
//! | [`end`] | how a session ends |
//! | [`session`] | all of these as one machine |
//! | [`formation`] | clients come together |
//! | [`lockstep`] | the driver of a running session |
//! | [`mailbox`], [`pacing`] | what operators ask for; how fast virtual time may run |
//! | [`wire`] | the protocol of clients outside this process |
//! | [`transport`] | how its frames travel: TCP |
//! | [`operation`] | what operators do, as data |
//! | [`record`] | the digest, recordings |
//! | [`recording`] | a recording read back |
//! | [`checkpoint`] | a session as a value |
//!
//! Invariants. Up to [`session`] the crate is *sans-IO*: no clock, no thread, no socket, no random
//! number, no iteration in hash order, and after the start nothing is allocated by a step. Nothing
//! here knows what a PLC or a plant is, nor how a scenario is written.

pub mod checkpoint;
pub mod client;
pub mod cycle;
pub mod end;
pub mod formation;
pub mod image;
pub mod join;
pub mod lockstep;
pub mod mailbox;
pub mod operation;
pub mod pacing;
pub mod plan;
pub mod record;
pub mod recording;
pub mod session;
pub mod signal;
pub mod state;
pub mod time;
pub mod transport;
pub mod wire;
