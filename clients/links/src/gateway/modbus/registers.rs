//! Values in registers: within a register the high byte comes first (sec. 4.2); which word of a long value comes
//! first, each maker decides.

use onescan_server::signal::SignalType;

use super::map::{Entry, Span};
use crate::gateway::byte_order::ByteOrder;

/// Puts the value of `entry` into the words of `span`, if it lies there.
pub fn put(entry: &Entry, packed: &[u8], order: ByteOrder, span: &Span, words: &mut [u16]) {
    let Some(words) = within(entry, *span, words.len()).and_then(|range| words.get_mut(range)) else { return };
    let value = &packed[entry.point.range()];
    if let (SignalType::BOOL, Some(word)) = (entry.point.ty, words.first_mut()) {
        let mask = 1 << entry.address.bit.unwrap_or(0);
        // Other points may have other bits of this register.
        let rest = if entry.address.bit.is_some() { *word & !mask } else { 0 };
        *word = rest | if value[0] != 0 { mask } else { 0 };
        return;
    }
    for (word, bytes) in words.iter_mut().zip(value.chunks(2)) {
        *word = u16::from(bytes[0]) | bytes.get(1).map_or(0, |high| u16::from(*high) << 8);
    }
    if order == ByteOrder::BigEndian {
        words.reverse();
    }
}

/// Takes the value of `entry` out of the words of `span`, if it lies there. A BOOL that has a register is TRUE
/// unless that is 0.
pub fn take(entry: &Entry, words: &[u16], order: ByteOrder, span: &Span, packed: &mut [u8]) {
    let Some(words) = within(entry, *span, words.len()).and_then(|range| words.get(range)) else { return };
    let value = &mut packed[entry.point.range()];
    if let (SignalType::BOOL, Some(word)) = (entry.point.ty, words.first()) {
        value[0] = u8::from(entry.address.bit.map_or(*word != 0, |bit| word >> bit & 1 != 0));
        return;
    }
    let count = words.len();
    for (k, bytes) in value.chunks_mut(2).enumerate() {
        let word = words[if order == ByteOrder::BigEndian { count - 1 - k } else { k }].to_le_bytes();
        let len = bytes.len();
        bytes.copy_from_slice(&word[..len]);
    }
}

/// Where the words of `entry` are among those of `span`.
fn within(entry: &Entry, span: Span, len: usize) -> Option<std::ops::Range<usize>> {
    let start = usize::from(entry.address.at.checked_sub(span.at)?);
    let end = start + usize::from(entry.count);
    (entry.address.table == span.table && end <= len.min(usize::from(span.count))).then_some(start..end)
}
