//! Values to pages.
//!
//! | values | encoding |
//! |---|---|
//! | that hardly ever change | `RLE_DICTIONARY`: each value once, then runs; `RLE` for BOOL |
//! | that change | `PLAIN`, compressed by snappy if that pays, which is tried on a part |
//! | that grow by the same each step | `DELTA_BINARY_PACKED` without a bit for each |

use std::cmp::Ordering;

use parquet::basic::Encoding;

use super::schema::Held;
use super::transpose::Values;

/// Runs are longer than this on average where they are written as runs.
const RUN_MIN: usize = 8;
/// Most values in a dictionary.
const DICTIONARY_MAX: usize = 255;

/// The pages of a column in a block, before they are compressed.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Encoded {
    /// A dictionary page, and the number of its values.
    pub(super) dictionary: Option<(Vec<u8>, u32)>,
    pub(super) data: Vec<u8>,
    pub(super) encoding: Encoding,
}

/// Encodes `rows` values of `size` bytes each.
pub(super) fn encode(
    values: Values<'_>,
    rows: usize,
    size: usize,
    held: Held,
    text: &dyn Fn(&[u8]) -> String,
) -> Encoded {
    let runs = match values {
        Values::One(value) => Some(vec![(value, rows)]),
        Values::All(values) => runs(values, size, rows / RUN_MIN),
    };
    match (runs, values, held) {
        (Some(runs), _, Held::Bit) => bit_runs(&runs),
        (Some(runs), _, _) => match dictionary(&runs) {
            Some(distinct) => dictionary_runs(&runs, &distinct, held, text),
            // There are several values, so all of them are at hand.
            None => plain(values.bytes(), size, held, text),
        },
        (None, ..) => plain(values.bytes(), size, held, text),
    }
}

/// The runs of equal values, unless there are more than `runs_max`.
fn runs(values: &[u8], size: usize, runs_max: usize) -> Option<Vec<(&[u8], usize)>> {
    match size {
        1 => runs_of(values, runs_max, run_length::<1>),
        2 => runs_of(values, runs_max, run_length::<2>),
        4 => runs_of(values, runs_max, run_length::<4>),
        8 => runs_of(values, runs_max, run_length::<8>),
        _ => runs_of(values, runs_max, |values| {
            let first = values.get(..size);
            (size, values.chunks_exact(size).take_while(|value| Some(*value) == first).count())
        }),
    }
}

/// The runs, each found by `length`: bytes of its first value, and how often that stands there.
fn runs_of(values: &[u8], runs_max: usize, length: impl Fn(&[u8]) -> (usize, usize)) -> Option<Vec<(&[u8], usize)>> {
    let mut runs = Vec::new();
    let mut rest = values;
    while !rest.is_empty() && runs.len() <= runs_max {
        let (size, count) = length(rest);
        runs.push((rest.get(..size)?, count));
        rest = rest.get(size * count..)?;
    }
    rest.is_empty().then_some(runs)
}

/// How often the first value stands at the beginning. Values are compared many at a time: most
/// signals stand still for long.
fn run_length<const N: usize>(values: &[u8]) -> (usize, usize) {
    const MANY: usize = 32;
    let values = values.as_chunks::<N>().0;
    let Some(first) = values.first() else { return (N, 0) };
    // Without a way out within the chunk, so that all of it is compared at once.
    let differ =
        |many: &&[[u8; N]; MANY]| many.iter().fold(0_u8, |differ, value| differ | u8::from(value != first)) != 0;
    let equal = values.as_chunks::<MANY>().0.iter().take_while(|many| !differ(many)).count() * MANY;
    (N, equal + values[equal..].iter().take_while(|value| *value == first).count())
}

/// The values of all runs in their order, each once; nothing if there are too many.
fn dictionary<'v>(runs: &[(&'v [u8], usize)]) -> Option<Vec<&'v [u8]>> {
    let mut distinct: Vec<&[u8]> = runs.iter().map(|(value, _)| *value).collect();
    distinct.sort_unstable_by(|a, b| order(a, b));
    distinct.dedup();
    (distinct.len() <= DICTIONARY_MAX).then_some(distinct)
}

/// Any order, but the same everywhere.
fn order(a: &[u8], b: &[u8]) -> Ordering {
    match (number(a), number(b)) {
        (Some(a), Some(b)) => a.cmp(&b),
        _ => a.cmp(b),
    }
}

/// A value of an elementary size as a number.
fn number(value: &[u8]) -> Option<u64> {
    match value.len() {
        1 => value.first().copied().map(u64::from),
        2 => Some(u64::from(u16::from_le_bytes(value.try_into().ok()?))),
        4 => Some(u64::from(u32::from_le_bytes(value.try_into().ok()?))),
        8 => Some(u64::from_le_bytes(value.try_into().ok()?)),
        _ => None,
    }
}

fn dictionary_runs(runs: &[(&[u8], usize)], distinct: &[&[u8]], held: Held, text: &dyn Fn(&[u8]) -> String) -> Encoded {
    let mut entries = Vec::new();
    for value in distinct {
        plain_value(value, held, text, &mut entries);
    }
    // Indices take a byte at most, whatever their width in bits.
    let width = (usize::BITS - (distinct.len() - 1).leading_zeros()).max(1);
    let mut data = vec![width as u8];
    for (value, count) in runs {
        varint((*count as u64) << 1, &mut data);
        data.push(distinct.binary_search_by(|other| order(other, value)).unwrap_or(0) as u8);
    }
    Encoded { dictionary: Some((entries, distinct.len() as u32)), data, encoding: Encoding::RLE_DICTIONARY }
}

/// A data page of the first version gives the length of its runs.
fn bit_runs(runs: &[(&[u8], usize)]) -> Encoded {
    let mut data = vec![0; 4];
    for (value, count) in runs {
        varint((*count as u64) << 1, &mut data);
        data.push(value[0]);
    }
    let length = (data.len() - 4) as u32;
    data[..4].copy_from_slice(&length.to_le_bytes());
    Encoded { dictionary: None, data, encoding: Encoding::RLE }
}

fn plain(values: &[u8], size: usize, held: Held, text: &dyn Fn(&[u8]) -> String) -> Encoded {
    let data = match held {
        Held::Bit => values.chunks(8).map(|bits| bits.iter().rev().fold(0, |byte, bit| byte << 1 | bit)).collect(),
        Held::Same(_) => values.to_vec(),
        Held::Word { signed, .. } => {
            let mut data = vec![0; values.len() / size * 4];
            let wide = data.as_chunks_mut::<4>().0.iter_mut();
            match (size, signed) {
                (2, true) => wide.zip(values.as_chunks::<2>().0).for_each(|(wide, value)| {
                    *wide = i32::from(i16::from_le_bytes(*value)).to_le_bytes();
                }),
                (2, false) => wide.zip(values.as_chunks::<2>().0).for_each(|(wide, value)| {
                    *wide = i32::from(u16::from_le_bytes(*value)).to_le_bytes();
                }),
                (_, true) => wide.zip(values).for_each(|(wide, value)| *wide = i32::from(*value as i8).to_le_bytes()),
                (_, false) => wide.zip(values).for_each(|(wide, value)| *wide = i32::from(*value).to_le_bytes()),
            }
            data
        }
        Held::Text => {
            let mut data = Vec::new();
            values.chunks_exact(size).for_each(|value| plain_value(value, held, text, &mut data));
            data
        }
    };
    Encoded { dictionary: None, data, encoding: Encoding::PLAIN }
}

fn plain_value(value: &[u8], held: Held, text: &dyn Fn(&[u8]) -> String, out: &mut Vec<u8>) {
    match held {
        Held::Bit | Held::Same(_) => out.extend_from_slice(value),
        Held::Word { signed, .. } => {
            let wide: i32 = match (value, signed) {
                (&[low], true) => i32::from(low as i8),
                (&[low], false) => i32::from(low),
                (&[low, high, ..], true) => i32::from(i16::from_le_bytes([low, high])),
                (&[low, high, ..], false) => i32::from(u16::from_le_bytes([low, high])),
                ([], _) => 0,
            };
            out.extend_from_slice(&wide.to_le_bytes());
        }
        Held::Text => {
            let text = text(value);
            out.extend_from_slice(&(text.len() as u32).to_le_bytes());
            out.extend_from_slice(text.as_bytes());
        }
    }
}

/// 64-bit numbers of which each is `step` more than the one before: `DELTA_BINARY_PACKED`, in which
/// blocks of equal differences need no bits for their values.
pub(super) fn arithmetic(first: u64, step: u64, rows: usize) -> Encoded {
    const BLOCK: usize = 128;
    const MINIBLOCKS: usize = 4;
    let mut data = Vec::new();
    varint(BLOCK as u64, &mut data);
    varint(MINIBLOCKS as u64, &mut data);
    varint(rows as u64, &mut data);
    varint(zigzag(first as i64), &mut data);
    for _ in 0..(rows - 1).div_ceil(BLOCK) {
        varint(zigzag(step as i64), &mut data);
        data.extend_from_slice(&[0; MINIBLOCKS]);
    }
    Encoded { dictionary: None, data, encoding: Encoding::DELTA_BINARY_PACKED }
}

fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// LEB128, low bits first.
fn varint(mut value: u64, out: &mut Vec<u8>) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Runs as anybody would find them.
    fn one_by_one(values: &[u8], size: usize) -> Vec<(&[u8], usize)> {
        let mut runs: Vec<(&[u8], usize)> = Vec::new();
        for value in values.chunks_exact(size) {
            match runs.last_mut() {
                Some((last, count)) if *last == value => *count += 1,
                _ => runs.push((value, 1)),
            }
        }
        runs
    }

    proptest! {
        #[test]
        fn runs_are_found_whole_or_not_at_all(
            size in prop::sample::select(vec![1_usize, 2, 4, 8, 11]),
            lengths in prop::collection::vec((0_u8..3, 1_usize..100), 1..12),
            runs_max in 0_usize..12,
        ) {
            let values: Vec<u8> = lengths.iter().flat_map(|(value, count)| vec![*value; size * count]).collect();
            let expected = one_by_one(&values, size);
            let found = runs(&values, size, runs_max);
            prop_assert_eq!(found, (expected.len() <= runs_max + 1).then_some(expected));
        }

        #[test]
        fn wide_values_are_those_that_went_in(values in prop::collection::vec(any::<i16>(), 1..50)) {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            for (signed, size) in [(true, 2), (false, 2), (true, 1), (false, 1)] {
                let held = Held::Word { bytes: size, signed };
                let text = |_: &[u8]| String::new();
                let mut expected = Vec::new();
                bytes.chunks_exact(size).for_each(|value| plain_value(value, held, &text, &mut expected));
                prop_assert_eq!(plain(&bytes, size, held, &text).data, expected);
            }
        }
    }

    #[test]
    fn a_dictionary_has_each_value_once() {
        let values = [[3_u8, 0], [0, 1], [3, 0], [1, 0]].concat();
        let runs = one_by_one(&values, 2);
        let distinct = dictionary(&runs).expect("three are few");
        assert_eq!(distinct, [[1_u8, 0], [3, 0], [0, 1]]);
        let encoded = dictionary_runs(&runs, &distinct, Held::Word { bytes: 2, signed: true }, &|_| String::new());
        assert_eq!(encoded.dictionary, Some((vec![1, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 0], 3)));
        assert_eq!(encoded.data, [2, 2, 1, 2, 2, 2, 1, 2, 0], "two bits an index, then runs of one");
    }
}
