//! The `onescan` program: loads a scenario, composes server, plant and PLC, runs them, reports.
//!
//! Modules in the order in which data flows through them; what is further down knows nothing of what is above:
//!
//! | module | subject |
//! |---|---|
//! | [`cli`] | the command line |
//! | [`train`] | lessons taken at panels, measured on virtual time |
//! | [`campaign`] | faults by the table, each with a verdict |
//! | [`explore`] | timings that links may have, tried |
//! | [`falsify`] | inputs and parameters that break what is expected, searched |
//! | [`minimise`] | the least of a case with which it still fails |
//! | [`mutate`] | small mistakes in the PLC's program, and whether they are noticed |
//! | [`review`] | snapshots looked at, accepted or rejected |
//! | [`compare`] | lockstep beside the other ways of bringing plant and PLC together |
//! | [`bisect`] | the commit since which a run is another |
//! | [`diff`] | where two recordings or snapshots part, and why |
//! | [`view`] | a recording as a page |
//! | [`report`] | what a recorded run produced |
//! | [`regress`] | all cases run, compared with reviewed snapshots, reported |
//! | [`why`] | the way from a signal back to the statement in which two runs part |
//! | [`repository`] | what a scenario was at other commits |
//! | [`snapshot`] | trajectories as small text, compared |
//! | [`shot`] | the machine at one time, as a picture |
//! | [`run`] | runs of a scenario: in lockstep or not, recorded, reported |
//! | [`freewheel`] | running without lockstep, to show what it is good for |
//! | `value_map` | a map of the scenario, of what clients show |
//! | [`past`] | the past of a session: moments that are kept, any other re-run |
//! | [`access`] | who may take part in sessions over a network |
//! | [`session`] | part in a session that another process serves |
//! | [`plc`] | a soft PLC as a process of its own |
//! | [`browse`] | what a real PLC has |
//! | [`map`] | where the points of a gateway lie |
//! | [`instrument`] | PLC projects made to run in lockstep, and back |
//! | [`check`] | PLC sources checked without being run |
//! | [`wiring`] | signals between clients, listed and drawn |
//! | [`show`] | a scenario with everything that it takes in, as one file |
//! | [`plant`] | scenes and components, described without a session |
//! | [`edit`] | a scenario wired and built in a browser |
//! | [`model`] | the states of a session, as a table and for a model checker |
//! | [`export`] | recordings in other forms |
//! | [`new`] | scenarios to begin with |
//! | [`io_list`] | inputs and outputs of a PLC, as engineering tools list them |
//! | [`interrupt`] | Ctrl-C |
//! | [`format`] | for whom the output is |
//! | [`error`] | errors of several commands, and exit codes |
//!
//! Invariants. This is the only crate that starts processes and prints. What a session computes is decided
//! in the crates below; nothing here can change a digest.

pub mod access;
pub mod bisect;
pub mod browse;
pub mod campaign;
pub mod check;
pub mod cli;
pub mod compare;
pub mod diff;
pub mod edit;
pub mod error;
pub mod explore;
pub mod export;
pub mod falsify;
pub mod format;
pub mod freewheel;
pub mod instrument;
pub mod interrupt;
pub mod io_list;
pub mod map;
pub mod minimise;
pub mod model;
pub mod mutate;
pub mod new;
pub mod past;
pub mod plant;
pub mod plc;
pub mod regress;
pub mod report;
pub mod repository;
pub mod review;
pub mod run;
pub mod session;
pub mod shot;
pub mod show;
pub mod snapshot;
pub mod train;
mod value_map;
pub mod view;
mod web;
pub mod why;
pub mod wiring;
