//! The session as OPC UA clients see it: its steps as they are published, and the seats in which clients are
//! granted turns and answer.
//!
//! The seats are under one lock, held for moments; the view of a step is never changed. So what is read in one
//! request is of one moment, and no reader holds the session up.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use onescan_server::client::{JoinRequest, Parts};
use onescan_server::layout::ImageLayout;
use onescan_server::mailbox::Mailbox;
use onescan_server::plan::SessionPlan;
use onescan_server::published::{Follower, Published, SessionView};
use onescan_server::signal::PortLayout;
use onescan_server::state::ServerState;
use onescan_server::time::VirtualTime;
use thiserror::Error;
use tokio::sync::Notify;

use super::item::Item;
use super::seat::{Answer, Holder, Refusal, Seat};

/// Reports whether an OPC UA session has ended.
pub type IsGone = Arc<dyn Fn() -> bool + Send + Sync>;

/// Notifies subscribers that these items may have changed.
type Notifier = Box<dyn Fn(&[Item]) + Send + Sync>;

/// How often somebody who waits looks whether the other is still there.
const GLANCE: Duration = Duration::from_millis(50);

/// What is under the lock.
pub struct Shared {
    /// The state of the session between two published views, while a client holds a grant.
    pub phase: Option<ServerState>,
    /// Whether virtual time is held: true from the moment an operator asks for it.
    pub is_held: bool,
    /// How the session ended, in words.
    pub end: Option<String>,
    pub seats: Vec<Seat>,
    /// Whether the holder of each is no more.
    gone: Vec<Option<IsGone>>,
    /// Operators, and whether they are no more.
    operators: BTreeMap<Holder, IsGone>,
    watched: BTreeSet<Item>,
}

/// A session, its signals and its seats.
pub struct Board {
    plan: SessionPlan,
    layout: ImageLayout,
    mailbox: Mailbox,
    /// The session's steps, as its driver publishes them.
    published: Published,
    follower: Follower,
    shared: Mutex<Shared>,
    /// An answer has come, or somebody has started.
    answered: Condvar,
    /// A grant was given, or the session has ended.
    granted: Notify,
    notifier: OnceLock<Notifier>,
}

/// Why a client gives no answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SeatFault {
    #[error("{0}")]
    Reported(String),
    /// Its connection was closed or lost, or its OPC UA session has run out.
    #[error("its OPC UA connection or session has ended while grant {grant} waits for `Done`")]
    Gone { grant: u64 },
    #[error("grant {grant} is not done within {} s: its OPC UA client is dead, hangs or does not write `Done`", patience.as_secs_f64())]
    Late {
        grant: u64,
        /// How long it was waited for, wall clock.
        patience: Duration,
    },
}

impl Board {
    /// The board of a session of `plan`, whose operators' wishes go to `mailbox`, with a seat for each of `clients`.
    pub fn new(plan: SessionPlan, clients: &[JoinRequest], mailbox: Mailbox) -> Self {
        let layout = ImageLayout::new(plan.signals());
        let seat = |client: &JoinRequest| {
            let layout = |ports: &[_]| PortLayout::new(ports.to_vec());
            Seat::new(client.name.clone(), client.period, layout(&client.reads), layout(&client.writes))
        };
        let published = Published::new(layout.size());
        let shared = Shared {
            phase: None,
            is_held: false,
            end: None,
            seats: clients.iter().map(seat).collect(),
            gone: vec![None; clients.len()],
            operators: BTreeMap::new(),
            watched: BTreeSet::new(),
        };
        Self {
            plan,
            layout,
            mailbox,
            follower: published.follow(Parts::default()),
            published,
            shared: Mutex::new(shared),
            answered: Condvar::new(),
            granted: Notify::new(),
            notifier: OnceLock::new(),
        }
    }

    /// The session's plan.
    pub fn plan(&self) -> &SessionPlan {
        &self.plan
    }

    /// Where signals lie in the image.
    pub fn layout(&self) -> &ImageLayout {
        &self.layout
    }

    /// Where wishes of operators go.
    pub fn mailbox(&self) -> &Mailbox {
        &self.mailbox
    }

    /// Where the session's driver is to publish its views.
    pub fn published(&self) -> Published {
        self.published.clone()
    }

    /// The session as of its last step.
    pub fn view(&self) -> Arc<SessionView> {
        self.follower.latest()
    }

    /// A look at all that is under the lock. A thread that panicked under the lock has left whole values.
    pub fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Who is notified of items that change; set once, by the server.
    pub(super) fn set_notifier(&self, notifier: Notifier) {
        // A second server of one session there is not.
        let _ = self.notifier.set(notifier);
    }

    /// Somebody subscribes to an item.
    pub(super) fn watch(&self, item: Item) {
        self.lock().watched.insert(item);
    }

    /// Changes something and notifies subscribers of those `items` that they watch.
    fn publish(&self, items: &[Item], change: impl FnOnce(&mut Shared)) {
        let watched: Vec<Item> = {
            let mut shared = self.lock();
            change(&mut shared);
            if shared.watched.is_empty() {
                Vec::new()
            } else {
                items.iter().copied().filter(|item| shared.watched.contains(item)).collect()
            }
        };
        self.notify(&watched);
    }

    fn notify(&self, items: &[Item]) {
        if let (Some(notify), false) = (self.notifier.get(), items.is_empty()) {
            notify(items);
        }
    }

    /// A step is committed and its view published: notifies subscribers.
    pub fn step(&self) {
        self.announce(|shared| shared.phase = None);
    }

    /// An operator holds virtual time, or lets it run again.
    pub fn hold(&self, is_held: bool) {
        self.announce(|shared| shared.is_held = is_held);
    }

    /// Changes something and notifies subscribers of the session and of its signals.
    fn announce(&self, change: impl FnOnce(&mut Shared)) {
        let signals = self.layout.signals().map(|signal| Item::Signal(signal.index()));
        let items: Vec<Item> = if self.lock().watched.is_empty() {
            Vec::new()
        } else {
            super::item::session_items().into_iter().chain(signals).collect()
        };
        self.publish(&items, change);
    }

    /// Asks the client of `seat` for its initial state.
    pub fn begin(&self, seat: usize) {
        self.publish(&Item::grant(seat), |shared| {
            shared.phase = Some(ServerState::InitialWrite);
            shared.seats[seat].begin();
        });
        self.granted.notify_waiters();
    }

    /// Grants the client of `seat` a turn.
    pub fn grant(&self, seat: usize, t_v: VirtualTime, inputs: &[u8]) {
        self.publish(&Item::grant(seat), |shared| {
            shared.phase = Some(ServerState::PreWrite);
            shared.seats[seat].grant(t_v, inputs);
        });
        self.granted.notify_waiters();
    }

    /// Does something to a seat in the name of an OPC UA client.
    ///
    /// # Errors
    /// The seat refuses.
    pub fn attempt<T>(&self, seat: usize, what: impl FnOnce(&mut Seat) -> Result<T, Refusal>) -> Result<T, Refusal> {
        let done = what(&mut self.lock().seats[seat]);
        self.answered.notify_all();
        done
    }

    /// An OPC UA client is ready to start as the client of `seat`.
    ///
    /// # Errors
    /// Somebody else is in.
    pub fn start(&self, seat: usize, who: Holder, is_gone: IsGone) -> Result<(), Refusal> {
        let mut shared = self.lock();
        let before = shared.gone[seat].clone();
        shared.seats[seat].start(who, |_| before.as_ref().is_some_and(|is_gone| is_gone()))?;
        shared.gone[seat] = Some(is_gone);
        drop(shared);
        self.answered.notify_all();
        Ok(())
    }

    /// Somebody operates the session: it is notified of the end, too.
    pub(super) fn operated_by(&self, who: Holder, is_gone: IsGone) {
        self.lock().operators.insert(who, is_gone);
    }

    /// The names of clients that have not started.
    pub fn missing(&self) -> Vec<String> {
        let shared = self.lock();
        shared.seats.iter().filter(|seat| seat.holder().is_none()).map(|seat| format!("`{}`", seat.name)).collect()
    }

    /// Waits a moment for somebody to start.
    pub fn wait_for_start(&self, moment: Duration) {
        let shared = self.lock();
        let is_missing = |shared: &mut Shared| shared.seats.iter().any(|seat| seat.holder().is_none());
        let _unused = self.answered.wait_timeout_while(shared, moment, is_missing);
    }

    /// The answer to the grant of `seat`, for which is waited `patience` at most.
    ///
    /// # Errors
    /// There is none, and why.
    pub fn wait_for_answer(&self, seat: usize, patience: Duration) -> Result<Answer, SeatFault> {
        let deadline = Instant::now() + patience;
        let mut shared = self.lock();
        loop {
            if let Some(answer) = shared.seats[seat].take_answer() {
                return Ok(answer);
            }
            let grant = shared.seats[seat].grant_number();
            if let Some(why) = shared.seats[seat].fault() {
                return Err(SeatFault::Reported(why.to_owned()));
            }
            let gone = shared.gone[seat].clone();
            if gone.is_some_and(|is_gone| is_gone()) {
                return Err(SeatFault::Gone { grant });
            }
            let now = Instant::now();
            if now >= deadline {
                return Err(SeatFault::Late { grant, patience });
            }
            let waited = self.answered.wait_timeout(shared, GLANCE.min(deadline - now));
            shared = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Waits until `seat` has a grant to be answered, or the session is over; false if `patience` was not enough.
    pub async fn wait_for_grant(&self, seat: usize, patience: Duration) -> bool {
        let wait = async {
            loop {
                let granted = self.granted.notified();
                tokio::pin!(granted);
                // From here on a grant is not missed.
                granted.as_mut().enable();
                {
                    let shared = self.lock();
                    if shared.seats[seat].is_granted() || shared.seats[seat].is_ended() {
                        return;
                    }
                }
                granted.await;
            }
        };
        tokio::time::timeout(patience, wait).await.is_ok()
    }

    /// The session is over; `text` says how.
    pub fn end(&self, text: &str) {
        let seats = self.lock().seats.len();
        let mut items: Vec<Item> = super::item::session_items();
        items.extend((0..seats).flat_map(Item::grant));
        self.publish(&items, |shared| {
            shared.end.get_or_insert_with(|| text.to_owned());
            shared.seats.iter_mut().for_each(Seat::end);
        });
        self.granted.notify_waiters();
    }

    /// Waits until all who took part or operated have seen the end and closed their sessions, `patience` at most.
    pub fn close(&self, patience: Duration) {
        let deadline = Instant::now() + patience;
        let mut shared = self.lock();
        loop {
            let mut known = shared.gone.iter().flatten().chain(shared.operators.values());
            let waits = known.any(|is_gone| !is_gone());
            let now = Instant::now();
            if !waits || now >= deadline {
                return;
            }
            let waited = self.answered.wait_timeout(shared, GLANCE.min(deadline - now));
            shared = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}
