//! A session as an OPC UA information model (`[SDSP]` sec. VII): any program that has nothing but an OPC UA client
//! takes part in lockstep, or operates the session, through it. `docs/opcua.md` describes it for such programs.
//!
//! | module | subject |
//! |---|---|
//! | [`node`] | a node as data |
//! | [`types`] | the types: of a session, of a client, of their states |
//! | [`instance`] | the objects of one session: its signals, its clients |
//! | [`nodeset`] | nodes as a `NodeSet2` file (OPC 10000-6 annex F) |
//! | [`address_space`] | nodes in a server |
//! | [`seat`] | a client's place in the session, sans-IO: grants and answers, and which of them are distinguished |
//! | [`board`] | the session as all see it: written by its driver, read and answered over OPC UA |
//! | [`client`] | a seat as a client of the session |
//! | [`observer`] | the session's steps on the board |
//! | [`manager`], `call`, `value` | requests of OPC UA clients |
//! | [`service`] | the server |
//!
//! # Invariants
//! - What is served and what is published as `NodeSet2` are made of the same tables.
//! - Outputs count when their grant is answered, all at once; nothing that comes late or twice changes a step.
//! - A wall clock decides when to give up, never what a step computes.

pub mod address_space;
pub mod board;
mod call;
pub mod client;
pub mod instance;
pub mod item;
pub mod manager;
pub mod node;
pub mod nodeset;
pub mod observer;
pub mod seat;
pub mod service;
pub mod status;
pub mod types;
mod value;

pub use board::Board;
pub use client::SeatedClient;
pub use observer::BoardObserver;
pub use service::{Service, serve};
