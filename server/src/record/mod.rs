//! What a session leaves behind.
//!
//! | module | subject |
//! |---|---|
//! | [`recorder`] | the folder of a recording, and the observer that fills it |
//! | [`header`] | what was run |
//! | [`event`] | what happened beside the steps |
//! | `column`, `block` | the signals recorded; runs of steps |
//! | `sink` | the thread that encodes |
//! | [`parquet`], [`csv`], [`mcap`] | the forms of a trajectory |
//!
//! What is read back is in [`crate::recording`].

pub(crate) mod block;
pub(crate) mod column;
pub mod csv;
pub mod event;
pub mod header;
pub mod mcap;
pub mod parquet;
pub mod recorder;
pub(crate) mod sink;

pub use column::Column;
pub use event::{Event, EventKind};
pub use header::{Header, Provenance, SourceFile};
pub use recorder::{Choice, Recorder};

pub use crate::digest::Digest;
pub use crate::observer::{Observer, RecordError};
