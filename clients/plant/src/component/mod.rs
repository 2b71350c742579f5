//! Components: parts of machines by name, which a scene only has to parametrise and to wire.
//!
//! | module | subject |
//! |---|---|
//! | [`kind`] | what a kind of component is, as plain data |
//! | `declare` | parameters, signals and failures, stated once as structs and enums |
//! | `behaviour` | what every component is: a state and two halves of a turn |
//! | `draught` | gas that is drawn through a kiln, and what a blockage leaves of it |
//! | `dynamics` | lags, friction, sub-steps |
//! | `fluid` | flow of air and oil through orifices |
//! | `port_valves` | valves through which oil leaves a cylinder |
//! | `commanded` | drives with a force or torque command |
//! | `profile` | motion from rest to rest within limits |
//! | `library` | the kinds, a file each |
//! | `program` | a kind of the user's own: a function block, run by the soft PLC |
//! | [`origin`] | a kind of the library or of the user's own, and what makes components of it |
//! | [`page`] | a kind as a page for people |
//!
//! # Invariants
//! - A component is a function of its parameters, its state, its inputs and what it sees.
//! - All that it remembers is in its state, and the state is plain data that saves to bytes.
//! - What it states of itself is read by the scene, the schema, the documentation and the program.

pub(crate) mod behaviour;
pub(crate) mod commanded;
pub(crate) mod declare;
pub(crate) mod draught;
pub(crate) mod dynamics;
pub(crate) mod fluid;
pub mod instance;
pub mod kind;
pub(crate) mod library;
pub(crate) mod melt;
pub mod origin;
pub mod page;
pub(crate) mod port_valves;
pub(crate) mod profile;
pub(crate) mod program;
#[cfg(test)]
mod tests;
pub(crate) mod three_phase;

pub use instance::open_inputs;
pub use library::kinds;
