//! A running session as others see it: a view that is published at step boundaries.
//!
//! Readers never wait for the session, nor the session for them: it exchanges one pointer, and whoever
//! still reads the view before keeps it. While nobody reads, publishing costs the session one look at
//! an atomic number a step. Nothing of it is in the digest.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use arc_swap::ArcSwap;

use crate::client::{ClientView, Parts};
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
    pub state: ServerState,
    /// Virtual time of the last committed step.
    pub t_v: VirtualTime,
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
    /// How many want bodies, tables and memories in their views.
    parts: [AtomicUsize; 3],
}

/// Where a session publishes its views; clones share it.
#[derive(Clone, Debug)]
pub struct Published {
    inner: Arc<Inner>,
}

/// Parts that views are to show, for as long as this lives.
#[derive(Debug)]
pub struct Wants {
    published: Published,
    parts: Parts,
}

/// A reader that wants a view of every step, for as long as it lives.
#[derive(Debug)]
pub struct Follower {
    wants: Wants,
}

impl Published {
    /// Of a session that has not begun, with an image of `image_bytes` bytes.
    pub fn new(image_bytes: usize) -> Self {
        let latest = ArcSwap::from_pointee(SessionView::before(image_bytes));
        let (followers, wanted, parts) = (AtomicUsize::new(0), AtomicBool::new(false), Default::default());
        Self { inner: Arc::new(Inner { latest, followers, wanted, parts }) }
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

    /// From the next view on these parts are shown, until what this gives is dropped.
    #[must_use]
    pub fn want(&self, parts: Parts) -> Wants {
        for wanted in self.wanted_of(parts) {
            wanted.fetch_add(1, Ordering::AcqRel);
        }
        Wants { published: self.clone(), parts }
    }

    /// Asks for a view of every step, with these parts.
    #[must_use]
    pub fn follow(&self, parts: Parts) -> Follower {
        self.inner.followers.fetch_add(1, Ordering::AcqRel);
        Follower { wants: self.want(parts) }
    }

    /// How many want each of these parts.
    fn wanted_of(&self, parts: Parts) -> impl Iterator<Item = &AtomicUsize> {
        let Parts { poses, tables, memories } = parts;
        self.inner.parts.iter().zip([poses, tables, memories]).filter_map(|(wanted, is_of)| is_of.then_some(wanted))
    }

    /// The parts that somebody wants.
    pub(crate) fn parts(&self) -> Parts {
        let [poses, tables, memories] = &self.inner.parts;
        let is_wanted = |part: &AtomicUsize| part.load(Ordering::Acquire) > 0;
        Parts { poses: is_wanted(poses), tables: is_wanted(tables), memories: is_wanted(memories) }
    }

    /// True if a view is to be published now; one that was asked for is asked for once.
    pub(crate) fn is_wanted(&self) -> bool {
        self.inner.followers.load(Ordering::Acquire) > 0
            // Looked at before it is changed: a swap each step would take the line from its readers.
            || (self.inner.wanted.load(Ordering::Acquire) && self.inner.wanted.swap(false, Ordering::AcqRel))
    }

    /// True if somebody beside the session can look at its views, now or later.
    pub(crate) fn has_readers(&self) -> bool {
        Arc::strong_count(&self.inner) > 1
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
        self.wants.published.latest()
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        self.wants.published.inner.followers.fetch_sub(1, Ordering::AcqRel);
    }
}

impl Wants {
    /// The parts.
    #[must_use]
    pub fn parts(&self) -> Parts {
        self.parts
    }
}

impl Drop for Wants {
    fn drop(&mut self) {
        for wanted in self.published.wanted_of(self.parts) {
            wanted.fetch_sub(1, Ordering::AcqRel);
        }
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
        let follower = published.follow(Parts::POSES);
        assert!(published.is_wanted() && published.is_wanted());
        let mut view = SessionView::before(2);
        view.revision = 1;
        let before = published.publish(Arc::new(view));
        assert_eq!((before.revision, follower.latest().revision), (0, 1));
        drop(follower);
        assert!(!published.is_wanted());
    }

    #[test]
    fn a_view_shows_what_somebody_wants() {
        let published = Published::new(0);
        assert_eq!(published.parts(), Parts::default());
        let (follower, both) = (published.follow(Parts::POSES), published.want(Parts { tables: true, ..Parts::POSES }));
        let (again, memories) = (published.clone().want(Parts::POSES), published.want(Parts::MEMORIES));
        assert_eq!(published.parts(), Parts::ALL);
        drop((memories, both));
        assert_eq!(published.parts(), Parts::POSES);
        drop(follower);
        assert_eq!(published.parts(), again.parts());
        drop(again);
        assert_eq!(published.parts(), Parts::default());
    }
}
