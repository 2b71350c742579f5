//! The `onescan` program: arguments, errors, and the small tools around sessions.
//!
//! | module | subject |
//! |---|---|
//! | [`cli`] | the command line |
//! | [`new`] | scenarios to begin with |
//! | [`io_list`] | inputs and outputs of a PLC, as engineering tools list them |
//! | [`instrument`] | PLC projects made to run in lockstep, and back |
//! | [`show`] | a scenario with everything that it takes in, as one file |
//! | [`plant`] | scenes and components, described without a session |
//! | [`browse`] | what a real PLC has |
//! | [`map`] | where the points of a gateway lie |
//! | [`model`] | the states of a session, as a table and for a model checker |
//! | [`export`] | recordings in other forms |

pub mod browse;
pub mod cli;
pub mod export;
pub mod instrument;
pub mod io_list;
pub mod map;
pub mod model;
pub mod new;
pub mod plant;
pub mod show;
