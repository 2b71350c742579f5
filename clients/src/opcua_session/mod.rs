//! Lockstep for any OPC UA client: the session's own information model (seed: Carlsson et al. 2012, sec. VII).
//!
//! | module | subject |
//! |---|---|
//! | [`model`] | the types of the model, one table for server and NodeSet |
//! | [`nodeset`] | the model as NodeSet2 XML |
//! | [`seat`] | a client's place: what it is granted, what it gives back |
//! | [`view`] | what an OPC UA client sees of the session |
//! | [`server`] | the address space, and the server |
//!
//! # Invariants
//! - Grants are numbered; inputs and time stay as they are until the grant is done, and outputs count from then only.
//! - A wish of an OPC UA client reaches the session at a step boundary, as any operator's.

pub mod model;
pub mod nodeset;
pub mod seat;
pub mod server;
pub mod view;

pub use seat::{Seat, SeatClient};
pub use server::{Desk, serve};
pub use view::{SessionView, Watcher};
