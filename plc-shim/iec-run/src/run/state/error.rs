//! Why bytes were not taken as a state.

use thiserror::Error;

use super::tasks::PlanDifference;
use crate::application::identity::{CodeDifference, VariableDifference};

/// Why bytes were not taken as a state.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RestoreError {
    /// They do not begin as a state does.
    #[error("this is not a saved PLC state, or one of another version")]
    NotAState,
    /// They are a state of other variables.
    #[error(transparent)]
    OtherVariables(#[from] VariableDifference),
    /// They are a state of other tasks.
    #[error(transparent)]
    OtherTasks(#[from] PlanDifference),
    /// The variables and tasks are the same, the code is not; see
    /// [`CodePolicy::AnyCode`](super::CodePolicy::AnyCode).
    #[error("the saved state is from other sources: {0}")]
    OtherCode(CodeDifference),
    /// They end too early, go on too long or hold impossible numbers.
    #[error("the saved state is damaged")]
    Damaged,
}
