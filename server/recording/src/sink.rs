//! The thread that encodes, and what it writes to. In a simulation the session's own thread encodes.
//!
//! Blocks go to the thread and come back empty. There are [`BLOCKS`] of them: when all are on their way the
//! session waits, so nothing is lost and memory has a bound.

use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use onescan_base::disk::Disk;
use onescan_base::threads;
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::RecordError;

use super::block::Block;
use super::column::Column;
use super::early::Early;
use super::flush_policy::{FlushPolicy, FlushTimer};

/// One that fills, one that waits, one that is encoded.
const BLOCKS: usize = 3;

/// A form of trajectory that is written block by block.
pub(crate) trait Sink: Send {
    /// Takes the steps of a block; whole blocks are what a kill leaves.
    fn block(&mut self, block: &Block) -> io::Result<()>;
    /// Takes steps before their block does, or before it is complete on the disk, so that a kill leaves them, too. Their
    /// block has them once more. A form whose bytes would be others for it leaves them out.
    fn early(&mut self, _rows: &Block) -> io::Result<()> {
        Ok(())
    }
    /// Everything has come.
    fn end(&mut self) -> io::Result<()>;
}

/// What all forms of a recording are made of.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) columns: Arc<[Column]>,
    pub(super) folder: PathBuf,
    pub(super) disk: Arc<dyn Disk>,
}

/// What goes to the thread.
#[derive(Debug)]
enum Message {
    Block(Block),
    /// Write what the growing block has, and say when that is done.
    Write,
}

/// On which thread blocks are encoded: only on the session's own do all calls of the disk have one order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Where {
    InThread,
    Here,
}

/// What encodes the blocks of a session.
#[derive(Debug)]
pub(super) enum Encoder {
    Thread(EncodingThread),
    Here {
        encoding: Box<Encoding>,
        /// Why it has ended early, if it has.
        failed: Option<io::Error>,
    },
}

impl Encoder {
    /// Begins. `digest` is that of the first row, the step `first_step`, which the session has taken in already; `growing` is the
    /// block that the session fills.
    pub(super) fn start(
        encodes: Where,
        sinks: Vec<Box<dyn Sink>>,
        (first_step, digest): (u64, TrajectoryDigest),
        growing: Arc<Mutex<Block>>,
        flush_policy: FlushPolicy,
    ) -> io::Result<Self> {
        let (early, flush_timer) = (Early::default(), FlushTimer::new(flush_policy));
        let encoding = Encoding { sinks, digest, known: 1, next_step: first_step, growing, early, flush_timer };
        match encodes {
            Where::InThread => EncodingThread::start(encoding).map(Self::Thread),
            Where::Here => Ok(Self::Here { encoding: Box::new(encoding), failed: None }),
        }
    }

    /// Gives a block away and gets an empty one, waiting for it if need be; nothing if encoding has failed.
    pub(super) fn exchange(&mut self, block: Block) -> Option<Block> {
        match self {
            Self::Thread(thread) => thread.exchange(block),
            Self::Here { encoding, failed } => encoding.full(block).map_err(|error| *failed = Some(error)).ok(),
        }
    }

    /// Waits until what the growing block has is written; nothing if encoding has failed.
    pub(super) fn write(&mut self) -> Option<()> {
        match self {
            Self::Thread(thread) => thread.write(),
            Self::Here { encoding, failed } => encoding.write().map_err(|error| *failed = Some(error)).ok(),
        }
    }

    /// Waits until everything is written.
    pub(super) fn finish(self, last: Option<Block>) -> io::Result<()> {
        match self {
            Self::Thread(thread) => thread.finish(last),
            Self::Here { failed: Some(error), .. } => Err(error),
            Self::Here { mut encoding, failed: None } => {
                last.map_or(Ok(()), |block| encoding.full(block).map(drop))?;
                encoding.end()
            }
        }
    }
}

/// The thread, and the channels to and from it.
#[derive(Debug)]
pub(super) struct EncodingThread {
    to_encode: SyncSender<Message>,
    emptied: Receiver<Block>,
    written: Receiver<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl EncodingThread {
    fn start(mut encoding: Encoding) -> io::Result<Self> {
        let (to_encode, messages) = sync_channel(BLOCKS);
        let (back, emptied) = sync_channel::<Block>(BLOCKS);
        let (done, written) = sync_channel(1);
        // The one that is missing here is the session's, which grows.
        for _ in 1..BLOCKS {
            // The channel has room for all of them, and its receiver is here.
            back.send(Block::default()).map_err(io::Error::other)?;
        }
        let encode = move || {
            while let Ok(message) = encoding.flush_timer.next(&messages) {
                match message {
                    Some(Message::Block(block)) => {
                        let empty = encoding.full(block)?;
                        // A session that ends does not want it back; what it sent before is still encoded.
                        let _wanted = back.send(empty);
                        if encoding.flush_timer.is_due() {
                            encoding.write()?;
                        }
                    }
                    Some(Message::Write) => {
                        encoding.write()?;
                        // Who asked waits, or has ended.
                        let _wanted = done.send(());
                    }
                    None => encoding.write()?,
                }
            }
            encoding.end()
        };
        let thread = threads::start("recorder", encode)?;
        Ok(Self { to_encode, emptied, written, thread })
    }

    fn exchange(&self, block: Block) -> Option<Block> {
        self.to_encode.send(Message::Block(block)).ok()?;
        self.emptied.recv().ok()
    }

    fn write(&self) -> Option<()> {
        self.to_encode.send(Message::Write).ok()?;
        self.written.recv().ok()
    }

    fn finish(self, last: Option<Block>) -> io::Result<()> {
        // If it is not taken the thread has failed, which its own result reports below.
        let _taken = last.map_or(Ok(()), |block| self.to_encode.send(Message::Block(block)));
        // The thread ends when nobody can send any more.
        drop(self.to_encode);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the recorder's thread ended early")))
    }
}

/// What is done with the blocks.
pub(super) struct Encoding {
    sinks: Vec<Box<dyn Sink>>,
    /// The digest before the growing block.
    digest: TrajectoryDigest,
    /// Rows of that block that the digest has taken in.
    known: usize,
    /// The first step of that block.
    next_step: u64,
    growing: Arc<Mutex<Block>>,
    early: Early,
    flush_timer: FlushTimer,
}

impl Encoding {
    /// Takes a full block; gives it back empty.
    fn full(&mut self, mut block: Block) -> io::Result<Block> {
        block.digest(&mut self.digest, std::mem::take(&mut self.known));
        self.sinks.iter_mut().try_for_each(|sink| sink.block(&block))?;
        self.early.full(&block);
        self.next_step = block.first_step + block.rows() as u64;
        if block.ends_part {
            self.flush_timer.written();
        }
        block.clear();
        Ok(block)
    }

    /// Writes what has come of a block that is not full yet.
    fn write(&mut self) -> io::Result<()> {
        self.flush_timer.written();
        let growing = {
            let growing = self.growing.lock().unwrap_or_else(PoisonError::into_inner);
            // One that comes after blocks which are still on their way here would be written before them.
            growing
                .rows_from(self.early.rows())
                .filter(|rows| rows.first_step == self.next_step + self.early.rows() as u64)
        };
        let sinks = &mut self.sinks;
        let mut write = |rows: &Block| sinks.iter_mut().try_for_each(|sink| sink.early(rows));
        self.early.write(growing, (&self.digest, self.known), &mut write)
    }

    /// Everything has come.
    fn end(&mut self) -> io::Result<()> {
        self.sinks.iter_mut().try_for_each(|sink| sink.end())
    }
}

impl std::fmt::Debug for Encoding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Encoding").field("next_step", &self.next_step).finish_non_exhaustive()
    }
}

/// An error of the recording in `folder`.
pub(super) fn failed(folder: &std::path::Path) -> impl Fn(io::Error) -> RecordError {
    let path = folder.display().to_string();
    move |source| RecordError { path: path.clone(), source }
}
