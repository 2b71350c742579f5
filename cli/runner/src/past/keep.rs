//! A running session leaves its past: a checkpoint now and then, and what operators do.
//!
//! How far apart the checkpoints are depends on what one costs, so that all of them together take a hundredth of the
//! session's time. What a session computes does not depend on when it is saved. What of it becomes bytes does so on a thread
//! of its own; a checkpoint that comes while that is busy is dropped.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use onescan_base::threads;
use onescan_server::checkpoint::{Checkpoint, CheckpointError};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::OperatorInput;
use onescan_server::session::Session;
use onescan_server::time::{StepCount, VirtualTime};

use super::store::{Kept, Mark};

/// A hundredth of the session's time is spent on checkpoints, at most; they become bytes in about as much of another core's.
const SHARE: u32 = 100;
/// Steps between two checkpoints, at least: so many are re-run sooner than an eye sees it.
const STEPS_MIN: u64 = 50;
/// Steps between two checkpoints, at most, before any has to go.
const STEPS_MAX: u64 = 5_000;

/// Keeps the past of one session.
pub(crate) struct Keeper {
    kept: Kept,
    life: u64,
    sender: Option<SyncSender<(u64, Checkpoint)>>,
    thread: Option<JoinHandle<()>>,
    /// When the next checkpoint is due.
    next: VirtualTime,
}

impl Keeper {
    /// Keeps the past there.
    ///
    /// # Errors
    /// There is no thread for it.
    pub(crate) fn new(kept: Kept) -> std::io::Result<Self> {
        let (sender, receiver) = sync_channel(1);
        let writing = kept.clone();
        let thread = threads::start("past", move || write(&writing, &receiver))?;
        Ok(Self { kept, life: 0, sender: Some(sender), thread: Some(thread), next: VirtualTime::ZERO })
    }

    /// Who notes what operators do. It begins the past of the session whenever that begins.
    pub(crate) fn observer(&self) -> Box<dyn Observer> {
        Box::new(Notes { kept: self.kept.clone(), life: None })
    }

    /// Runs the session to the first boundary at or after `t_v`, and keeps checkpoints on the way.
    ///
    /// # Errors
    /// A recording cannot be written.
    pub(crate) fn run_to(&mut self, lockstep: &mut Lockstep, t_v: VirtualTime) -> Result<Reached, RecordError> {
        loop {
            let (began, before) = (Instant::now(), lockstep.session().cycle().steps());
            if lockstep.run_to_or_reset(self.next.min(t_v))? == Reached::End {
                return Ok(Reached::End);
            }
            let life = self.kept.lock().life();
            let is_new = life != self.life;
            self.life = life;
            let (steps, now) = (lockstep.session().cycle().steps(), lockstep.session().t_v());
            if is_new || now >= self.next {
                let apart = self.mark(lockstep, began.elapsed(), steps.0.saturating_sub(before.0));
                let span = lockstep.session().step().times(apart);
                self.next = span.and_then(|span| now.checked_add(span)).unwrap_or(VirtualTime::MAX);
            }
            if now >= t_v {
                return Ok(Reached::Boundary);
            }
        }
    }

    /// Takes a checkpoint; gives how many steps later the next one is due.
    fn mark(&mut self, lockstep: &mut Lockstep, ran: Duration, steps: u64) -> u64 {
        if lockstep.session().cycle().steps() == StepCount(0) {
            self.kept.lock().keep(self.life, Mark::beginning());
            return STEPS_MIN;
        }
        let began = Instant::now();
        match lockstep.checkpoint() {
            Ok(checkpoint) => {
                if let Some(sender) = &self.sender
                    && sender.try_send((self.life, checkpoint)).is_err()
                {
                    tracing::debug!("a moment of the past is not kept: the one before it is still being written");
                }
            }
            // a client that is lost fails the session by itself
            Err(error @ (CheckpointError::Client { .. } | CheckpointError::NotNow)) => {
                tracing::debug!(%error, "a moment of the past is not kept");
                return STEPS_MAX;
            }
            Err(error) => {
                tracing::warn!(%error, "a moment of the past is not kept");
                return STEPS_MAX;
            }
        }
        let each = ran.as_nanos() / u128::from(steps.max(1));
        let apart = began.elapsed().as_nanos() * u128::from(SHARE) / each.max(1);
        u64::try_from(apart).unwrap_or(STEPS_MAX).clamp(STEPS_MIN, STEPS_MAX)
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("the thread of the past has panicked");
        }
    }
}

/// Makes bytes of checkpoints.
fn write(kept: &Kept, receiver: &Receiver<(u64, Checkpoint)>) {
    for (life, checkpoint) in receiver {
        match checkpoint.to_bytes() {
            Ok(bytes) => {
                let (t_v, steps) = (checkpoint.t_v(), checkpoint.steps());
                kept.lock().keep(life, Mark { t_v, steps, checkpoint: Some(bytes.into()) });
            }
            Err(error) => tracing::warn!(%error, "a moment of the past is not kept"),
        }
    }
}

/// Notes what operators do, and when a session begins again.
struct Notes {
    kept: Kept,
    life: Option<u64>,
}

impl Observer for Notes {
    fn begin(&mut self, _session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        let life = self.life.map_or(1, |life| life + 1);
        self.life = Some(life);
        self.kept.lock().begin(life);
        Ok(())
    }

    fn step(&mut self, _session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        Ok(())
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        self.kept.lock().note(input);
        Ok(())
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
