//! A set of bytes and bits of memory: whether something lies in it takes as long for a hundred thousand places as for one.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Places of memory, of which some may be one bit of each of their bytes.
#[derive(Debug, Clone, Default)]
pub struct MemorySet {
    /// Whole bytes: where each stretch begins and ends; no two meet.
    bytes: BTreeMap<u32, u32>,
    bits: BTreeSet<(u32, u8)>,
}

impl MemorySet {
    /// Adds bytes, or one bit of each of them.
    pub fn insert(&mut self, bytes: Range<u32>, bit: Option<u8>) {
        if bytes.is_empty() {
            return;
        }
        let Some(bit) = bit else { return self.insert_whole(bytes) };
        self.bits.extend(bytes.map(|byte| (byte, bit)));
    }

    /// True if one of its places has bits in common with these bytes, or with one bit of each of them.
    pub fn meets(&self, bytes: Range<u32>, bit: Option<u8>) -> bool {
        if bytes.is_empty() {
            return false;
        }
        let before = self.bytes.range(..bytes.end).next_back();
        let in_whole = before.is_some_and(|(_, end)| *end > bytes.start);
        in_whole
            || match bit {
                Some(bit) => bytes.into_iter().any(|byte| self.bits.contains(&(byte, bit))),
                None => self.bits.range((bytes.start, 0)..(bytes.end, 0)).next().is_some(),
            }
    }

    fn insert_whole(&mut self, Range { mut start, mut end }: Range<u32>) {
        // Stretches that meet it become one with it.
        while let Some((&other, &until)) = self.bytes.range(..=end).next_back().filter(|(_, until)| **until >= start) {
            self.bytes.remove(&other);
            (start, end) = (start.min(other), end.max(until));
        }
        self.bytes.insert(start, end);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn place() -> impl Strategy<Value = (Range<u32>, Option<u8>)> {
        (0..60_u32, 0..6_u32, proptest::option::of(0..8_u8)).prop_map(|(start, len, bit)| (start..start + len, bit))
    }

    proptest! {
        #[test]
        fn it_meets_what_one_of_its_places_meets(
            places in proptest::collection::vec(place(), 0..40),
            asked in proptest::collection::vec(place(), 40),
        ) {
            let mut set = MemorySet::default();
            for (bytes, bit) in &places {
                set.insert(bytes.clone(), *bit);
            }
            for (bytes, bit) in asked {
                let meets = |(other, other_bit): &(Range<u32>, Option<u8>)| {
                    let is_same_bit = bit.is_none() || other_bit.is_none() || bit == *other_bit;
                    other.clone().any(|byte| bytes.contains(&byte)) && is_same_bit
                };
                prop_assert_eq!(set.meets(bytes.clone(), bit), places.iter().any(meets));
            }
        }
    }
}
