//! Free-wheeling: plant and PLC each on its own clock in real time, with an OPC-like link between
//! them (`[SDSP]` secs. II-C and III). It exists to *show* what lockstep removes: time delay, jitter,
//! race conditions and slow sampling.
//!
//! | module | subject |
//! |---|---|
//! | [`item`] | values that both sides can reach, one by one |
//! | [`link`] | the OPC-like exchange: update rate, one item at a time |
//! | [`synchronizer`] | a plant that follows a PLC's clock |
//! | `timeline` | what a case does to one client, by its own clock |
//! | [`wheel`] | a client that runs on its own clock |
//! | [`model`] | the same in computed time, with clocks drawn by a seed |
//! | `sleep` | sleep that a stop ends |
//! | [`run`] | all of them for some time, and what came of it |
//!
//! In real time nothing is random and nothing deterministic: all that differs between two runs comes from the clocks and the
//! scheduler of the machine. In computed time both are drawn, and a seed gives the same run everywhere.

mod item;
mod link;
pub mod model;
pub mod run;
mod sleep;
pub mod synchronizer;
mod timeline;
mod wheel;
