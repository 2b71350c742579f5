//! Who looks at a page: whether anybody has yet, and how many do now.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often whoever waits for a viewer looks whether that is over.
const GLANCE: Duration = Duration::from_millis(100);

/// How long a viewer is gone at most that only loads the page again.
const RELOAD: Duration = Duration::from_secs(3);

/// The viewers of a page.
#[derive(Debug, Default)]
pub(super) struct Attendance {
    viewers: Mutex<Viewers>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Viewers {
    present: usize,
    /// Whether there has ever been one.
    began: bool,
}

/// A viewer, for as long as it looks.
#[derive(Debug)]
pub(super) struct Present<'a> {
    attendance: &'a Attendance,
}

impl Attendance {
    /// A thread that panicked under the lock has left whole values.
    fn lock(&self) -> MutexGuard<'_, Viewers> {
        self.viewers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts a viewer until what this gives is dropped.
    pub(super) fn enter(&self) -> Present<'_> {
        let mut viewers = self.lock();
        viewers.present += 1;
        viewers.began = true;
        self.changed.notify_all();
        Present { attendance: self }
    }

    /// Waits until the first viewer looks, or until `is_over`, which is asked now and then.
    pub(super) fn await_first(&self, is_over: impl Fn() -> bool) {
        let mut viewers = self.lock();
        while !viewers.began && !is_over() {
            viewers = self.changed.wait_timeout(viewers, GLANCE).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Waits until the last viewer has left for longer than a page takes to load again, or until `is_over`.
    pub(super) fn await_departure(&self, is_over: impl Fn() -> bool) {
        let mut viewers = self.lock();
        let mut absent = Duration::ZERO;
        while absent < RELOAD && !is_over() {
            viewers = self.changed.wait_timeout(viewers, GLANCE).unwrap_or_else(PoisonError::into_inner).0;
            absent = if viewers.began && viewers.present == 0 { absent + GLANCE } else { Duration::ZERO };
        }
    }

    /// Waits until all viewers have left, but no longer than that.
    pub(super) fn await_last(&self, at_most: Duration) {
        let looks = |viewers: &mut Viewers| viewers.present > 0;
        drop(self.changed.wait_timeout_while(self.lock(), at_most, looks));
    }
}

impl Drop for Present<'_> {
    fn drop(&mut self) {
        self.attendance.lock().present -= 1;
        self.attendance.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_is_waited_for_who_is_not_there() {
        let attendance = Attendance::default();
        attendance.await_last(Duration::MAX);
        attendance.await_first(|| true);
        let (one, other) = (attendance.enter(), attendance.enter());
        attendance.await_first(|| false);
        drop(one);
        std::thread::scope(|scope| {
            let last = scope.spawn(|| attendance.await_last(Duration::MAX));
            drop(other);
            last.join().unwrap();
        });
        attendance.await_first(|| false);
        attendance.await_departure(|| false);
        let slow = attendance.enter();
        attendance.await_last(Duration::ZERO);
        assert_eq!(slow.attendance.lock().present, 1, "one that does not read is left after the time");
    }
}
