//! Errors that several commands report, and their exit codes.
//!
//! Each command has an error of its own, which names all that can go wrong with it; these are the parts.
//!
//! | module | subject |
//! |---|---|
//! | [`usage`] | what was typed is wrong |
//! | [`unreadable`] | a file that was named cannot be read |
//! | [`process`] | another program cannot be started |
//! | [`listen`] | an address cannot be listened on |
//! | [`thread`] | the system has no thread to give |
//! | [`exit`] | exit codes |
//! | `sum` | errors that are one of several |

pub mod exit;
pub mod listen;
pub mod process;
mod sum;
pub mod thread;
pub mod unreadable;
pub mod usage;

pub use crate::sum_of_errors;
pub use exit::{Exit, ExitCode};
pub use listen::ListenError;
pub use process::SpawnError;
pub use thread::ThreadError;
pub use unreadable::Unreadable;
pub use usage::Usage;
