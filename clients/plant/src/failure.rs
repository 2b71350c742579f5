//! Why a failure or a repair of a running plant is refused.
//!
//! Failures are switched on and off while the plant runs. They stand beside the scene's own
//! `[[failure]]` switches: a mode is on if either says so. What is on belongs to the plant's state,
//! not to its identity.

use thiserror::Error;

use super::scene::UnknownFailure;

/// Why a failure or a repair is refused. The plant stays as it was.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FailureRefused {
    /// The scene does not have the component, or its kind does not have the mode.
    #[error(transparent)]
    Unknown(#[from] UnknownFailure),
    /// A repair of what [`Plant::fail`](super::Plant::fail) has not made fail; the scene's own
    /// switches are the scene's to end.
    #[error("component `{component}` has not been made to fail by `{mode}`, so it cannot be repaired")]
    NotFailed { component: String, mode: String },
    /// A failure or a repair before the set-up, when there is nothing that could fail yet.
    #[error("component `{component}` cannot fail or be repaired before the set-up")]
    BeforeSetUp { component: String },
}
