//! When viewers look: all of them at the same frames, so that the session shows one view to all.
//!
//! A session has a core of its own at best. Viewers that look when each of them likes wake this thread and ask the session
//! as often as there are viewers; together they do so once.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::time::{Instant, Interval, MissedTickBehavior, interval_at};

/// From one frame to the next.
const FRAME: Duration = Duration::from_millis(16);

/// The frames, counted from where the page begins.
#[derive(Debug)]
pub(super) struct Frames {
    began: Instant,
    /// The last frame in which the session was asked for a view.
    asked: AtomicU64,
}

impl Frames {
    pub(super) fn begin() -> Self {
        Self { began: Instant::now(), asked: AtomicU64::new(0) }
    }

    /// One tick now, and then one per frame. A tick that is missed is left out, as all before now are.
    pub(super) fn ticks(&self) -> Interval {
        let mut ticks = interval_at(self.began, FRAME);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
        ticks
    }

    /// True for the first who asks in a frame.
    pub(super) fn is_first(&self) -> bool {
        self.is_first_in(self.number())
    }

    fn is_first_in(&self, number: u64) -> bool {
        self.asked.swap(number, Ordering::Relaxed) != number
    }

    /// The number of the next frame, from 1.
    fn number(&self) -> u64 {
        next(self.began.elapsed())
    }
}

/// The number of the next frame, so long after the page has begun.
fn next(passed: Duration) -> u64 {
    u64::try_from(passed.as_nanos() / FRAME.as_nanos()).unwrap_or(u64::MAX).saturating_add(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_comes_between_two_looks_with_all_others_at_the_next() {
        let all = [0, 1, 15, 16, 17, 31, 32].map(|ms| next(Duration::from_millis(ms)));
        assert_eq!(all, [1, 1, 1, 2, 2, 2, 3]);
    }

    #[test]
    fn one_asks_for_all() {
        let frames = Frames { began: Instant::now(), asked: AtomicU64::new(0) };
        assert_eq!(
            [1, 1, 1, 2, 2, 5].map(|number| frames.is_first_in(number)),
            [true, false, false, true, false, true]
        );
    }
}
