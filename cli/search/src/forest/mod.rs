//! Runs that fork from each other: what all searches have in common, whatever they look for.
//!
//! | module | subject |
//! |---|---|
//! | `session` | the session of a trial, all of it in this process |
//! | `fork_points` | boundaries at which a run keeps checkpoints |
//! | `base_run` | runs that others fork from, and which of them a trial forks from |
//! | `budget` | how many runs are allowed |
//! | `workers` | several trials at a time |
//! | `journal` | runs that are done, for a search that continues after it was killed |
//!
//! **Invariants.** What comes of a trial depends neither on where it forked nor on the number of workers. A journal holds
//! whole lines only, however its writers end.

mod base_run;
mod budget;
mod fork_points;
mod journal;
mod session;
mod workers;

pub(crate) use base_run::{BaseRun, Forest, TrialRun};
pub(crate) use budget::Budget;
pub(crate) use fork_points::ForkPoints;
pub(crate) use journal::{Journal, JournalError, append, read};
pub(crate) use session::{SearchKind, form, now_and_then, run_until, start, whole};
pub(crate) use workers::{Workers, batches, each};
