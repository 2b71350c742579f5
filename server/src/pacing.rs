//! Pacing: how fast virtual time may run against the wall clock. It delays grants and never changes
//! them; this file and the transports' timeouts are the only readers of a clock in the crate.

use std::time::{Duration, Instant};

use crate::time::VirtualTime;

/// How fast a session runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pace {
    /// As fast as its clients.
    #[default]
    Max,
    /// So many seconds of virtual time in a second of the wall clock, at most.
    Factor(f64),
}

/// Holds a session back to its pace.
#[derive(Debug)]
pub(crate) struct Pacer {
    pace: Pace,
    origin: Option<(Instant, VirtualTime)>,
}

impl Pacer {
    pub(crate) fn new(pace: Pace) -> Self {
        Self { pace, origin: None }
    }

    /// True if nothing is held back.
    pub(crate) fn is_free(&self) -> bool {
        self.pace == Pace::Max
    }

    /// Counts anew from the next step on: after a pause, a reset, a restore.
    pub(crate) fn rebase(&mut self) {
        self.origin = None;
    }

    /// Sleeps until the wall clock has come to `t_v`. A session that is late is not made to hurry
    /// beyond its pace for what it lost: the loss is forgotten.
    pub(crate) fn hold_until(&mut self, t_v: VirtualTime) {
        let Pace::Factor(factor) = self.pace else { return };
        let now = Instant::now();
        let (start, from) = *self.origin.get_or_insert((now, t_v));
        debug_assert!(t_v >= from, "virtual time goes back only with a reset, which rebases");
        // `Duration` and `Instant` panic on what they cannot hold, and a small factor makes centuries of a step.
        let due = start + Duration::from_secs_f64(((t_v - from) as f64 / 1e9 / factor).clamp(0.0, 1e9));
        match due.checked_duration_since(now) {
            Some(early) => std::thread::sleep(early),
            None if now - due > Duration::from_millis(500) => self.origin = Some((now, t_v)),
            None => {}
        }
    }
}
