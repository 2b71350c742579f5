//! Steps that are written before their block or their part is full, so that a kill leaves them.

use std::io;

use onescan_server::digest::TrajectoryDigest;

use super::block::Block;

/// Bytes of whole blocks that are kept for this at most. A run that has more of them within a second fills its part soon.
const BYTES_MAX: usize = 32 << 20;

/// What of the part in progress is not on the disk yet.
#[derive(Default)]
pub(super) struct Early {
    /// Rows of whole blocks.
    pending: Vec<Block>,
    /// Rows of the block that is growing which have been written, and the digest after them.
    written: Option<(usize, TrajectoryDigest)>,
    /// Too much has come: the rest of the part is written when it is full.
    given_up: bool,
}

impl Early {
    /// A block has grown full and was taken by all sinks.
    pub(super) fn full(&mut self, block: &Block) {
        let written = self.written.take().map_or(0, |(rows, _)| rows);
        if block.ends_part {
            *self = Self::default();
            return;
        }
        let held: usize = self.pending.iter().map(|pending| pending.images.len()).sum();
        if self.given_up || held + block.images.len() > BYTES_MAX {
            (self.given_up, self.pending) = (true, Vec::new());
        } else if let Some(rest) = block.rows_from(written) {
            self.pending.push(rest);
        }
    }

    /// Gives what has come to `write`. `digest` is that before the growing block, of whose first rows the session has taken
    /// in `known` already.
    pub(super) fn write(
        &mut self,
        growing: Option<Block>,
        (digest, known): (&TrajectoryDigest, usize),
        write: &mut dyn FnMut(&Block) -> io::Result<()>,
    ) -> io::Result<()> {
        if self.given_up {
            return Ok(());
        }
        std::mem::take(&mut self.pending).iter().try_for_each(&mut *write)?;
        let Some(mut rows) = growing else { return Ok(()) };
        let (before, mut digest) = self.written.take().unwrap_or_else(|| (0, digest.clone()));
        rows.digest(&mut digest, known.saturating_sub(before));
        write(&rows)?;
        self.written = Some((before + rows.rows(), digest));
        Ok(())
    }

    /// How many rows of the growing block are on the disk.
    pub(super) fn rows(&self) -> usize {
        self.written.as_ref().map_or(0, |(rows, _)| *rows)
    }
}
