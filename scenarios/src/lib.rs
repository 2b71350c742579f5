//! Scenarios: a folder that says everything about a session, read and checked.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | `form` | the forms of values in the files, for schemas |
//! | `keys` | the keys of a file's type |
//! | [`file`] | `scenario.toml` as it is written |
//! | [`look_file`] | its `[[view]]`, `[[figure]]` and `[[look]]` as they are written |
//! | [`report_file`] | its `[report]` as it is written |
//! | [`map_file`], `map` | its `[[map]]` as it is written, and what must hold of them |
//! | [`timing_file`] | its `[timing]` as it is written |
//! | [`falsify_file`] | its `[falsify]` as it is written |
//! | [`panel_file`], `panel` | its `[[panel]]` as they are written, and what must hold of them |
//! | `timed` | the keys that say when, of all entries that have them |
//! | [`disturbance_file`] | faults on the way of signals, as several files write them |
//! | [`value_names`] | names of a signal's values |
//! | [`permission`] | which files it may read, and whether it may start programs |
//! | `texts`, `merge`, `base` | places in several files; a file that takes in another; `base` of `scenario.toml` |
//! | [`load`], `files` | `scenario.toml` read and checked; all files that it is made of |
//! | `missing` | what may have been meant by a file or folder that is not there |
//! | `places` | where in the text something stands whose place is lost when it is read |
//! | `whole` | a scenario as one file, with everything that it takes in |
//! | `arrays` | signals written as arrays and patterns |
//! | [`expectations`], [`start`] | what it expects of every run; what must hold before virtual time runs |
//! | [`case`] | one scenario, tried in many ways |
//! | [`apply`] | a case put on its scenario |
//! | [`lesson`] | `lessons.toml`: what operators are trained in |
//! | [`schema`] | the JSON schemas of both files |
//! | [`compose`] | a scenario's plan and its clients |
//! | `programs`, `program` | other programs in the place of those that it names; the scenario with them |
//! | [`mistake`] | a small mistake in the program of a soft PLC |
//! | `mistaken` | the scenario with it |
//! | `mutants` | its cases, with the mutants that campaigns try |
//! | `compilations` | soft PLCs compiled once for all cases |
//! | [`timing`], `timing_tolerance` | its `[timing]`, bound to its signals; all that it allows, tasks included |
//! | [`falsify`] | its `[falsify]`, bound to its signals and clients |
//! | [`ports_file`], `ports` | the ports and files of soft PLCs, as they are written and made |
//! | [`gateway`] | its real PLCs |
//! | `undriven` | inputs of its soft PLCs that nobody drives |
//! | [`watch`] | variables of its soft PLCs that a run looks at |
//! | [`figure`], [`look`] | what is drawn beside the bodies of plants, and what they look like while something holds |
//! | [`visible`] | which bodies a look is of |
//! | `refusal` | a client that its session does not let in |
//! | [`expect`] | what a run must show: signal temporal logic |
//! | [`report`] | what a run produced, and what held it up |
//! | [`mode`] | in lockstep or not |
//! | [`template`], [`task`] | scenarios to begin with, and machines to learn on, as texts |
//! | [`handed_out`] | which files of a task are for those who solve it |
//! | [`error`] | what can be wrong with it, and where |
//!
//! Invariants. This is the only crate that reads scenario files. It starts no process, runs no session
//! and prints nothing.

pub mod apply;
mod arrays;
mod base;
pub mod case;
mod compilations;
pub mod compose;
pub mod disturbance_file;
pub mod error;
pub mod expect;
pub mod expectations;
pub mod falsify;
pub mod falsify_file;
pub mod figure;
pub mod file;
mod files;
mod form;
pub mod gateway;
pub mod handed_out;
mod keys;
pub mod lesson;
pub mod load;
pub mod look;
pub mod look_file;
mod map;
pub mod map_file;
mod merge;
mod missing;
pub mod mistake;
mod mistaken;
pub mod mode;
mod mutants;
mod operated;
mod panel;
pub mod panel_file;
pub mod panel_picture;
pub mod permission;
mod places;
mod ports;
pub mod ports_file;
mod program;
mod programs;
mod refusal;
pub mod report;
pub mod report_file;
pub mod schema;
pub mod start;
mod structure;
pub mod task;
pub mod template;
mod texts;
mod timed;
pub mod timing;
pub mod timing_file;
mod timing_tolerance;
mod undriven;
pub mod value_names;
pub mod visible;
pub mod watch;
mod whole;

pub use error::ScenarioError;
pub use load::Scenario;
pub use mode::Mode;
