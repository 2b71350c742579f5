//! What others see of a running session: observers on its own thread, published views for the rest.

use std::sync::Arc;

use super::Lockstep;
use crate::client::Parts;
use crate::digest::TrajectoryDigest;
use crate::end::SessionEnd;
use crate::observer::RecordError;
use crate::operation::Author;
use crate::published::{Published, SessionView};

/// Where views go, and the memory for the next one.
pub(super) struct Shown {
    published: Published,
    /// A view that nobody reads any more, so that publishing allocates nothing.
    spare: Option<Arc<SessionView>>,
    image_bytes: usize,
    revision: u64,
}

impl Shown {
    pub(super) fn new(image_bytes: usize) -> Self {
        Self { published: Published::new(image_bytes), spare: None, image_bytes, revision: 0 }
    }

    pub(super) fn published(&self) -> Published {
        self.published.clone()
    }

    /// Somebody wants a view of every step.
    pub(super) fn is_watched(&self) -> bool {
        self.published.is_followed()
    }

    pub(super) fn set_published(&mut self, published: Published) {
        // Whoever looks knows a view by its revision, also one of another session that was published there before.
        self.revision = self.revision.max(published.latest().revision);
        self.published = published;
    }

    /// The memory of a view, its own alone.
    fn blank(&mut self) -> Arc<SessionView> {
        let spare = self.spare.take().filter(|spare| Arc::strong_count(spare) == 1);
        spare.unwrap_or_else(|| Arc::new(SessionView::before(self.image_bytes)))
    }
}

impl Lockstep {
    /// The image holds the initial values.
    pub(super) fn begin(&mut self) -> Result<(), RecordError> {
        let at_start = std::mem::take(&mut self.at_start);
        if self.session.end().is_some() {
            return Ok(());
        }
        if self.digest.is_some() {
            self.resets += 1;
        }
        self.digest = Some(TrajectoryDigest::begin(&self.session));
        self.notify_beginning()?;
        at_start.into_iter().try_for_each(|operation| self.notify_operated(operation, Author::Timeline))
    }

    /// Shows observers the image with which the session begins or goes on.
    pub(super) fn notify_beginning(&mut self) -> Result<(), RecordError> {
        self.publish();
        let Some(digest) = &self.digest else { return Ok(()) };
        self.observers.iter_mut().try_for_each(|observer| observer.begin(&self.session, digest))
    }

    /// Shows observers the image that was just committed.
    pub(super) fn notify_step(&mut self) -> Result<(), RecordError> {
        self.publish();
        let Some(digest) = &self.digest else { return Ok(()) };
        self.observers.iter_mut().try_for_each(|observer| observer.step(&self.session, digest))
    }

    /// Publishes a view if somebody wants one.
    pub(super) fn publish(&mut self) {
        if self.shown.published.is_wanted() {
            self.publish_view(None);
        }
    }

    /// Publishes the last view of the session to all who may look at it, now or later. Where nobody can, no image is copied.
    pub(super) fn publish_end(&mut self, end: &SessionEnd) {
        if self.shown.published.has_readers() {
            self.publish_view(Some(end));
        }
    }

    #[cold]
    fn publish_view(&mut self, end: Option<&SessionEnd>) {
        let (steps, t_v) = self.committed();
        self.shown.revision += 1;
        let mut shared = self.shown.blank();
        let Some(view) = Arc::get_mut(&mut shared) else {
            debug_assert!(false, "a blank view is shared");
            return;
        };
        view.revision = self.shown.revision;
        view.state = self.session.cycle().server();
        (view.t_v, view.steps) = (t_v, steps);
        view.resets = self.resets;
        view.is_held = self.session.is_held();
        view.digest = self.digest.as_mut().map(TrajectoryDigest::value_each_step);
        view.end = end.cloned();
        view.image.clear();
        view.image.extend_from_slice(self.session.image());
        debug_assert_eq!(view.image.len(), self.shown.image_bytes, "all views of a session have one size");
        view.forced.clear();
        view.forced.extend(self.session.forced());
        // The last view is looked at by those who come when all is over, too.
        let parts = if end.is_some() { Parts::ALL } else { self.shown.published.parts() };
        view.clients.clear(parts);
        for slot in &self.slots {
            slot.carrier.show(parts, &mut view.clients);
        }
        self.shown.spare = Some(self.shown.published.publish(shared));
    }
}
