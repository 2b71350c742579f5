//! Contacts in which mechanisms take part, with Coulomb's law in all of them at once.
//!
//! The engine finds contacts; it also solves them, pair by pair, with joints between them that give way. What a mechanism
//! and the bodies around it do to each other is solved again here, from the state in which the step began, over the
//! mechanism's own coordinates (see `docs/decisions/018-friction-of-mechanisms.md`).
//!
//! | module | subject |
//! |---|---|
//! | `before` | bodies as a step began |
//! | `island` | what touches each other, and how that becomes rows |
//! | `problem` | rows: what is asked of velocities |
//! | `search` | impulses of all rows at once |
//! | `cone` | the friction of one contact |
//!
//! # Invariants
//! - What is computed follows from the state in which the step began and the contacts in it, in a fixed order.
//! - Nothing is kept from step to step.

mod before;
mod cone;
mod island;
mod problem;
mod search;

pub(super) use before::Before;
pub(super) use island::{Island, Part};
