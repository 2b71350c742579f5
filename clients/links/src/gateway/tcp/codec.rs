//! Blocks in a stream of bytes: only their length separates them.
//!
//! There is no header and no check sum. Only what the layout calls reserve can show that a stream is cut in the wrong
//! place, so with `reserve_zero` every block is held against it, also those that newer ones replace.

use bytes::{Bytes, BytesMut};
use thiserror::Error;

use super::layout::{Layout, Stray};
use crate::gateway::fault::Partial;

/// What a stream shows when both sides do not cut it alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum StreamFault {
    /// The connection was closed in mid-block.
    #[error("closed after {0}: is the layout the same on both sides?")]
    Cut(Partial),
    /// There is something where the layout has nothing.
    #[error("{stray} of block {number}: the stream is cut in the wrong place, or the layouts differ")]
    Stray {
        /// Which block since the connection came about, from 1.
        number: u64,
        stray: Stray,
    },
}

/// Blocks of one layout, cut from a stream.
#[derive(Clone, Debug)]
pub struct BlockCodec {
    layout: Layout,
    buffer: BytesMut,
    /// Blocks since the connection came about.
    number: u64,
}

impl BlockCodec {
    /// Nothing has come yet.
    pub fn new(layout: &Layout) -> Self {
        Self { layout: layout.clone(), buffer: BytesMut::new(), number: 0 }
    }

    /// A new connection: nothing of the one before counts.
    pub fn clear(&mut self) {
        self.buffer.clear();
        self.number = 0;
    }

    /// These bytes have come.
    pub fn take(&mut self, bytes: &[u8]) {
        self.buffer.extend_from_slice(bytes);
    }

    /// The next whole block, in the order in which they come.
    ///
    /// # Errors
    /// Its reserve is not 0, where that is asked for.
    pub fn next_block(&mut self) -> Result<Option<Bytes>, StreamFault> {
        let whole = self.whole();
        if self.buffer.len() < whole {
            self.buffer.reserve(whole - self.buffer.len());
            return Ok(None);
        }
        let block = self.buffer.split_to(whole).freeze();
        self.number += 1;
        match self.layout.stray(&block) {
            Some(stray) => Err(StreamFault::Stray { number: self.number, stray }),
            None => Ok(Some(block)),
        }
    }

    /// The newest whole block: those before it are past, and nobody asks what a PLC was.
    ///
    /// # Errors
    /// The reserve of one of them is not 0, where that is asked for.
    pub fn newest(&mut self) -> Result<Option<Bytes>, StreamFault> {
        let mut newest = None;
        while let Some(block) = self.next_block()? {
            newest = Some(block);
        }
        Ok(newest)
    }

    /// True if a whole block waits to be read.
    pub fn has_block(&self) -> bool {
        self.buffer.len() >= self.whole()
    }

    /// The block that has begun and is not whole, if there is one.
    pub fn partial(&self) -> Option<Partial> {
        let (got, whole) = (self.buffer.len(), self.whole());
        (got % whole != 0).then_some(Partial { got: got % whole, whole })
    }

    /// The stream has ended.
    ///
    /// # Errors
    /// In mid-block.
    pub fn end(&self) -> Result<(), StreamFault> {
        self.partial().map_or(Ok(()), |partial| Err(StreamFault::Cut(partial)))
    }

    /// A block without fields is one byte, so that there is something to wait for.
    fn whole(&self) -> usize {
        self.layout.size().max(1)
    }
}

#[cfg(test)]
#[path = "codec_tests.rs"]
mod tests;
