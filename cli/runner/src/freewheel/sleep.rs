//! Sleep that a stop ends, however long it was to be.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How often it is looked whether somebody wants to stop.
const GLANCE: Duration = Duration::from_millis(50);
/// A time that is further away than this is not waited for by anybody: a clock of the system may not reach so far.
const FAR: Duration = Duration::from_hours(24 * 365);
/// The last part of a precise sleep, which is spent awake.
const SPIN: Duration = Duration::from_millis(1);

/// The time `span` after `time`, but no later than [`FAR`] after it.
pub(super) fn after(time: Instant, span: Duration) -> Instant {
    time.checked_add(span.min(FAR)).unwrap_or(time)
}

/// Sleeps until `due`, or until one of `stops` is set.
pub(super) fn until(due: Instant, stops: [&AtomicBool; 2]) {
    while !stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
        let rest = due.saturating_duration_since(Instant::now());
        std::thread::sleep(rest.min(GLANCE));
        if rest <= GLANCE {
            return;
        }
    }
}

/// The same, awake for the last part.
pub(super) fn precisely_until(due: Instant, stops: [&AtomicBool; 2]) {
    until(due.checked_sub(SPIN).unwrap_or(due), stops);
    while Instant::now() < due && !stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
        std::hint::spin_loop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_ends_the_longest_sleep() {
        let (stop, other) = (AtomicBool::new(false), AtomicBool::new(false));
        std::thread::scope(|scope| {
            let sleeper = scope.spawn(|| until(after(Instant::now(), Duration::MAX), [&other, &stop]));
            stop.store(true, Ordering::Relaxed);
            sleeper.join().unwrap();
        });
        until(after(Instant::now(), Duration::ZERO), [&other, &other]);
        precisely_until(Instant::now(), [&other, &other]);
    }
}
