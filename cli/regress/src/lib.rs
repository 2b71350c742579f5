//! What a change of PLC code or plant broke: sources checked, cases run against snapshots, differences explained.
//!
//! | module | subject |
//! |---|---|
//! | [`review`] | snapshots looked at, accepted or rejected |
//! | [`bisect`] | the commit since which a run is another |
//! | [`diff`] | where two recordings or snapshots part, and why |
//! | [`regress`] | all cases run, compared with reviewed snapshots, reported |
//! | [`grade`] | programs that were handed in for a task, marked |
//! | [`check`] | PLC sources checked without being run |
//! | [`why`] | the way from a signal back to the statement in which two runs part |
//! | [`repository`] | what a scenario was at other commits |
//! | [`snapshot`] | trajectories as small text, compared |

pub mod bisect;
pub mod check;
pub mod diff;
pub mod grade;
pub mod regress;
pub mod repository;
pub mod review;
pub mod snapshot;
pub mod why;
