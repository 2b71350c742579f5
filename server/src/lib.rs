//! The SDSP server of onescan: it owns virtual time and takes all clients through one step of it
//! together, every time.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`time`] | virtual time, integer nanoseconds |
//! | [`signal`] | typed values with one writer, and the ports through which clients see them |
//! | [`fault`] | why a client cannot go on |
//! | [`client`] | the interface of everything that takes part |
//! | [`plan`] | a session before anybody joins |
//! | [`operation`] | what is done to a session from outside, as data |
//! | [`random`] | random numbers from seeds that operations and scenarios give |
//! | [`layout`] | where each signal lies among all values |
//! | `signal_overlay` | what lies over the writers' values: writes, forces, faults of signals |
//! | [`image`] | all values; staged, then committed |
//! | [`join`] | who may join, and why not |
//! | [`state`] | the states of \[SDSP\], Figs. 8 and 9 |
//! | [`cycle`] | the barrier: states, virtual time, delays |
//! | [`nusmv`] | the same as a model for NuSMV |
//! | [`end`] | how a session ends |
//! | [`session`] | all of these as one machine |
//! | [`digest`] | the hash of a run |
//! | [`timeline`] | operations that a session brings along, by time or by condition |
//! | [`observer`], [`published`] | who watches: on the session's thread, and beside it |
//! | [`mailbox`], [`pacing`] | what operators ask for; how fast virtual time may run |
//! | [`carrier`] | how a client is reached |
//! | [`checkpoint`] | a session as a value |
//! | [`lockstep`] | the driver of a running session |
//! | [`access`] | tokens: who may do what |
//! | [`lobby`] | who comes, who may stay, and for how long: machines without a socket or a clock |
//! | [`formation`] | clients come together |
//! | [`wire`] | the protocol of clients outside this process |
//! | [`transport`] | a carrier of its frames: TCP |
//!
//! Invariants. Up to [`session`] the crate is *sans-IO*: no clock, no thread, no socket, no random
//! number without a seed, no iteration in hash order, and after the start nothing is allocated by a step. Nothing
//! here knows what a PLC or a plant is, nor how a scenario is written.

pub mod access;
pub mod carrier;
pub mod checkpoint;
pub mod client;
pub mod cycle;
pub mod digest;
pub mod end;
pub mod fault;
pub mod formation;
pub mod image;
pub mod join;
pub mod layout;
pub mod lobby;
pub mod lockstep;
pub mod mailbox;
pub mod nusmv;
pub mod observer;
pub mod operation;
pub mod pacing;
pub mod plan;
pub mod published;
pub mod random;
pub mod session;
pub mod signal;
mod signal_overlay;
pub mod state;
pub mod time;
pub mod timeline;
pub mod transport;
pub mod wire;
