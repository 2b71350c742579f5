//! Where wishes of operators wait for the next step boundary.
//!
//! The session's thread looks at one atomic a step; only when somebody left something does it lock.
//! What is asked never reaches a client in the middle of a step; with the step at which it is taken it
//! is data, which can be replayed.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::oneshot;

use crate::operation::{Control, Operation, OperationError};
use crate::signal::SignalName;
use crate::wire::message::Status;

/// What is asked of a session at a step boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// How it is, and what these signals are.
    Look(Vec<SignalName>),
    /// That something be done.
    Do(Operation),
}

impl From<Option<Operation>> for Wish {
    /// Nothing to be done asks how the session is.
    fn from(operation: Option<Operation>) -> Self {
        operation.map_or_else(|| Self::Look(Vec::new()), Self::Do)
    }
}

/// A wish, and who wants to hear how things are once it is taken.
#[derive(Debug)]
pub struct Request {
    pub wish: Wish,
    /// Where the status goes, or why what is asked cannot be done.
    pub reply: Option<oneshot::Sender<Result<Status, OperationError>>>,
}

#[derive(Debug, Default)]
struct Inner {
    waiting: AtomicBool,
    queue: Mutex<VecDeque<Request>>,
    arrived: Condvar,
}

/// A handle to a session's mailbox; clones share it.
#[derive(Clone, Debug, Default)]
pub struct Mailbox {
    inner: Arc<Inner>,
}

impl Mailbox {
    /// An empty mailbox.
    pub fn new() -> Self {
        Self::default()
    }

    /// Leaves a wish.
    pub fn post(&self, request: Request) {
        // The flag follows the request: who sees the flag finds the request.
        self.lock().push_back(request);
        self.inner.waiting.store(true, Ordering::Release);
        self.inner.arrived.notify_all();
    }

    /// Leaves several wishes, which are taken at one boundary.
    pub fn post_all(&self, requests: impl IntoIterator<Item = Request>) {
        let mut queue = self.lock();
        queue.extend(requests);
        let is_waiting = !queue.is_empty();
        drop(queue);
        if is_waiting {
            self.inner.waiting.store(true, Ordering::Release);
            self.inner.arrived.notify_all();
        }
    }

    /// Leaves a wish nobody wants an answer to.
    pub fn control(&self, control: Control) {
        self.post(Request { wish: Wish::Do(control.into()), reply: None });
    }

    /// True if nobody has left anything.
    pub fn is_empty(&self) -> bool {
        !self.inner.waiting.load(Ordering::Acquire)
    }

    /// The oldest wish, if any.
    pub(crate) fn take(&self) -> Option<Request> {
        if !self.inner.waiting.load(Ordering::Acquire) {
            return None;
        }
        let mut queue = self.lock();
        let request = queue.pop_front();
        self.inner.waiting.store(!queue.is_empty(), Ordering::Release);
        request
    }

    /// Waits until there is a wish, `patience` at most. Wall clock: only while time is held.
    pub(crate) fn wait(&self, patience: Duration) {
        let queue = self.lock();
        let _unused = self.inner.arrived.wait_timeout_while(queue, patience, |queue| queue.is_empty());
    }

    /// A thread that panicked while it held the lock left a whole queue: pushes and pops are atomic.
    fn lock(&self) -> MutexGuard<'_, VecDeque<Request>> {
        self.inner.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_taken_in_their_order() {
        let mailbox = Mailbox::new();
        assert!(mailbox.take().is_none());
        mailbox.control(Control::Pause);
        mailbox.clone().control(Control::Step);
        mailbox.wait(Duration::from_mins(1));
        assert_eq!(mailbox.take().map(|r| r.wish), Some(Wish::Do(Operation::Pause)));
        assert_eq!(mailbox.take().map(|r| r.wish), Some(Wish::Do(Operation::Step)));
        assert!(mailbox.take().is_none());
    }
}
