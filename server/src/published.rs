//! A running session as others see it: a view that is published at step boundaries.
//!
//! Readers never wait for the session, nor the session for them: it exchanges one pointer, and whoever
//! still reads the view before keeps it. While nobody reads, publishing costs the session one look at
//! an atomic number a step. Nothing of it is in the digest.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use arc_swap::ArcSwap;

use crate::client::ClientView;
use crate::digest::Digest;
use crate::end::SessionEnd;
use crate::signal::SignalId;
use crate::state::ServerState;
use crate::time::{StepCount, VirtualTime};

/// A session at one step boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionView {
    /// Grows with every view of a session.
    pub revision: u64,
    /// The server's state.
    pub state: ServerState,
    /// Virtual time of the last committed step.
    pub t_v: VirtualTime,
    /// Steps committed.
    pub steps: StepCount,
    /// How often the session has restarted.
    pub resets: u64,
    /// True while virtual time is held by request.
    pub is_held: bool,
    /// The digest of all steps; nothing before the initial values.
    pub digest: Option<Digest>,
    /// How the session ended, once it has.
    pub end: Option<SessionEnd>,
    /// All signals, in the layout of the session's image.
    pub image: Vec<u8>,
    /// The signals that are forced, in the order of the session's plan.
    pub forced: Vec<SignalId>,
    /// What clients show beside their signals.
    pub clients: ClientView,
}

impl SessionView {
    /// A session that has not begun, with an image of `image_bytes` bytes.
    pub fn before(image_bytes: usize) -> Self {
        Self {
            revision: 0,
            state: ServerState::Start,
            t_v: VirtualTime::ZERO,
            steps: StepCount(0),
            resets: 0,
            is_held: false,
            digest: None,
            end: None,
            image: vec![0; image_bytes],
            forced: Vec::new(),
            clients: ClientView::default(),
        }
    }
}

#[derive(Debug)]
struct Inner {
    latest: ArcSwap<SessionView>,
    /// Readers that want a view of every step.
    followers: AtomicUsize,
    /// Somebody wants one view.
    wanted: AtomicBool,
}

/// Where a session publishes its views; clones share it.
#[derive(Clone, Debug)]
pub struct Published {
    inner: Arc<Inner>,
}

/// A reader that wants a view of every step, for as long as it lives.
#[derive(Debug)]
pub struct Follower {
    published: Published,
}

impl Published {
    /// Of a session that has not begun, with an image of `image_bytes` bytes.
    pub fn new(image_bytes: usize) -> Self {
        let latest = ArcSwap::from_pointee(SessionView::before(image_bytes));
        Self { inner: Arc::new(Inner { latest, followers: AtomicUsize::new(0), wanted: AtomicBool::new(false) }) }
    }

    /// The view that was published last. It is of the last step only while somebody
    /// [follows](Self::follow), or has [asked](Self::ask) for it.
    #[must_use]
    pub fn latest(&self) -> Arc<SessionView> {
        self.inner.latest.load_full()
    }

    /// Asks for a view at the next boundary.
    pub fn ask(&self) {
        self.inner.wanted.store(true, Ordering::Release);
    }

    /// Asks for a view of every step.
    #[must_use]
    pub fn follow(&self) -> Follower {
        self.inner.followers.fetch_add(1, Ordering::AcqRel);
        Follower { published: self.clone() }
    }

    /// True if a view is to be published now; one that was asked for is asked for once.
    pub(crate) fn is_wanted(&self) -> bool {
        self.inner.followers.load(Ordering::Acquire) > 0
            // Looked at before it is changed: a swap each step would take the line from its readers.
            || (self.inner.wanted.load(Ordering::Acquire) && self.inner.wanted.swap(false, Ordering::AcqRel))
    }

    /// True if somebody wants a view of every step.
    pub(crate) fn is_followed(&self) -> bool {
        self.inner.followers.load(Ordering::Acquire) > 0
    }

    /// Publishes a view, and gives back the one before if nobody reads it any more.
    pub(crate) fn publish(&self, view: Arc<SessionView>) -> Arc<SessionView> {
        self.inner.latest.swap(view)
    }
}

impl Follower {
    /// The view of the last step.
    #[must_use]
    pub fn latest(&self) -> Arc<SessionView> {
        self.published.latest()
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        self.published.inner.followers.fetch_sub(1, Ordering::AcqRel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_made_for_those_who_ask() {
        let published = Published::new(2);
        assert!(!published.is_wanted());
        published.ask();
        assert!(published.is_wanted());
        assert!(!published.is_wanted(), "once");
        let follower = published.follow();
        assert!(published.is_wanted() && published.is_wanted());
        let mut view = SessionView::before(2);
        view.revision = 1;
        let before = published.publish(Arc::new(view));
        assert_eq!((before.revision, follower.latest().revision), (0, 1));
        drop(follower);
        assert!(!published.is_wanted());
    }
}
