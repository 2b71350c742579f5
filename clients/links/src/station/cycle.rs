//! The wall clock that drives the PLC: a cycle on a grid, or one behind the other.

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use onescan_base::threads;

use super::controller::Controller;

/// What the PLC's own clock goes on by in a cycle that has no interval.
const CYCLE_WITHOUT_INTERVAL: Duration = Duration::from_micros(100);

/// The thread in which cycles run.
pub struct Clockwork {
    controller: Arc<Controller>,
    thread: Option<JoinHandle<()>>,
}

impl Clockwork {
    /// Runs a cycle every `interval`; without one, the next begins when the last has ended.
    ///
    /// # Errors
    /// There is no thread.
    pub fn start(controller: Arc<Controller>, interval: Option<Duration>) -> std::io::Result<Self> {
        let driven = Arc::clone(&controller);
        let thread = threads::start("PLC", move || match interval {
            Some(interval) => on_grid(&driven, interval),
            None => back_to_back(&driven),
        })?;
        Ok(Self { controller, thread: Some(thread) })
    }
}

impl Drop for Clockwork {
    fn drop(&mut self) {
        self.controller.end();
        if let Some(thread) = self.thread.take() {
            // The thread itself has reported its panic.
            let _ = thread.join();
        }
    }
}

/// A late cycle does not delay those after it; cycles that were missed are left out.
fn on_grid(controller: &Controller, interval: Duration) {
    let span_ns = interval.as_nanos() as u64;
    let mut due = Instant::now();
    while controller.cycle(span_ns) {
        due += interval;
        let now = Instant::now();
        match due.checked_duration_since(now) {
            Some(rest) => std::thread::sleep(rest),
            None => due = now,
        }
    }
}

fn back_to_back(controller: &Controller) {
    while controller.cycle(CYCLE_WITHOUT_INTERVAL.as_nanos() as u64) {
        std::thread::yield_now();
        while controller.is_wanted() {
            std::thread::yield_now();
        }
    }
}
