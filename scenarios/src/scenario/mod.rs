//! Scenarios: a folder that says everything about a session.
//!
//! | module | subject |
//! |---|---|
//! | [`file`] | `scenario.toml` as it is written |
//! | [`load`] | `scenario.toml` read and checked |
//! | [`expectations`] | what it expects of every run |
//! | [`compose`] | a scenario's plan and its clients |
//! | [`gateway`] | its real PLCs |
//! | [`error`] | what can be wrong with it, and where |

pub mod compose;
pub mod error;
pub mod expectations;
pub mod file;
pub mod gateway;
pub mod load;

pub use error::ScenarioError;
pub use load::Scenario;
