//! What gives the bytes of a PLC's state their meaning: the layout of the variables, and the code that
//! computed them. A compiled module has no part in it, so that plain, covered and traced builds of the same
//! sources take each other's states.
//!
//! | module | subject |
//! |---|---|
//! | [`layout`] | names, types and offsets of variables |
//! | [`layout_difference`] | the first variable in which two layouts differ |
//! | [`code`] | sources and constants, and in what two of them differ |
//! | [`bytes`] | numbers and texts as bytes |

pub(crate) mod bytes;
pub(crate) mod code;
pub(crate) mod layout;
mod layout_difference;

pub use code::CodeDifference;
pub use layout_difference::VariableDifference;

pub(crate) type Digest = [u8; 32];

pub(crate) fn digest(bytes: &[u8]) -> Digest {
    blake3::hash(bytes).into()
}
