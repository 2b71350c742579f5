//! Searches for the run that fails, and for the least that makes it fail.
//!
//! | module | subject |
//! |---|---|
//! | [`campaign`] | faults by the table, each with a verdict |
//! | [`explore`] | timings that links may have, tried |
//! | [`falsify`] | inputs and parameters that break what is expected, searched |
//! | [`minimise`] | the least of a case with which it still fails |
//! | [`mutate`] | small mistakes in the PLC's program, and whether the cases notice them |
//! | `forest` | runs that fork from each other, their budget, workers and journal |

pub mod campaign;
pub mod explore;
pub mod falsify;
mod forest;
pub mod minimise;
pub mod mutate;
