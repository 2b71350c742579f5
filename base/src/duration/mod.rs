//! The text forms of durations. Each form has one grammar and one printer, and what is printed reads back.
//!
//! | module | form | where |
//! |---|---|---|
//! | [`plain`] | `10ms`, `2.5 s` | scenario files, the command line, messages |
//! | [`iec`] | `1d2h3m4s5ms`, behind `T#` or `LT#` | PLC programs |
//! | [`xml`] | `PT0.02S` | PLCopen XML |

pub mod iec;
pub mod plain;
pub mod xml;

pub use iec::{IecDuration, IecDurationError};
pub use plain::DurationError;
pub use xml::XmlDuration;
