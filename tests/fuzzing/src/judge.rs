//! One input given to one target: whether it held, how long it took, how much memory.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::memory;
use crate::targets::Prepared;

/// What must hold of every input.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Processor time.
    pub seconds: f64,
    /// Memory.
    pub mib: usize,
}

/// What came of an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// What is wrong, if anything: equal for equal causes.
    pub wrong: Option<Wrong>,
    /// The target took it for a good one.
    pub is_accepted: bool,
    /// Processor time.
    pub seconds: f64,
    /// Memory at most.
    pub mib: usize,
}

/// A way not to hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// A panic, with its place.
    Panic {
        /// File and line.
        place: String,
        /// What it said.
        message: String,
    },
    /// Too slow.
    Slow,
    /// Too large.
    Large,
    /// The process ended, by a signal or for want of memory or stack.
    Ended,
}

impl Wrong {
    /// The same for the same cause.
    pub fn key(&self) -> String {
        match self {
            Self::Panic { place, .. } => format!("panic at {place}"),
            Self::Slow => "too slow".to_owned(),
            Self::Large => "too much memory".to_owned(),
            Self::Ended => "the process ended".to_owned(),
        }
    }
}

/// What the last panic said.
static SAID: Mutex<Option<(String, String)>> = Mutex::new(None);
/// When the input that is looked at was given, in ms of [`Instant`]; 0 while there is none.
static GIVEN_MS: AtomicU64 = AtomicU64::new(0);

/// Notes panics instead of showing them, and ends the process if an input takes `patience`.
pub fn watch(patience: Duration) {
    std::panic::set_hook(Box::new(|info| {
        let place = info.location().map_or_else(String::new, |at| format!("{}:{}", at.file(), at.line()));
        let message = info.payload_as_str().unwrap_or_default().to_owned();
        if let Ok(mut said) = SAID.lock() {
            *said = Some((place, message));
        }
    }));
    let start = Instant::now();
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let (now_ms, given_ms) = (start.elapsed().as_millis() as u64 + 1, GIVEN_MS.load(Ordering::Relaxed));
            match given_ms {
                0 => {}
                // Marked by the first look, so that the thread under test need not look at a clock.
                1 => drop(GIVEN_MS.compare_exchange(1, now_ms + 1, Ordering::Relaxed, Ordering::Relaxed)),
                since if now_ms.saturating_sub(since) > patience.as_millis() as u64 => std::process::abort(),
                _ => {}
            }
        }
    });
}

/// Gives an input to a target.
pub fn judge(target: &mut Prepared, input: &[u8], limits: Limits) -> Verdict {
    let first = once(target, input, limits);
    if first.wrong != Some(Wrong::Slow) {
        return first;
    }
    // Other work on the machine makes caches cold: what is slow is so twice.
    let again = once(target, input, limits);
    if again.seconds < first.seconds { again } else { first }
}

fn once(target: &mut Prepared, input: &[u8], limits: Limits) -> Verdict {
    GIVEN_MS.store(1, Ordering::Relaxed);
    let (before, start) = (memory::begin(), Processor::now());
    let taken = catch_unwind(AssertUnwindSafe(|| (target.take)(input)));
    let (seconds, mib) = (start.elapsed(), memory::most_since(before) >> 20);
    GIVEN_MS.store(0, Ordering::Relaxed);
    let is_accepted = matches!(taken, Ok(true));
    let wrong = match taken {
        Err(_) => {
            let said = SAID.lock().ok().and_then(|mut said| said.take());
            let (place, message) = said.unwrap_or_default();
            Some(Wrong::Panic { place, message })
        }
        Ok(_) if seconds > limits.seconds => Some(Wrong::Slow),
        Ok(_) if mib > limits.mib => Some(Wrong::Large),
        Ok(_) => None,
    };
    Verdict { wrong, is_accepted, seconds, mib }
}

/// Time of this thread on a processor where the system reports it, of the clock on the wall elsewhere.
enum Processor {
    Nanoseconds(u64),
    Wall(Instant),
}

impl Processor {
    fn now() -> Self {
        of_thread().map_or_else(|| Self::Wall(Instant::now()), Self::Nanoseconds)
    }

    fn elapsed(&self) -> f64 {
        match self {
            Self::Nanoseconds(start) => of_thread().unwrap_or(*start).saturating_sub(*start) as f64 * 1e-9,
            Self::Wall(start) => start.elapsed().as_secs_f64(),
        }
    }
}

/// `schedstat` begins with the nanoseconds that the thread ran.
fn of_thread() -> Option<u64> {
    std::fs::read_to_string("/proc/thread-self/schedstat").ok()?.split(' ').next()?.parse().ok()
}
