//! Values of variables as literals, for people and tools: what is shown can be written back.
//!
//! | module | subject |
//! |---|---|
//! | [`show`] | bytes to literals |
//! | [`read`] | literals to bytes |

mod read;
mod show;

use thiserror::Error;

use super::{UnknownVariable, Variable, VariableAccess};

/// Why a variable was not written.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum WriteError {
    /// There is no such variable.
    #[error(transparent)]
    Unknown(#[from] UnknownVariable),
    /// It may not be written.
    #[error("`{path}` is {}", match .access { VariableAccess::Constant => "a constant", _ => "READ_ONLY" })]
    Protected {
        /// The variable.
        path: String,
        /// Why.
        access: VariableAccess,
    },
    /// The text is no value of its type.
    #[error("`{text}` is no value of `{path}`, which is {type_name}: {reason}")]
    Value {
        /// The variable.
        path: String,
        /// Its type.
        type_name: String,
        /// The text as given.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
}

impl Variable {
    /// An error unless it may be written.
    pub(crate) fn writable(&self) -> Result<(), WriteError> {
        match self.access {
            VariableAccess::ReadWrite => Ok(()),
            access => Err(WriteError::Protected { path: self.path.clone(), access }),
        }
    }
}
