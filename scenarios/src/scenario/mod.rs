//! Scenarios: a folder that says everything about a session.
//!
//! | module | subject |
//! |---|---|
//! | [`file`] | `scenario.toml` as it is written |
//! | [`load`] | `scenario.toml` read and checked |
//! | `arrays` | signals written as arrays and patterns |
//! | [`expectations`] | what it expects of every run |
//! | [`case`] | one scenario, tried in many ways |
//! | [`compose`] | a scenario's plan and its clients |
//! | [`gateway`] | its real PLCs |
//! | [`watch`] | variables of its soft PLCs that a run looks at |
//! | `refusal` | a client that its session does not let in |
//! | [`error`] | what can be wrong with it, and where |

mod arrays;
pub mod case;
pub mod compose;
pub mod error;
pub mod expectations;
pub mod file;
pub mod gateway;
pub mod load;
mod refusal;
pub mod watch;

pub use error::ScenarioError;
pub use load::Scenario;
