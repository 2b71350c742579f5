//! The thread that encodes, and what it writes to.
//!
//! Blocks go to it and come back empty. There are [`BLOCKS`] of them: when all are on their way the
//! session waits, so nothing is lost and memory has a bound.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::RecordError;

use super::block::Block;
use super::column::Column;

/// One that fills, one that waits, one that is encoded.
const BLOCKS: usize = 3;

/// A form of trajectory that is written block by block.
pub(crate) trait Sink: Send {
    /// Takes the steps of a block; whole blocks are what a kill leaves.
    fn block(&mut self, block: &Block) -> io::Result<()>;
    /// Everything has come.
    fn end(&mut self) -> io::Result<()>;
}

/// What all forms of a recording are made of.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) columns: Arc<[Column]>,
    pub(super) folder: PathBuf,
}

/// The thread, and the channels to and from it.
#[derive(Debug)]
pub(super) struct Encoder {
    filled: SyncSender<Block>,
    emptied: Receiver<Block>,
    thread: JoinHandle<io::Result<()>>,
}

impl Encoder {
    /// Starts the thread. `digest` is that of the first row, which the session has taken in already.
    pub(super) fn start(mut sinks: Vec<Box<dyn Sink>>, mut digest: TrajectoryDigest) -> io::Result<Self> {
        let (filled, to_encode) = sync_channel::<Block>(BLOCKS);
        let (back, emptied) = sync_channel::<Block>(BLOCKS);
        for _ in 1..BLOCKS {
            // The channel has room for all of them, and its receiver is here.
            back.send(Block::default()).map_err(io::Error::other)?;
        }
        let encode = move || {
            let mut known = 1;
            for mut block in &to_encode {
                block.digest(&mut digest, std::mem::take(&mut known));
                sinks.iter_mut().try_for_each(|sink| sink.block(&block))?;
                block.clear();
                // A session that ends does not want it back; what it sent before is still encoded.
                let _wanted = back.send(block);
            }
            sinks.iter_mut().try_for_each(|sink| sink.end())
        };
        let thread = std::thread::Builder::new().name("recorder".to_owned()).spawn(encode)?;
        Ok(Self { filled, emptied, thread })
    }

    /// Gives a block away and gets an empty one, waiting for it if need be; nothing if the thread
    /// has failed.
    pub(super) fn exchange(&self, block: Block) -> Option<Block> {
        self.filled.send(block).ok()?;
        self.emptied.recv().ok()
    }

    /// Waits until everything is written.
    pub(super) fn finish(self, last: Option<Block>) -> io::Result<()> {
        // If it is not taken the thread has failed, which its own result reports below.
        let _taken = last.map_or(Ok(()), |block| self.filled.send(block));
        drop(self.filled);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the recorder's thread ended early")))
    }
}

/// An error of the recording in `folder`.
pub(super) fn failed(folder: &std::path::Path) -> impl Fn(io::Error) -> RecordError {
    let path = folder.display().to_string();
    move |source| RecordError { path: path.clone(), source }
}
