//! One direction of a line of bytes as the value of a signal, `BYTES[n]`.
//!
//! A value holds how many bytes were ever put on the line and the last n of them, each at its number modulo n. A reader
//! keeps a count of its own and takes what it has not seen, so a line is a signal like any other: with one writer, in
//! the digest, in recordings and checkpoints. What a reader leaves for longer than n bytes is lost to it, as on a line.
//!
//! | bytes | meaning, little-endian |
//! |---|---|
//! | 0 to 7 | `count`: bytes ever put on the line |
//! | 8 to 15 | `since`: the count when the present connection began; 0 on a line without connections |
//! | 16 to 23 | `acknowledged`: bytes that the writer has read of the other direction; 0 on a line without connections |
//! | 24 to 27 | `link`: connects and disconnects so far, odd while connected; 0 on a line without connections |
//! | 28 to 27 + n | the byte of number i at i modulo n |
//! | the next ⌈n/8⌉ | bit i modulo n, from the lowest of the first byte: that byte was lost on its way |

pub use crate::signal_type::{DEFAULT_WINDOW, WINDOW_MAX, line_size as size};
use crate::signal_type::{LINE_HEADER as HEADER, SignalType};

/// A value that is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ByteLine<'v> {
    window: u16,
    value: &'v [u8],
}

/// A value that is changed.
#[derive(Debug, PartialEq, Eq)]
pub struct ByteLineMut<'v> {
    window: u16,
    value: &'v mut [u8],
}

/// What is at one place of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// A byte that arrives.
    Byte(u8),
    /// A byte was sent here, and lost on its way.
    Lost,
}

impl<'v> ByteLine<'v> {
    /// The value of a signal of type `ty`; nothing if that is not a line, or the bytes are not as many as it has.
    ///
    /// ```
    /// use onescan_base::SignalType;
    /// use onescan_base::byte_line::{ByteLine, ByteLineMut, Sent};
    ///
    /// let ty = SignalType::Bytes(8);
    /// let mut value = vec![0; ty.size()];
    /// ByteLineMut::of(ty, &mut value).expect("a line").put(0x41);
    /// let line = ByteLine::of(ty, &value).expect("a line");
    /// assert_eq!((line.count(), line.at(0)), (1, Sent::Byte(0x41)));
    /// ```
    #[must_use]
    pub fn of(ty: SignalType, value: &'v [u8]) -> Option<Self> {
        let SignalType::Bytes(window) = ty else { return None };
        (value.len() == size(window)).then_some(Self { window, value })
    }

    /// Bytes in the window.
    #[must_use]
    pub const fn window(&self) -> u16 {
        self.window
    }

    /// Bytes ever put on the line: the number of the next one.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.number(0)
    }

    /// The number of the first byte of the present connection.
    #[must_use]
    pub fn since(&self) -> u64 {
        self.number(8)
    }

    /// Bytes that the writer has read of the other direction.
    #[must_use]
    pub fn acknowledged(&self) -> u64 {
        self.number(16)
    }

    /// Connects and disconnects so far; odd while connected.
    #[must_use]
    pub fn link(&self) -> u32 {
        let mut bytes = [0; 4];
        bytes.copy_from_slice(&self.value[24..HEADER]);
        u32::from_le_bytes(bytes)
    }

    /// The number of the oldest byte that is still there.
    #[must_use]
    pub fn oldest(&self) -> u64 {
        self.count().saturating_sub(u64::from(self.window))
    }

    /// What is at the place of byte `number`: of another byte, if that is not in the window.
    #[must_use]
    pub fn at(&self, number: u64) -> Sent {
        let at = place(self.window, number);
        let lost = self.value[HEADER + usize::from(self.window) + at / 8] >> (at % 8) & 1 == 1;
        if lost { Sent::Lost } else { Sent::Byte(self.value[HEADER + at]) }
    }

    fn number(&self, at: usize) -> u64 {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&self.value[at..at + 8]);
        u64::from_le_bytes(bytes)
    }
}

impl<'v> ByteLineMut<'v> {
    /// The value of a signal of type `ty`; nothing if that is not a line, or the bytes are not as many as it has.
    #[must_use]
    pub fn of(ty: SignalType, value: &'v mut [u8]) -> Option<Self> {
        let SignalType::Bytes(window) = ty else { return None };
        (value.len() == size(window)).then_some(Self { window, value })
    }

    /// The same, looked at.
    #[must_use]
    pub fn line(&self) -> ByteLine<'_> {
        ByteLine { window: self.window, value: self.value }
    }

    /// Puts a byte on the line.
    pub fn put(&mut self, byte: u8) {
        let count = self.line().count();
        self.set(count, Sent::Byte(byte));
        self.value[..8].copy_from_slice(&count.wrapping_add(1).to_le_bytes());
    }

    /// Changes what is at the place of byte `number`.
    pub fn set(&mut self, number: u64, sent: Sent) {
        let at = place(self.window, number);
        let (byte, lost) = match sent {
            Sent::Byte(byte) => (byte, 0),
            Sent::Lost => (0, 1),
        };
        self.value[HEADER + at] = byte;
        let bits = &mut self.value[HEADER + usize::from(self.window) + at / 8];
        *bits = *bits & !(1 << (at % 8)) | lost << (at % 8);
    }

    /// Says how many bytes of the other direction have been read.
    pub fn acknowledge(&mut self, read: u64) {
        self.value[16..24].copy_from_slice(&read.to_le_bytes());
    }

    /// Begins a connection, if `link` is odd, at the present count; ends one, if it is even.
    pub fn set_link(&mut self, link: u32) {
        if link % 2 == 1 {
            self.value.copy_within(..8, 8);
        }
        self.value[24..HEADER].copy_from_slice(&link.to_le_bytes());
    }
}

fn place(window: u16, number: u64) -> usize {
    // A window has at least one byte, and the rest is below it.
    (number % u64::from(window.max(1))) as usize
}

/// Clears the bits behind the last byte of a window, which mean nothing.
pub(crate) fn canonicalise(window: u16, value: &mut [u8]) {
    if let (Some(last), used @ 1..) = (value.last_mut(), window % 8) {
        *last &= (1 << used) - 1;
    }
}

/// The value as text: `count since acknowledged link`, then the window in hexadecimal, a lost byte as `--`.
pub(crate) fn to_text(window: u16, value: &[u8]) -> String {
    use std::fmt::Write;
    let line = ByteLine { window, value };
    let mut text = format!("{} {} {} {} ", line.count(), line.since(), line.acknowledged(), line.link());
    for at in 0..u64::from(window) {
        match line.at(at) {
            // writing to a text cannot fail
            Sent::Byte(byte) => {
                let _ = write!(text, "{byte:02x}");
            }
            Sent::Lost => text.push_str("--"),
        }
    }
    text
}

/// The value of a text that [`to_text`] gives.
pub(crate) fn parse_text(window: u16, text: &str) -> Option<Vec<u8>> {
    let mut words = text.split(' ');
    let mut value = Vec::with_capacity(size(window));
    for _ in 0..3 {
        value.extend_from_slice(&words.next()?.parse::<u64>().ok()?.to_le_bytes());
    }
    value.extend_from_slice(&words.next()?.parse::<u32>().ok()?.to_le_bytes());
    let digits = words.next()?.as_bytes();
    if words.next().is_some() || digits.len() != 2 * usize::from(window) {
        return None;
    }
    value.resize(size(window), 0);
    let mut line = ByteLineMut { window, value: &mut value };
    for (number, pair) in (0..).zip(digits.chunks_exact(2)) {
        line.set(
            number,
            match pair {
                b"--" => Sent::Lost,
                _ => Sent::Byte(u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?),
            },
        );
    }
    Some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TY: SignalType = SignalType::Bytes(11);

    #[test]
    fn the_window_holds_the_last_bytes() {
        let mut value = vec![0; TY.size()];
        let mut line = ByteLineMut::of(TY, &mut value).expect("a line");
        (0..25).for_each(|byte| line.put(byte));
        let line = line.line();
        assert_eq!((line.count(), line.oldest(), line.window()), (25, 14, 11));
        assert!((14..25).all(|number| line.at(number) == Sent::Byte(number as u8)));
    }

    #[test]
    fn a_byte_that_is_put_again_is_not_lost() {
        let mut value = vec![0; TY.size()];
        let mut line = ByteLineMut::of(TY, &mut value).expect("a line");
        (0..11).for_each(|byte| line.put(byte));
        line.set(0, Sent::Lost);
        assert_eq!((line.line().at(0), line.line().at(1)), (Sent::Lost, Sent::Byte(1)));
        line.put(77);
        assert_eq!(line.line().at(11), Sent::Byte(77));
    }

    #[test]
    fn a_connection_begins_where_the_line_is() {
        let mut value = vec![0; TY.size()];
        let mut line = ByteLineMut::of(TY, &mut value).expect("a line");
        (0..3).for_each(|byte| line.put(byte));
        line.set_link(1);
        line.acknowledge(9);
        assert_eq!((line.line().since(), line.line().link(), line.line().acknowledged()), (3, 1, 9));
        line.put(1);
        line.set_link(2);
        assert_eq!((line.line().since(), line.line().link()), (3, 2));
    }

    #[test]
    fn what_is_not_a_line_is_refused() {
        assert_eq!(ByteLine::of(SignalType::BOOL, &[0]), None);
        assert_eq!(ByteLine::of(TY, &[0; 4]), None);
        for wrong in ["", "1 2 3 4", "1 2 3 4 00", "x 0 0 0 0011223344556677889900", "0 0 0 0 001122334455667788990g"] {
            assert_eq!(parse_text(11, wrong), None, "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn a_value_survives_its_text(raw in proptest::collection::vec(any::<u8>(), TY.size())) {
            let mut value = raw;
            canonicalise(11, &mut value);
            let mut line = ByteLineMut { window: 11, value: &mut value };
            // a lost byte has no value
            for number in 0..11 {
                let sent = line.line().at(number);
                line.set(number, sent);
            }
            prop_assert_eq!(parse_text(11, &to_text(11, &value)), Some(value));
        }
    }
}
