//! Values of variables as literals, for people and tools: what is shown can be written back.
//!
//! | module | subject |
//! |---|---|
//! | [`show`] | bytes to literals |
//! | [`read`] | literals to bytes |
//! | [`text`] | elementary values to text, as the running program makes it too |
//! | [`radix`] | whole numbers in other bases |

mod radix;
mod read;
mod show;
pub(crate) mod text;

pub use radix::Radix;
pub use show::literal;

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
    Protected { path: String, access: VariableAccess },
    /// The text is not a value of its type.
    #[error("`{text}` is not a value of `{path}`, which is {type_name}: {reason}")]
    Value {
        path: String,
        type_name: String,
        /// The text as given.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
}

impl Variable {
    /// Offset, size and bit: what it takes of memory.
    pub(crate) fn place(&self) -> (u32, u32, Option<u8>) {
        (self.offset, self.size, self.bit)
    }

    /// Its bytes, as many as it has; of a bit 0 or 1. Fewer where memory is of another application.
    pub fn bytes(&self, memory: &[u8]) -> Vec<u8> {
        let start = self.offset as usize;
        let bytes = memory.get(start..start + self.size as usize).unwrap_or_default();
        match (self.bit, bytes) {
            (Some(bit), [byte, ..]) => vec![byte >> bit & 1],
            _ => bytes.to_vec(),
        }
    }

    /// Writes its bytes; of a bit, the bit alone.
    pub fn store(&self, bytes: &[u8], memory: &mut [u8]) {
        let start = self.offset as usize;
        match (self.bit, memory.get_mut(start..start + bytes.len()), bytes) {
            (Some(bit), Some([byte]), [value]) => *byte = *byte & !(1 << bit) | (value & 1) << bit,
            (_, Some(target), bytes) => target.copy_from_slice(bytes),
            (_, None, _) => {}
        }
    }

    /// An error unless it may be written.
    pub(crate) fn writable(&self) -> Result<(), WriteError> {
        match self.access {
            VariableAccess::ReadWrite => Ok(()),
            access => Err(WriteError::Protected { path: self.path.clone(), access }),
        }
    }
}
