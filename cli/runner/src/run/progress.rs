//! A bar on a terminal; nothing anywhere else.

use std::time::Duration;

use super::session_log::SessionLog;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::session::Session;
use onescan_server::time::VirtualTime;

/// Steps between two looks at the bar; a power of two.
const STRIDE: u64 = 16;
/// Steps between two looks at the session log.
const LOG_STRIDE: u64 = 256;

/// Shows how far virtual time has come.
pub(super) struct Progress {
    bar: ProgressBar,
    label: String,
    log: SessionLog,
}

impl Progress {
    /// A bar that is full at `end`.
    pub(super) fn new(end: VirtualTime, label: String) -> Self {
        let bar =
            ProgressBar::with_draw_target(Some(end.as_nanos() / 1_000_000), ProgressDrawTarget::stderr_with_hz(10));
        if let Ok(style) = ProgressStyle::with_template("{msg:12} [{bar:40}] {pos} / {len} ms virtual  {elapsed} ") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(label.clone());
        Self { bar, label, log: SessionLog::default() }
    }

    /// The same, with the client beside it that the session waits for most.
    pub(super) fn with_log(self, log: SessionLog) -> Self {
        Self { log, ..self }
    }

    /// Moves the bar to a time that is known from elsewhere.
    pub(super) fn show(&self, elapsed: Duration) {
        self.bar.set_position(elapsed.as_millis() as u64);
    }
}

impl Progress {
    /// Takes the bar away.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Progress {
    fn begin(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.bar.set_position(session.t_v().as_nanos() / 1_000_000);
        Ok(())
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        if session.cycle().steps().0.is_multiple_of(STRIDE) {
            self.bar.set_position(session.t_v().as_nanos() / 1_000_000);
        }
        if session.cycle().steps().0.is_multiple_of(LOG_STRIDE)
            && let Some(brief) = self.log.brief()
        {
            self.bar.set_message(format!("{} ({brief})", self.label));
        }
        Ok(())
    }

    fn wants_idle_steps(&self) -> bool {
        false
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        self.bar.finish_and_clear();
        Ok(())
    }
}
