//! A moment of the past again: from the nearest checkpoint, by an exact re-run of another session of the same scenario.
//!
//! One thread does it for all who look, in turn. Of what somebody asks for only the last counts; a re-run that is on its way
//! to an earlier moment goes on to a later one.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use onescan_base::threads;
use onescan_server::checkpoint::Checkpoint;
use onescan_server::client::Parts;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::published::{SessionView, Wants};
use onescan_server::signal::SignalId;
use onescan_server::time::VirtualTime;
use tokio::sync::{oneshot, watch};

use super::store::{Kept, Way};
use super::trace::{Points, Span, Tracing};

/// Forms another session of the scenario, about to begin. It has no end, and says in words why it cannot be.
pub(crate) type Form = Box<dyn Fn() -> Result<Lockstep, String> + Send>;

/// Steps that are re-run before it is looked whether something else is wanted.
const STRETCH_STEPS: u64 = 64;

/// What somebody who looks at the past sees.
#[derive(Clone, Debug, Default)]
pub(crate) enum Moment {
    #[default]
    None,
    /// The session at that time.
    Seen(Arc<SessionView>),
    Lost(String),
}

enum Wanted {
    /// To see a moment.
    Show(VirtualTime, watch::Sender<Moment>),
    /// What signals did in a span.
    Trace(Span, oneshot::Sender<Result<Vec<Points>, String>>),
    /// A checkpoint to go on from.
    Save(VirtualTime, oneshot::Sender<Result<Vec<u8>, String>>),
    /// Nothing any more: what was re-run is given away.
    Leave,
}

#[derive(Default)]
struct Queue {
    last: u64,
    /// By who wants it, and in turn.
    wanted: BTreeMap<u64, Wanted>,
    turn: u64,
    closed: bool,
}

#[derive(Default)]
struct RequestQueue {
    queue: Mutex<Queue>,
    arrived: Condvar,
}

impl RequestQueue {
    /// A thread that panicked under the lock has left whole values.
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn want(&self, who: u64, wanted: Wanted) {
        self.lock().wanted.insert(who, wanted);
        self.arrived.notify_all();
    }

    /// The next in turn; waits for one. Nothing once all is over.
    fn next(&self) -> Option<(u64, Wanted)> {
        let mut queue = self.lock();
        loop {
            if queue.closed {
                return None;
            }
            // From behind the one who was served last, so that nobody who asks time and again keeps the others waiting.
            let turn = queue.turn;
            let who = queue.wanted.range(turn..).next().or_else(|| queue.wanted.iter().next()).map(|(who, _)| *who);
            if let Some(who) = who {
                queue.turn = who + 1;
                return Some((who, queue.wanted.remove(&who)?));
            }
            queue = self.arrived.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Whether `who` wants something else by now, or all is over.
    fn is_outdated(&self, who: u64) -> bool {
        let queue = self.lock();
        queue.closed || queue.wanted.contains_key(&who)
    }
}

/// Shows moments of the past. It ends when it is dropped.
pub(crate) struct Rewinder {
    queue: Arc<RequestQueue>,
    kept: Kept,
    thread: Option<JoinHandle<()>>,
}

/// Somebody who looks at the past.
pub(crate) struct PastReader {
    queue: Arc<RequestQueue>,
    who: u64,
    sees: watch::Sender<Moment>,
    seen: watch::Receiver<Moment>,
}

impl Rewinder {
    /// Shows what is kept there, by sessions that `form` makes.
    ///
    /// # Errors
    /// There is no thread for it.
    pub(crate) fn new(kept: Kept, form: Form) -> std::io::Result<Self> {
        let queue = Arc::new(RequestQueue::default());
        let (asked, past) = (Arc::clone(&queue), kept.clone());
        let work = move || Worker { queue: asked, kept: past, form, runs: BTreeMap::new() }.work();
        let thread = threads::start("rewind", work)?;
        Ok(Self { queue, kept, thread: Some(thread) })
    }

    /// Where the past begins; nothing if there is none.
    pub(crate) fn first(&self) -> Option<VirtualTime> {
        self.kept.lock().first()
    }

    /// Somebody comes to look.
    pub(crate) fn enter(&self) -> PastReader {
        let who = {
            let mut queue = self.queue.lock();
            queue.last += 1;
            queue.last
        };
        let (sees, seen) = watch::channel(Moment::None);
        PastReader { queue: Arc::clone(&self.queue), who, sees, seen }
    }
}

impl Drop for Rewinder {
    fn drop(&mut self) {
        self.queue.lock().closed = true;
        self.queue.arrived.notify_all();
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("the thread that shows the past has panicked");
        }
    }
}

impl PastReader {
    /// Asks for a moment; what was asked for before counts no more.
    pub(crate) fn show(&self, t_v: VirtualTime) {
        self.queue.want(self.who, Wanted::Show(t_v, self.sees.clone()));
    }

    /// Looks no more.
    pub(crate) fn leave(&mut self) {
        self.queue.want(self.who, Wanted::Leave);
        self.seen.mark_unchanged();
    }

    /// A checkpoint of a moment. Looking goes on.
    pub(crate) fn save(&self, t_v: VirtualTime) -> oneshot::Receiver<Result<Vec<u8>, String>> {
        // A number of its own: under the reader's it would replace the moment that the reader waits for.
        let (reply, answer) = oneshot::channel();
        let who = {
            let mut queue = self.queue.lock();
            queue.last += 1;
            queue.last
        };
        self.queue.want(who, Wanted::Save(t_v, reply));
        answer
    }

    /// What signals did in a span. What was asked for before counts no more.
    pub(crate) fn trace(&self, span: Span) -> oneshot::Receiver<Result<Vec<Points>, String>> {
        let (reply, answer) = oneshot::channel();
        self.queue.want(self.who, Wanted::Trace(span, reply));
        answer
    }

    /// The next moment that is seen.
    pub(crate) async fn next(&mut self) -> Moment {
        match self.seen.changed().await {
            Ok(()) => self.seen.borrow_and_update().clone(),
            // its own sender is here
            Err(_) => Moment::None,
        }
    }
}

impl Drop for PastReader {
    fn drop(&mut self) {
        self.queue.want(self.who, Wanted::Leave);
    }
}

/// A session that is re-run.
struct Run {
    life: u64,
    lockstep: Lockstep,
    _wants: Wants,
}

struct Worker {
    queue: Arc<RequestQueue>,
    kept: Kept,
    form: Form,
    /// By who looks: where the last re-run has come to.
    runs: BTreeMap<u64, Run>,
}

impl Worker {
    fn work(mut self) {
        while let Some((who, wanted)) = self.queue.next() {
            match wanted {
                Wanted::Show(t_v, sees) => {
                    let moment = match self.view(who, t_v) {
                        Ok(Some(view)) => Moment::Seen(view),
                        Ok(None) => continue,
                        Err(why) => Moment::Lost(why),
                    };
                    sees.send_replace(moment);
                }
                Wanted::Trace(span, reply) => {
                    let traced = self.trace(who, &span);
                    if reply.send(traced).is_err() {
                        tracing::debug!("somebody left before it got the part of the past that it wanted");
                    }
                }
                Wanted::Save(t_v, reply) => {
                    let saved = self.checkpoint(who, t_v);
                    self.runs.remove(&who);
                    if reply.send(saved).is_err() {
                        tracing::debug!("somebody left before it got the checkpoint that it wanted");
                    }
                }
                Wanted::Leave => drop(self.runs.remove(&who)),
            }
        }
    }

    /// The session at `t_v`; nothing if something else is wanted meanwhile.
    fn view(&mut self, who: u64, t_v: VirtualTime) -> Result<Option<Arc<SessionView>>, String> {
        let (queue, run) = (Arc::clone(&self.queue), self.near(who, t_v, t_v)?);
        let published = run.lockstep.published();
        let step = run.lockstep.session().step();
        // the checkpoint may be of this very moment
        published.ask();
        if !run.go_to(t_v.saturating_sub(step), || queue.is_outdated(who))? {
            return Ok(None);
        }
        if run.lockstep.session().t_v() < t_v {
            published.ask();
            run.go_to(t_v, || false)?;
        }
        Ok(Some(published.latest()))
    }

    fn checkpoint(&mut self, who: u64, t_v: VirtualTime) -> Result<Vec<u8>, String> {
        let queue = Arc::clone(&self.queue);
        let run = self.near(who, t_v, t_v)?;
        if !run.go_to(t_v, || queue.lock().closed)? {
            return Err("the session is over".to_owned());
        }
        run.lockstep.checkpoint().and_then(|checkpoint| checkpoint.to_bytes()).map_err(|error| error.to_string())
    }

    /// What signals did in a span, at each of its steps.
    fn trace(&mut self, who: u64, span: &Span) -> Result<Vec<Points>, String> {
        let queue = Arc::clone(&self.queue);
        let outdated = || "something else is wanted".to_owned();
        let later = |t_v: VirtualTime| t_v.checked_add(span.step).unwrap_or(VirtualTime::MAX);
        // The span before may have ended where this one begins.
        let run = self.near(who, span.from, later(span.from))?;
        if !run.go_to(span.from, || queue.is_outdated(who))? {
            return Err(outdated());
        }
        let mut tracing = Tracing::new(span);
        loop {
            let session = run.lockstep.session();
            let (layout, t_v) = (session.layout(), session.t_v());
            let number = |signal: &SignalId| layout.ty(*signal).as_f64(layout.bytes(*signal, session.image()));
            tracing.take(t_v, span.signals.iter().map(|signal| number(signal).unwrap_or(f64::NAN)));
            if t_v >= span.until {
                return Ok(tracing.finish());
            }
            if run.lockstep.run_to(later(t_v)).map_err(|error| error.to_string())? == Reached::End {
                return Ok(tracing.finish());
            }
            if queue.is_outdated(who) {
                return Err(outdated());
            }
        }
    }

    /// A session at or before `t_v`, and before `bound`, from where it is not far: that of the last look, or one from a checkpoint.
    fn near(&mut self, who: u64, t_v: VirtualTime, bound: VirtualTime) -> Result<&mut Run, String> {
        let gone = || format!("{t_v} is not kept: it lies before the past that is");
        let way = self.kept.lock().way_to(t_v).ok_or_else(gone)?;
        let goes_on = |run: &Run| {
            let at = run.lockstep.session().t_v();
            // what is shown is what was published last, so a moment is not shown twice by going nowhere
            run.life == way.life && way.from.t_v <= at && at < bound && run.lockstep.session().end().is_none()
        };
        if !self.runs.get(&who).is_some_and(goes_on) {
            // the memory of the one before is given back first
            self.runs.remove(&who);
            let run = self.begin(&way)?;
            self.runs.insert(who, run);
        }
        let run = self.runs.get_mut(&who).ok_or_else(gone)?;
        let steps = run.lockstep.session().cycle().steps();
        let inputs = self.kept.lock().inputs_from(steps);
        run.lockstep.replay(inputs);
        Ok(run)
    }

    fn begin(&self, way: &Way) -> Result<Run, String> {
        let mut lockstep = (self.form)()?;
        if let Some(bytes) = &way.from.checkpoint {
            let resumed = Checkpoint::from_bytes(bytes).and_then(|checkpoint| lockstep.resume(&checkpoint));
            resumed.map_err(|error| error.to_string())?;
        }
        debug_assert!(way.from.checkpoint.is_none() || lockstep.session().cycle().steps() == way.from.steps);
        // Few views are made here, and each is looked at for all there is.
        let wants = lockstep.published().want(Parts::ALL);
        Ok(Run { life: way.life, lockstep, _wants: wants })
    }
}

impl Run {
    /// Runs on to `t_v`, or to the end; false if that is not wanted any more.
    fn go_to(&mut self, t_v: VirtualTime, is_outdated: impl Fn() -> bool) -> Result<bool, String> {
        let stretch = self.lockstep.session().step().times(STRETCH_STEPS);
        loop {
            let at = self.lockstep.session().t_v();
            let next = stretch.and_then(|stretch| at.checked_add(stretch)).unwrap_or(t_v).min(t_v);
            // also one that was just resumed, and goes nowhere, shows where it is
            let reached = self.lockstep.run_to(next).map_err(|error| error.to_string())?;
            if reached == Reached::End || self.lockstep.session().t_v() >= t_v {
                return Ok(true);
            }
            if is_outdated() {
                return Ok(false);
            }
        }
    }
}
