//! Values to pages.
//!
//! | values | encoding |
//! |---|---|
//! | that hardly ever change | `RLE_DICTIONARY`: each value once, then runs; `RLE` for BOOL |
//! | that change | `PLAIN`, compressed by snappy if that pays |
//! | that grow by the same each step | `DELTA_BINARY_PACKED` without a bit for each |

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
            None => plain(&expand(&runs), size, held, text),
        },
        (None, Values::All(values) | Values::One(values), _) => plain(values, size, held, text),
    }
}

/// The runs of equal values, unless there are more than `runs_max`.
fn runs(values: &[u8], size: usize, runs_max: usize) -> Option<Vec<(&[u8], usize)>> {
    let mut runs: Vec<(&[u8], usize)> = Vec::new();
    for value in values.chunks_exact(size) {
        if let Some((last, count)) = runs.last_mut()
            && *last == value
        {
            *count += 1;
        } else if runs.len() <= runs_max {
            runs.push((value, 1));
        } else {
            return None;
        }
    }
    Some(runs)
}

fn expand(runs: &[(&[u8], usize)]) -> Vec<u8> {
    runs.iter().flat_map(|(value, count)| value.repeat(*count)).collect()
}

/// The values of all runs in their order, each once; nothing if there are too many.
fn dictionary<'v>(runs: &[(&'v [u8], usize)]) -> Option<Vec<&'v [u8]>> {
    let mut distinct: Vec<&[u8]> = runs.iter().map(|(value, _)| *value).collect();
    distinct.sort_unstable();
    distinct.dedup();
    (distinct.len() <= DICTIONARY_MAX).then_some(distinct)
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
        data.push(distinct.binary_search(value).unwrap_or(0) as u8);
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
        Held::Word { .. } | Held::Text => {
            let mut data = Vec::with_capacity(values.len() / size * 4);
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
