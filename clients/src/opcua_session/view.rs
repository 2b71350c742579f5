//! What an OPC UA client sees of the session.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_server::record::{Observer, RecordError};
use onescan_server::session::Session;
use onescan_server::time::{TimeSpan, VirtualTime};

/// The session at its last step boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SessionView {
    /// `waiting`, `running`, `held` or `ended`.
    pub state: &'static str,
    /// Virtual time.
    pub t_v: VirtualTime,
    /// Its step.
    pub step: TimeSpan,
    /// Steps done.
    pub steps: u64,
}

/// The observer that keeps the view up to date.
#[derive(Clone, Debug)]
pub struct Watcher(Arc<Mutex<SessionView>>);

impl Watcher {
    /// A session that has not begun.
    pub fn new(step: TimeSpan) -> Self {
        Self(Arc::new(Mutex::new(SessionView { state: "waiting", t_v: VirtualTime::ZERO, step, steps: 0 })))
    }

    /// What is seen now.
    pub fn view(&self) -> SessionView {
        *self.lock()
    }

    fn lock(&self) -> MutexGuard<'_, SessionView> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn look(&self, session: &Session, state: &'static str) {
        let mut view = self.lock();
        (view.state, view.t_v, view.steps) = (state, session.t_v(), session.cycle().steps().0);
    }
}

impl Observer for Watcher {
    fn begin(&mut self, session: &Session) -> Result<(), RecordError> {
        self.step(session)
    }

    fn step(&mut self, session: &Session) -> Result<(), RecordError> {
        self.look(session, if session.is_held() { "held" } else { "running" });
        Ok(())
    }

    fn end(&mut self, session: &Session) -> Result<(), RecordError> {
        self.look(session, "ended");
        Ok(())
    }
}
