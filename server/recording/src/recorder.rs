//! The recorder: an observer that fills blocks and hands them on.
//!
//! A recording is a folder:
//!
//! | file | what is in it |
//! |---|---|
//! | `recording.json` | [`Header`]: what was run; written first |
//! | `scenario/` | the scenario's own files; written by who knows them |
//! | `trajectory/part-000001.parquet` … | step, `t_v`, digest and signals of every step |
//! | `trajectory.csv`, `trajectory.mcap` | the same for spreadsheets and viewers, if asked for |
//! | `events.jsonl` | [`Event`]s |
//!
//! Every part is complete when it takes its name; CSV and MCAP grow block by block. Whatever ends
//! the process leaves all steps up to the last of these.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_base::disk::{Disk, SystemDisk, write_whole};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Author, OperatorInput};
use onescan_server::session::Session;
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::time::{StepCount, VirtualTime};

use super::block::{Block, Schedule};
use super::column::{Column, columns};
use super::csv::CsvSink;
use super::event::{Event, EventKind, EventLog};
use super::flush_policy::FlushPolicy;
use super::header::{Header, Provenance};
use super::mcap::McapSink;
use super::parquet::ParquetSink;
use super::sink::{Encoder, Shape, Sink, Where, failed};

/// Name of the header's file.
pub const HEADER: &str = "recording.json";
/// Name of the file of events.
pub const EVENTS: &str = "events.jsonl";

/// What is recorded, and in which forms beside Parquet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Choice {
    /// The signals; all without patterns.
    pub signals: Vec<SignalPattern>,
    pub csv: bool,
    pub mcap: bool,
}

#[derive(Debug)]
pub struct Recorder {
    folder: PathBuf,
    provenance: Provenance,
    choice: Choice,
    encoder: Option<Encoder>,
    events: Option<EventLog>,
    /// The block that grows.
    block: Arc<Mutex<Block>>,
    flush_policy: FlushPolicy,
    disk: Arc<dyn Disk>,
    encodes: Where,
    schedule: Schedule,
    /// The last step that was seen.
    last: (StepCount, VirtualTime),
}

impl Recorder {
    /// A recorder that will write into `folder`, which exists.
    pub fn new(folder: &Path, provenance: Provenance, choice: Choice) -> Self {
        Self {
            folder: folder.to_owned(),
            provenance,
            choice,
            encoder: None,
            events: None,
            block: Arc::default(),
            flush_policy: FlushPolicy::default(),
            disk: Arc::new(SystemDisk),
            encodes: Where::InThread,
            schedule: Schedule::new(1, 1),
            last: (StepCount::default(), VirtualTime::ZERO),
        }
    }

    /// The same, with another flush policy in which steps reach the disk.
    #[must_use]
    pub fn writing(mut self, flush_policy: FlushPolicy) -> Self {
        self.flush_policy = flush_policy;
        self
    }

    /// The same, on another disk than the system's, and without a thread of its own: so each call of the disk has its place in
    /// one order.
    #[must_use]
    pub fn simulated(mut self, disk: Arc<dyn Disk>) -> Self {
        (self.disk, self.encodes) = (disk, Where::Here);
        self
    }

    fn start(&mut self, session: &Session, digest: &TrajectoryDigest) -> std::io::Result<()> {
        let columns = columns(session, &self.choice.signals).map_err(std::io::Error::other)?;
        let header = Header::new(session, &self.provenance, &columns);
        let mut text = serde_json::to_vec_pretty(&header)?;
        text.push(b'\n');
        write_whole(self.disk.as_ref(), &self.folder.join(HEADER), &text)?;
        self.schedule = Schedule::new(session.step().as_nanos(), session.image().len());
        let rows = self.schedule.block_rows() as usize;
        // One of its own for each start: the thread of the trajectory before may still look at its block.
        let mut block = Block::default();
        block.reserve(rows, session.image().len());
        self.block = Arc::new(Mutex::new(block));
        let first = (session.cycle().steps().0, digest.clone());
        let growing = Arc::clone(&self.block);
        self.encoder = Some(Encoder::start(self.encodes, self.sinks(columns)?, first, growing, self.flush_policy)?);
        Ok(())
    }

    fn sinks(&self, columns: Vec<Column>) -> std::io::Result<Vec<Box<dyn Sink>>> {
        let columns: Arc<[Column]> = columns.into();
        let shape = Shape { columns, folder: self.folder.clone(), disk: Arc::clone(&self.disk) };
        let mut sinks: Vec<Box<dyn Sink>> = vec![Box::new(ParquetSink::create(&shape)?)];
        if self.choice.csv {
            sinks.push(Box::new(CsvSink::create(&shape)?));
        }
        if self.choice.mcap {
            sinks.push(Box::new(McapSink::create(&shape)?));
        }
        Ok(sinks)
    }

    fn row(&mut self, session: &Session) -> Result<(), RecordError> {
        let Some(encoder) = &mut self.encoder else { return Ok(()) };
        self.last = (session.cycle().steps(), session.t_v());
        let (is_full, part) = self.schedule.row();
        // The lock is given back before the exchange, which may wait for the encoder: that takes the lock to write early.
        let full = {
            let mut block = locked(&self.block);
            block.push(session);
            block.ends_part = part;
            is_full.then(|| std::mem::take(&mut *block))
        };
        let mut done = match full {
            Some(full) => encoder.exchange(full).map(|empty| *locked(&self.block) = empty),
            None => Some(()),
        };
        if let FlushPolicy::Steps(steps) = self.flush_policy
            && self.last.0.0.is_multiple_of(steps.max(1))
        {
            done = done.and_then(|()| encoder.write());
        }
        if done.is_some() { Ok(()) } else { self.finish() }
    }

    /// Waits until all is encoded, and reports why that ended early if it did.
    fn finish(&mut self) -> Result<(), RecordError> {
        let block = std::mem::take(&mut *locked(&self.block));
        let last = (block.rows() > 0).then_some(block);
        match self.encoder.take() {
            Some(encoder) => encoder.finish(last).map_err(failed(&self.folder)),
            None => Ok(()),
        }
    }
}

/// A thread that ended in the middle has its own error, which is reported.
fn locked(block: &Mutex<Block>) -> MutexGuard<'_, Block> {
    block.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Observer for Recorder {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        // After a reset the trajectory restarts; the log of events goes on.
        self.finish()?;
        if self.events.is_none() {
            self.events = Some(EventLog::create(self.disk.as_ref(), &self.folder.join(EVENTS))?);
        }
        self.start(session, digest).map_err(failed(&self.folder))?;
        if let Some(events) = &mut self.events {
            events.push(&Event { step: session.cycle().steps(), t_v: session.t_v(), what: EventKind::Began })?;
        }
        self.row(session)
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.row(session)
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        let Some(events) = &mut self.events else { return Ok(()) };
        let operation = input.operation.clone();
        let what = match input.author {
            Author::Operator => EventKind::Operator { operation },
            Author::Timeline => EventKind::Timeline { operation },
        };
        events.push(&Event { step: input.step, t_v: input.t_v, what })
    }

    fn end(&mut self, session: &Session) -> Result<(), RecordError> {
        self.finish()?;
        match (&mut self.events, session.end()) {
            (Some(events), Some(end)) => events.end(end, self.last.0, self.last.1),
            _ => Ok(()),
        }
    }
}
