//! Recordings: what a session leaves behind, and how it is read back.
//!
//! | module | subject |
//! |---|---|
//! | [`recorder`] | the folder of a recording, and the observer that fills it |
//! | [`place`] | the folder while it is made, and what lies there already |
//! | [`header`] | what was run |
//! | [`event`] | what happened beside the steps |
//! | `column`, `block` | the signals recorded; runs of steps |
//! | `sink` | the thread that encodes |
//! | [`flush_policy`], `early` | when steps reach the disk before their part is full |
//! | [`parquet`], [`csv`], [`mcap`] | the forms of a trajectory |
//! | [`reader`] | a recording read back |
//!
//! Invariants. A session knows nothing of its recording but the [`Observer`](onescan_server::observer::Observer)
//! that it calls; equal sessions leave equal files, to the byte; a killed process leaves all whole parts.

pub(crate) mod block;
pub(crate) mod column;
pub mod csv;
mod early;
pub mod event;
pub mod flush_policy;
pub mod header;
pub mod mcap;
pub mod parquet;
pub mod place;
pub mod reader;
pub mod recorder;
pub(crate) mod sink;

pub use column::Column;
pub use event::{Event, EventKind};
pub use flush_policy::FlushPolicy;
pub use header::{Header, Provenance, SourceFile};
pub use place::Place;
pub use reader::{ExportFormat, Recording, RecordingError, Row, Rows};
pub use recorder::{Choice, Recorder};
