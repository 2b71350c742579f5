//! Runs scenarios: composes server, plant and PLC, drives them, records and shows what happens.
//!
//! Modules in the order in which data flows through them; what is further down knows nothing of what is above:
//!
//! | module | subject |
//! |---|---|
//! | [`doctor`] | what this program has, and what it finds on this machine |
//! | [`train`] | lessons taken at panels, measured on virtual time |
//! | [`compare`] | lockstep beside the other ways of bringing plant and PLC together |
//! | [`view`] | a recording as a page |
//! | [`report`] | what a recorded run produced |
//! | [`shot`] | the machine at one time, as a picture |
//! | [`run`] | runs of a scenario: in lockstep or not, recorded, reported |
//! | [`operated`] | what operators did, as entries of a case |
//! | [`freewheel`] | running without lockstep, to show what goes wrong then |
//! | [`value_map`] | a map of the scenario, of what clients show |
//! | [`scene_drawing`] | a scene as a picture |
//! | [`past`] | the past of a session: moments that are kept, any other re-run |
//! | [`web`] | the page of a session |
//! | [`access`] | who may take part in sessions over a network |
//! | [`session`] | part in a session that another process serves |
//! | [`plc`] | a soft PLC as a process of its own |
//! | `environment` | what programs that are not ours see of the environment |
//! | [`how_far`] | how far a command has got that a signal ends |
//! | [`interrupt`] | Ctrl-C |
//! | [`job`] | on Windows, what is started ends with this process |
//! | [`format`] | for whom the output is |
//! | [`error`] | errors of several commands, and exit codes |
//!
//! Invariant: what a session computes is decided in the crates below; nothing here can change a digest.

pub mod access;
pub mod compare;
pub mod doctor;
mod environment;
pub mod error;
pub mod format;
pub mod freewheel;
pub mod how_far;
pub mod interrupt;
pub mod job;
pub mod operated;
pub mod past;
pub mod plc;
pub mod report;
pub mod run;
pub mod scene_drawing;
pub mod session;
pub mod shot;
pub mod train;
pub mod value_map;
pub mod view;
pub mod web;
