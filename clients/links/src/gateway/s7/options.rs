//! What a scenario says of an S7 link.

use schemars::JsonSchema;
use serde::Deserialize;

/// The keys of `[clients.NAME.gateway.s7]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Rack of the CPU.
    pub rack: u8,
    /// Slot of the CPU: 0 or 1 in an S7-1200 or 1500, 2 in an S7-300.
    pub slot: u8,
    /// Number of the block that the gateway writes.
    pub db_to_plc: u16,
    /// Number of the block that it reads.
    pub db_from_plc: u16,
}

impl Default for Options {
    fn default() -> Self {
        Self { rack: 0, slot: 1, db_to_plc: 1, db_from_plc: 2 }
    }
}

impl Options {
    /// The CPU's end of the transport: what the connection is for (1: a programming device), then rack and slot.
    pub(crate) fn tsap(self) -> [u8; 2] {
        /// The slots of a rack.
        const SLOTS: u8 = 32;
        [1, self.rack.wrapping_mul(SLOTS) | self.slot & (SLOTS - 1)]
    }
}
