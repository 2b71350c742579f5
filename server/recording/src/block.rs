//! Blocks of steps: what goes from a session's thread to the one that encodes.
//!
//! A block takes the images as they are, one behind the other: on the session's path recording is a
//! copy. Blocks end by the count of steps alone, so that equal runs give equal files. The one that grows is shared with the
//! encoder's thread, which looks at it when it is time to write what there is.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use onescan_server::digest::TrajectoryDigest;
use onescan_server::session::Session;

/// Bytes of images in a block at most, but for a single image that is larger.
const BLOCK_BYTES: usize = 8 << 20;
/// Steps of a block at most.
const BLOCK_ROWS: u64 = 8_192;
/// Steps of a recording's first part: what a kill can cost at its beginning.
const FIRST_PART_ROWS: u64 = 64;
/// Steps of any part at most.
const PART_ROWS: u64 = 65_536;
/// Virtual time of a part at most, beyond the first: what a kill can cost of a run in real time.
const PART_NS: u64 = 10_000_000_000;

/// Consecutive steps of a session. A row is a step; the first of a recording is its initial image.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block {
    pub(crate) first_step: u64,
    pub(crate) t_v_ns: Vec<u64>,
    /// The digest after each row; on the way to the encoder they are not there yet.
    pub(crate) digests: Vec<[u8; 32]>,
    /// The images of all rows.
    pub(super) images: Vec<u8>,
    /// Bytes of an image.
    pub(super) width: usize,
    /// A part of the recording ends with it.
    pub(super) ends_part: bool,
}

impl Block {
    pub(crate) fn rows(&self) -> usize {
        self.t_v_ns.len()
    }

    pub(crate) fn image(&self, row: usize) -> &[u8] {
        &self.images[row * self.width..(row + 1) * self.width]
    }

    /// Takes the step that was just committed.
    pub(super) fn push(&mut self, session: &Session) {
        if self.t_v_ns.is_empty() {
            self.first_step = session.cycle().steps().0;
            self.width = session.image().len();
        }
        self.t_v_ns.push(session.t_v().as_nanos());
        self.images.extend_from_slice(session.image());
    }

    /// Computes the digests of all rows but the first `known`, of which `digest` is the last. A value
    /// for every step costs more than the step, so the encoder's thread computes it.
    pub(super) fn digest(&mut self, digest: &mut TrajectoryDigest, known: usize) {
        for row in 0..self.rows() {
            if row >= known {
                digest.step(&self.images[row * self.width..(row + 1) * self.width]);
            }
            self.digests.push(*digest.value_each_step().as_bytes());
        }
    }

    /// Room for so many rows of `width` bytes.
    pub(super) fn reserve(&mut self, rows: usize, width: usize) {
        self.t_v_ns.reserve(rows);
        self.digests.reserve(rows);
        self.images.reserve(rows.saturating_mul(width));
    }

    /// The rows that are within `steps`; nothing if none is.
    pub(crate) fn within(&self, steps: &RangeInclusive<u64>) -> Option<Cow<'_, Self>> {
        let last = self.first_step + self.rows().checked_sub(1)? as u64;
        let (from, to) = (self.first_step.max(*steps.start()), last.min(*steps.end()));
        if (from, to) == (self.first_step, last) {
            return Some(Cow::Borrowed(self));
        }
        let rows = (from.checked_sub(self.first_step)? as usize)..((to + 1).checked_sub(self.first_step)? as usize);
        (from <= to).then(|| {
            Cow::Owned(Self {
                first_step: from,
                t_v_ns: self.t_v_ns[rows.clone()].to_vec(),
                digests: self.digests[rows.clone()].to_vec(),
                images: self.images[rows.start * self.width..rows.end * self.width].to_vec(),
                width: self.width,
                ends_part: self.ends_part,
            })
        })
    }

    /// A copy of the rows from the one with this index on; nothing if there is none.
    pub(super) fn rows_from(&self, index: usize) -> Option<Self> {
        (index < self.rows()).then(|| Self {
            first_step: self.first_step + index as u64,
            t_v_ns: self.t_v_ns[index..].to_vec(),
            // The digest of a row follows the row, so the last ones may not be there yet.
            digests: self.digests.get(index..).unwrap_or_default().to_vec(),
            images: self.images[index * self.width..].to_vec(),
            width: self.width,
            ends_part: false,
        })
    }

    /// Empties it; what it holds of memory it keeps.
    pub(super) fn clear(&mut self) {
        self.t_v_ns.clear();
        self.digests.clear();
        self.images.clear();
        self.ends_part = false;
    }
}

/// Where blocks and parts end. Parts begin short and double, up to ten seconds of virtual time: a
/// kill costs at most half of a short run and ten seconds of a long one.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    block_rows: u64,
    part_rows: u64,
    part_rows_max: u64,
    in_part: u64,
    in_block: u64,
}

impl Schedule {
    pub(super) fn new(step_ns: u64, width: usize) -> Self {
        let fitting = (BLOCK_BYTES / width.max(1)) as u64;
        Self {
            block_rows: fitting.clamp(1, BLOCK_ROWS),
            part_rows: FIRST_PART_ROWS,
            part_rows_max: (PART_NS / step_ns.max(1)).clamp(FIRST_PART_ROWS, PART_ROWS),
            in_part: 0,
            in_block: 0,
        }
    }

    /// Counts a row; says if a block ends with it, and if a part does.
    pub(super) fn row(&mut self) -> (bool, bool) {
        self.in_part += 1;
        self.in_block += 1;
        let part = self.in_part == self.part_rows;
        // A part ends with a block, so that it is complete once its last block is written.
        let block = part || self.in_block == self.block_rows;
        if part {
            self.in_part = 0;
            self.part_rows = (self.part_rows * 2).min(self.part_rows_max);
        }
        if block {
            self.in_block = 0;
        }
        (block, part)
    }

    /// Rows that a block can have.
    pub(super) fn block_rows(&self) -> u64 {
        self.block_rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(step_ns: u64, width: usize, rows: u64) -> Vec<u64> {
        let mut schedule = Schedule::new(step_ns, width);
        let mut ends = Vec::new();
        let mut last = 0;
        for row in 1..=rows {
            if schedule.row().1 {
                ends.push(row - last);
                last = row;
            }
        }
        ends
    }

    #[test]
    fn parts_double_up_to_ten_seconds() {
        assert_eq!(parts(10_000_000, 100, 4_000), [64, 128, 256, 512, 1000, 1000, 1000]);
        assert_eq!(parts(1_000, 100, 200_000).last(), Some(&65_536));
        assert_eq!(parts(60_000_000_000, 100, 200), [64, 64, 64], "a long step does not make tiny parts");
    }

    #[test]
    fn wide_images_make_short_blocks() {
        let mut schedule = Schedule::new(1_000_000, 2 << 20);
        let blocks = (0..64).filter(|_| schedule.row().0).count();
        assert_eq!(blocks, 16);
        assert_eq!(Schedule::new(1, 64 << 20).block_rows(), 1);
    }
}
