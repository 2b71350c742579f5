//! The order of a value's bytes on a link. Packed bytes are little-endian; most PLCs are not.

use onescan_server::signal::SignalType;
use schemars::JsonSchema;
use serde::Deserialize;

/// Which byte of a number comes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ByteOrder {
    /// The most significant one, as in S7 and on the network.
    #[default]
    BigEndian,
    /// The least significant one.
    LittleEndian,
}

impl ByteOrder {
    /// Copies a packed value to or from its form on the link; both have its length.
    pub fn copy(self, from: &[u8], to: &mut [u8]) {
        to.copy_from_slice(from);
        if self == Self::BigEndian {
            to.reverse();
        }
    }
}

/// True for the types that are one number of whole bytes: all but BOOL, texts and lines of bytes.
pub fn is_number(ty: SignalType) -> bool {
    !matches!(ty, SignalType::BOOL | SignalType::String(_) | SignalType::Wstring(_) | SignalType::Bytes(_))
}
