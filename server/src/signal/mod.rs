//! Signals: named, typed values with exactly one writer.
//!
//! | module | subject |
//! |---|---|
//! | [`name`] | what a signal and a client may be called |
//! | [`pattern`] | patterns of signal names |
//! | [`port`] | what one client reads or writes, and how it finds its values |
//!
//! The types of signals and the bytes and texts of their values are those of the ground floor, `onescan-base`.

pub mod name;
pub mod pattern;
pub mod port;

use serde::{Deserialize, Serialize};

pub use name::{BadName, ClientName, SignalName};
pub use onescan_base::signal_type::{SignalType, UnknownType};
pub use onescan_base::value::{BadText, BadValue};
pub use onescan_base::{did_you_mean, nearest};
pub use port::{Port, PortLayout, Slot, SlotError, SlotType};

/// The index of a signal in its session: the rank of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct SignalId(pub(crate) u32);

impl SignalId {
    /// The index into tables that hold one row a signal.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A signal as the scenario declares it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalDecl {
    /// Unique in the session.
    pub name: SignalName,
    /// The type that every client must agree to.
    #[serde(rename = "type")]
    pub ty: SignalType,
    /// The only client that may write it; where absent, the first that joins as its writer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub writer: Option<ClientName>,
    /// The unit of the value, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}
