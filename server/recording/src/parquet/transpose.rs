//! Rows to columns: the values of one signal over the steps of a block.
//!
//! Most signals of a machine stand still over a block; what never changes is found for all of them
//! together and is not transposed at all. The rest is fetched in strips as wide as a cache line.

use super::super::block::Block;
use super::super::column::Column;

/// Bytes of an image that are fetched together.
const STRIP: usize = 64;

/// The values of a block's signals.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// For each byte of an image, the bits in which it ever differs from the first row.
    changed: Vec<u8>,
    /// A strip of all rows, and where in an image it begins and ends.
    strip: Vec<u8>,
    from: usize,
    to: usize,
    values: Vec<u8>,
}

/// The values of one signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Values<'v> {
    /// The same in all rows.
    One(&'v [u8]),
    /// One behind the other.
    All(&'v [u8]),
}

impl<'v> Values<'v> {
    /// The bytes of the values, or of the one.
    pub(super) fn bytes(self) -> &'v [u8] {
        let (Self::One(bytes) | Self::All(bytes)) = self;
        bytes
    }
}

impl Columns {
    /// Finds what changes in a block.
    pub(super) fn begin(&mut self, block: &Block) {
        self.changed.clear();
        self.changed.resize(block.width, 0);
        (self.from, self.to) = (0, 0);
        let first = block.image(0);
        for image in block.images.chunks_exact(block.width.max(1)).skip(1) {
            for ((changed, now), before) in self.changed.iter_mut().zip(image).zip(first) {
                *changed |= now ^ before;
            }
        }
    }

    /// The values of `column`. Columns that lie side by side are best asked for one after the other.
    pub(super) fn get<'v>(&'v mut self, block: &'v Block, column: &Column) -> Values<'v> {
        let (from, size) = (column.offset, column.ty.size());
        if self.changed[from..from + size].iter().all(|bits| *bits == 0) {
            return Values::One(column.bytes(block.image(0)));
        }
        if from < self.from || from + size > self.to {
            self.fetch(block, from, size);
        }
        let (width, at) = (self.to - self.from, from - self.from);
        self.values.clear();
        match size {
            1 => gather::<1>(&self.strip, width, at, &mut self.values),
            2 => gather::<2>(&self.strip, width, at, &mut self.values),
            4 => gather::<4>(&self.strip, width, at, &mut self.values),
            8 => gather::<8>(&self.strip, width, at, &mut self.values),
            _ => {
                for row in self.strip.chunks_exact(width) {
                    self.values.extend_from_slice(&row[at..at + size]);
                }
            }
        }
        Values::All(&self.values)
    }

    fn fetch(&mut self, block: &Block, from: usize, size: usize) {
        self.from = from;
        // A value may be longer than a strip, and is fetched whole.
        self.to = (from + size.max(STRIP)).min(block.width);
        self.strip.clear();
        for image in block.images.chunks_exact(block.width) {
            self.strip.extend_from_slice(&image[self.from..self.to]);
        }
    }
}

fn gather<const N: usize>(strip: &[u8], width: usize, at: usize, values: &mut Vec<u8>) {
    values.resize(strip.len() / width * N, 0);
    for (value, row) in values.as_chunks_mut::<N>().0.iter_mut().zip(strip.chunks_exact(width)) {
        value.copy_from_slice(&row[at..at + N]);
    }
}
