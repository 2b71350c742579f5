//! A serial line: bytes one behind the other, each as long as its bits last.

use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};

/// How fast bytes follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// Bits in a second.
    pub baud: NonZeroU32,
    /// Bits of a byte with its start, parity and stop bits: 10 for 8N1.
    pub bits_per_byte: NonZeroU32,
}

impl Rate {
    /// From the beginning of the first of `count` bytes, which follow without a gap, to the end of the last, ns, rounded up.
    ///
    /// ```
    /// use onescan_stream::serial::Rate;
    ///
    /// let rate = Rate::of(9600, 10).expect("not zero");
    /// assert_eq!(rate.lasting_ns(258), 268_750_000);
    /// assert_eq!(rate.lasting_ns(1026), 1_068_750_000);
    /// ```
    #[must_use]
    pub fn lasting_ns(self, count: u64) -> u64 {
        let bits = u128::from(count) * u128::from(self.bits_per_byte.get());
        let ns = (bits * 1_000_000_000).div_ceil(u128::from(self.baud.get()));
        u64::try_from(ns).unwrap_or(u64::MAX)
    }

    /// How many bytes are over after `ns`.
    #[must_use]
    pub fn within(self, ns: u64) -> u64 {
        let bits = u128::from(ns) * u128::from(self.baud.get()) / 1_000_000_000;
        u64::try_from(bits / u128::from(self.bits_per_byte.get())).unwrap_or(u64::MAX)
    }

    /// A rate; nothing if a number is 0.
    #[must_use]
    pub fn of(baud: u32, bits_per_byte: u32) -> Option<Self> {
        Some(Self { baud: NonZeroU32::new(baud)?, bits_per_byte: NonZeroU32::new(bits_per_byte)? })
    }
}

/// The sending side of a serial port.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Serial {
    /// Since when bytes have followed each other without a gap, ns, and how many of them are over.
    busy: Option<(u64, u64)>,
}

impl Serial {
    /// True while a byte is being sent.
    pub(super) fn is_busy(&self) -> bool {
        self.busy.is_some()
    }

    /// How many of `queued` bytes are over at `now_ns` and were not before.
    pub(super) fn done(&mut self, rate: Rate, now_ns: u64, queued: usize) -> usize {
        let Some((since_ns, over)) = &mut self.busy else { return 0 };
        let now_over = rate.within(now_ns.saturating_sub(*since_ns));
        let done = usize::try_from(now_over.saturating_sub(*over)).unwrap_or(usize::MAX).min(queued);
        *over += done as u64;
        if done == queued {
            self.busy = None;
        }
        done
    }

    /// Begins to send at `now_ns`, if bytes wait and none is being sent.
    pub(super) fn begin(&mut self, now_ns: u64, queued: usize) {
        if queued > 0 && self.busy.is_none() {
            self.busy = Some((now_ns, 0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_over_when_their_bits_are() {
        let rate = Rate::of(9600, 10).expect("not zero");
        for count in 1..3000 {
            let ns = rate.lasting_ns(count);
            assert_eq!((rate.within(ns), rate.within(ns - 1)), (count, count - 1), "{count}");
        }
        assert_eq!(rate.lasting_ns(1), 1_041_667);
        assert_eq!(rate.within(u64::MAX), u64::MAX / 1_000_000_000 * 960 + 681);
    }

    #[test]
    fn bytes_that_come_while_others_are_sent_follow_without_a_gap() {
        let (rate, mut serial) = (Rate::of(1000, 10).expect("not zero"), Serial::default());
        assert_eq!(serial.done(rate, 5_000_000, 0), 0);
        serial.begin(5_000_000, 2);
        assert_eq!(serial.done(rate, 14_999_999, 2), 0);
        assert_eq!(serial.done(rate, 16_000_000, 2), 1);
        serial.begin(16_000_000, 3);
        assert_eq!(serial.done(rate, 35_000_000, 3), 2);
        assert_eq!(serial.done(rate, 45_000_000, 1), 1);
        assert!(!serial.is_busy());
    }
}
