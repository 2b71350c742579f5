//! The `onescan` program: loads a scenario, composes server, plant and PLC, runs them, reports.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`cli`] | the command line |
//! | [`run`] | runs of a scenario: in lockstep or not, recorded, reported |
//! | [`regress`] | all cases run, compared with reviewed snapshots, reported |
//! | [`review`] | snapshots looked at, accepted or rejected |
//! | [`export`], [`diff`], [`bisect`] | recordings in other forms; where two part and why; since which commit |
//! | [`new`] | scenarios to begin with |
//! | [`check`] | PLC sources checked without being run |
//! | [`instrument`] | PLC projects made to run in lockstep, and back |
//! | [`wiring`] | signals between clients, told and drawn |
//! | [`plant`] | scenes and components, told without a session |
//! | [`freewheel`] | running without lockstep, to show what it is good for |
//! | [`browse`] | what a real PLC has |
//! | [`plc`] | a soft PLC as a process of its own |
//!
//! Invariants. This is the only crate that starts processes and prints. What a session computes is decided
//! in the crates below; nothing here can change a digest.

pub mod bisect;
pub mod browse;
pub mod check;
pub mod cli;
pub mod diff;
pub mod export;
pub mod freewheel;
pub mod instrument;
pub mod new;
pub mod plant;
pub mod plc;
pub mod regress;
pub mod review;
pub mod run;
pub mod wiring;
