//! When viewers look: all of them at the same frames, so that the session shows one view to all.
//!
//! A session has a core of its own at best. Viewers that look when each of them likes wake this thread and ask the session
//! as often as there are viewers; together they do so once.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use tokio::time::{Instant, Interval, MissedTickBehavior, interval_at};

/// From one frame to the next.
const FRAME: Duration = Duration::from_millis(16);

/// How many frames the session is spared at most after a view. Whether it made the view all that time or waited for its
/// pace cannot be seen from here.
const SPARED_MAX: u64 = 30;

/// The frames, counted from where the page begins.
#[derive(Debug)]
pub(super) struct Frames {
    began: Instant,
    /// The last request for a view.
    request: Mutex<Option<Request>>,
}

/// A request for a view.
#[derive(Debug)]
struct Request {
    /// The frame in which it was made.
    made: u64,
    /// The view that was there then.
    revision: u64,
    /// The first frame in which the next one may be made, once the view has come.
    next: Option<u64>,
}

impl Frames {
    pub(super) fn begin() -> Self {
        Self { began: Instant::now(), request: Mutex::default() }
    }

    /// One tick now, and then one per frame. A tick that is missed is left out, as all before now are.
    pub(super) fn ticks(&self) -> Interval {
        let mut ticks = interval_at(self.began, FRAME);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
        ticks
    }

    /// True for the first who looks in a frame in which the session is to be asked for a view; the last one has
    /// `revision`.
    pub(super) fn is_due(&self, revision: u64) -> bool {
        // A thread that panicked under the lock has left whole numbers.
        let mut last = self.request.lock().unwrap_or_else(PoisonError::into_inner);
        is_due(&mut last, next(self.began.elapsed()), revision)
    }
}

impl Request {
    /// True in the first frame in which the next request may be made; the last view has `revision`.
    ///
    /// A view that takes longer than a frame would be made at every step. So the session works for as many frames as
    /// it has spent on the view before it is asked again: what viewers want takes half of its time at most.
    fn is_over(&mut self, frame: u64, revision: u64) -> bool {
        if self.revision == revision {
            return false;
        }
        let spent = frame.saturating_sub(self.made + 1).min(SPARED_MAX);
        // Counted when the view is first seen, which may be in the frame of its request.
        let next = *self.next.get_or_insert(frame + spent);
        frame != self.made && frame >= next
    }
}

/// Makes a request if there is none, or if it is time for the next one.
fn is_due(last: &mut Option<Request>, frame: u64, revision: u64) -> bool {
    let is_due = last.as_mut().is_none_or(|last| last.is_over(frame, revision));
    if is_due {
        *last = Some(Request { made: frame, revision, next: None });
    }
    is_due
}

/// The number of the next frame, so long after the page has begun, from 1.
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

    /// Which of the frames are due, for looks at (frame, revision of the last view).
    fn due(looks: &[(u64, u64)]) -> Vec<u64> {
        let mut last = None;
        looks.iter().filter(|(frame, revision)| is_due(&mut last, *frame, *revision)).map(|(frame, _)| *frame).collect()
    }

    #[test]
    fn one_asks_for_all() {
        assert_eq!(due(&[(1, 7), (1, 7), (1, 8), (2, 8), (2, 8), (3, 9), (4, 10)]), [1, 2, 3, 4]);
    }

    #[test]
    fn a_view_that_takes_frames_leaves_the_session_as_many() {
        let looks: Vec<(u64, u64)> = (1..=20).map(|frame| (frame, frame / 4)).collect();
        // Asked in 1, there in 4, two frames later than the next one: asked again in 6. That is there in 8, and so on.
        assert_eq!(due(&looks), [1, 6, 9, 14, 17]);
    }

    #[test]
    fn a_session_that_is_held_is_asked_once() {
        assert_eq!(due(&[(1, 3), (2, 3), (90, 3), (91, 4), (120, 4), (121, 4)]), [1, 121]);
    }
}
