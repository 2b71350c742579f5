//! BLAKE3 over a stream of bytes that can be saved and taken up again.
//!
//! The `blake3` crate's hasher cannot be saved. BLAKE3 is a tree, though: the stream is hashed in
//! subtrees of [`SUBTREE_BYTES`], of each of which only its chaining value is kept, and equal
//! neighbours are merged at once, as a binary counter carries. What is kept is a value for each one
//! in the count of subtrees, at most 48 for any stream that fits 64 bits, and the bytes of the last,
//! unfinished subtree. The result is the plain BLAKE3 hash of the stream (BLAKE3 paper, sec. 2.1 and
//! 5.1.2), which a test holds against the crate's own.
//!
//! Whole subtrees are hashed at once, so that the widest path of the processor is used. Hashing each
//! step alone costs nine times as much.

use blake3::hazmat::{ChainingValue, HasherExt, Mode, merge_subtrees_non_root, merge_subtrees_root};
use serde::{Deserialize, Serialize};

/// Bytes that are hashed at once: a power of two of chunks, so that each piece is a subtree.
const SUBTREE_BYTES: usize = 64 * blake3::CHUNK_LEN;
const _: () = assert!((SUBTREE_BYTES / blake3::CHUNK_LEN).is_power_of_two(), "a subtree of BLAKE3 is a whole one");

/// A BLAKE3 hash as its input grows.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Saved", into = "Saved")]
pub struct HashStream {
    /// Whole subtrees so far.
    subtrees: u64,
    /// Chaining values of merged subtrees, the largest and leftmost first: one for each bit that is
    /// set in `subtrees`.
    merged: Vec<ChainingValue>,
    /// The bytes after them, at most [`SUBTREE_BYTES`].
    pending: Vec<u8>,
    /// The hash of the first `settled` bytes of `pending`, for one who asks after every step.
    tail: blake3::Hasher,
    settled: usize,
}

/// The part of a stream that is saved; the rest follows from it.
#[derive(Serialize, Deserialize)]
struct Saved {
    subtrees: u64,
    merged: Vec<ChainingValue>,
    pending: Vec<u8>,
}

impl HashStream {
    /// An empty stream.
    pub fn new() -> Self {
        Self {
            subtrees: 0,
            merged: Vec::new(),
            pending: Vec::with_capacity(SUBTREE_BYTES),
            tail: blake3::Hasher::new(),
            settled: 0,
        }
    }

    /// Takes in the next bytes.
    pub fn take(&mut self, mut bytes: &[u8]) {
        loop {
            let room = SUBTREE_BYTES - self.pending.len();
            if bytes.len() <= room {
                self.pending.extend_from_slice(bytes);
                return;
            }
            // A full subtree is closed only when more follows: the last one of a stream is part of
            // the root, which is hashed in another way.
            let (now, later) = bytes.split_at(room);
            if self.pending.is_empty() {
                // A whole subtree is hashed where it lies: a large image is not copied.
                self.tail.update(now);
            } else {
                self.pending.extend_from_slice(now);
                self.settle();
            }
            self.close_subtree();
            bytes = later;
        }
    }

    /// Closes a full subtree, whose bytes have all been hashed.
    #[cold]
    fn close_subtree(&mut self) {
        debug_assert_eq!(self.tail.count(), SUBTREE_BYTES as u64, "only a full subtree is closed");
        let mut right = self.tail.finalize_non_root();
        self.subtrees += 1;
        // Each trailing zero of the new count is a carry: two subtrees of one size become one.
        for _ in 0..self.subtrees.trailing_zeros() {
            if let Some(left) = self.merged.pop() {
                right = merge_subtrees_non_root(&left, &right, Mode::Hash);
            }
        }
        self.merged.push(right);
        debug_assert_eq!(
            self.merged.len(),
            self.subtrees.count_ones() as usize,
            "one chaining value is kept per bit that is set in the count"
        );
        self.pending.clear();
        self.tail = tail_at(self.subtrees);
        self.settled = 0;
    }

    /// Hashes what is pending, so that the next [`value`](Self::value) has less to do.
    pub fn settle(&mut self) {
        self.tail.update(&self.pending[self.settled..]);
        self.settled = self.pending.len();
    }

    /// The hash of all bytes so far.
    #[must_use]
    pub fn value(&self) -> [u8; 32] {
        let mut tail = self.tail.clone();
        tail.update(&self.pending[self.settled..]);
        let Some((first, others)) = self.merged.split_first() else { return *tail.finalize().as_bytes() };
        // With a subtree before it the tail is never empty: see `take`.
        debug_assert!(!self.pending.is_empty(), "bytes follow a closed subtree");
        let tail = tail.finalize_non_root();
        let right = others.iter().rev().fold(tail, |right, left| merge_subtrees_non_root(left, &right, Mode::Hash));
        *merge_subtrees_root(first, &right, Mode::Hash).as_bytes()
    }
}

impl Default for HashStream {
    fn default() -> Self {
        Self::new()
    }
}

impl PartialEq for HashStream {
    fn eq(&self, other: &Self) -> bool {
        // The tail follows from `pending`, however much of it has been hashed.
        (self.subtrees, &self.merged, &self.pending) == (other.subtrees, &other.merged, &other.pending)
    }
}

impl Eq for HashStream {}

/// The hasher of the subtree behind `subtrees` others.
fn tail_at(subtrees: u64) -> blake3::Hasher {
    let mut tail = blake3::Hasher::new();
    tail.set_input_offset(subtrees * SUBTREE_BYTES as u64);
    tail
}

impl From<HashStream> for Saved {
    fn from(HashStream { subtrees, merged, pending, .. }: HashStream) -> Self {
        Self { subtrees, merged, pending }
    }
}

impl TryFrom<Saved> for HashStream {
    type Error = &'static str;

    fn try_from(Saved { subtrees, merged, pending }: Saved) -> Result<Self, Self::Error> {
        // What `take` could not have left would make `value` panic in the crate.
        let whole = merged.len() == subtrees.count_ones() as usize
            && pending.len() <= SUBTREE_BYTES
            && (subtrees == 0 || !pending.is_empty())
            && subtrees.checked_mul(SUBTREE_BYTES as u64).is_some();
        if !whole {
            return Err("not the state of a hash: its parts do not fit each other");
        }
        let mut room = Vec::with_capacity(SUBTREE_BYTES);
        room.extend_from_slice(&pending);
        Ok(Self { subtrees, merged, pending: room, tail: tail_at(subtrees), settled: 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(len: usize) -> Vec<u8> {
        (0..len).map(|index| (index * 31 % 251) as u8).collect()
    }

    #[test]
    fn it_is_the_plain_hash_at_every_edge() {
        for whole in 0..6 {
            for more in [0, 1, 1023, 1024, 1025, SUBTREE_BYTES - 1] {
                let bytes = text(whole * SUBTREE_BYTES + more);
                // Whole subtrees are hashed where they lie, also behind a part of one.
                for first in [0, 77, SUBTREE_BYTES] {
                    let (first, rest) = bytes.split_at(first.min(bytes.len()));
                    let mut stream = HashStream::new();
                    stream.take(first);
                    stream.take(rest);
                    assert_eq!(stream.value(), *blake3::hash(&bytes).as_bytes(), "{whole} subtrees and {more} bytes");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn pieces_saves_and_looks_change_nothing(
            pieces in proptest::collection::vec((0..30_000_usize, 0..3_u8), 1..24),
        ) {
            let bytes = text(pieces.iter().map(|(len, _)| len).sum());
            let mut stream = HashStream::new();
            let mut rest = &bytes[..];
            for (len, action) in pieces {
                let (piece, later) = rest.split_at(len);
                stream.take(piece);
                rest = later;
                match action {
                    0 => stream.settle(),
                    1 => stream = postcard::from_bytes(&postcard::to_stdvec(&stream).unwrap()).unwrap(),
                    _ => prop_assert_eq!(stream.value(), *blake3::hash(&bytes[..bytes.len() - rest.len()]).as_bytes()),
                }
            }
            prop_assert_eq!(stream.value(), *blake3::hash(&bytes).as_bytes());
        }

        #[test]
        fn a_damaged_state_is_refused_or_harmless(mut saved: Vec<u8>, at: usize, by: u8) {
            let mut stream = HashStream::new();
            stream.take(&text(200_000));
            let good = postcard::to_stdvec(&stream).unwrap();
            let at = at % good.len();
            saved.clear();
            saved.extend_from_slice(&good);
            saved[at] ^= by;
            if let Ok(stream) = postcard::from_bytes::<HashStream>(&saved) {
                let _ = stream.value();
            }
        }
    }
}
