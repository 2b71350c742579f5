//! Seeded mutations of sources: whatever comes of it, what [`property`] says holds.
//!
//! A small number of them runs with all tests. For more:
//!
//! ```sh
//! ONESCAN_MUTATIONS=1000000 cargo test --release -p onescan-iec-tests --test mutations -- --nocapture
//! ```
//!
//! A panic names the seed; `ONESCAN_MUTATION_SEED=n ONESCAN_MUTATIONS=1` repeats it.

mod mutator;
mod property;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use mutator::{Corpus, Mutator, Source};
use property::examine;

/// How often it is looked whether the test gets on.
const WATCH: Duration = Duration::from_mins(1);

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

/// What came of all sources.
#[derive(Debug, Default)]
struct Tally {
    inputs: u64,
    parsed: u64,
    sound: u64,
    slowest: Duration,
}

impl Tally {
    fn examine(&mut self, source: &Source) {
        let started = Instant::now();
        let outcome = examine(source.kind, source.text.as_bytes());
        self.inputs += 1;
        self.parsed += u64::from(outcome.parsed);
        self.sound += u64::from(outcome.sound);
        self.slowest = self.slowest.max(started.elapsed());
    }
}

/// Runs `work`, which says what it is at. A hang never ends the test: where it is, is reported.
#[expect(clippy::print_stderr, reason = "a test that hangs has no other way to say where")]
fn watched(work: impl FnOnce(&AtomicU64)) {
    let (at, (ended, end)) = (&AtomicU64::new(u64::MAX), channel::<()>());
    std::thread::scope(|scope| {
        scope.spawn(move || {
            let mut last = None;
            while end.recv_timeout(WATCH) == Err(RecvTimeoutError::Timeout) {
                let now = at.load(Ordering::Relaxed);
                if last == Some(now) {
                    eprintln!("seed {now} has been at work for {WATCH:?} and more");
                }
                last = Some(now);
            }
        });
        work(at);
        drop(ended);
    });
}

#[test]
#[expect(clippy::print_stdout, reason = "the measurement's figures, which a test that passes keeps to itself")]
fn no_mutation_makes_the_front_end_panic() {
    let (count, first) = (number("ONESCAN_MUTATIONS", 5_000), number("ONESCAN_MUTATION_SEED", 0));
    let corpus = Corpus::read();
    let mut tally = Tally::default();
    let started = Instant::now();
    watched(|at| {
        for seed in first..first + count {
            at.store(seed, Ordering::Relaxed);
            let mutant = Mutator::new(seed).mutant(&corpus);
            let held = catch_unwind(AssertUnwindSafe(|| tally.examine(&mutant))).is_ok();
            assert!(held, "seed {seed}, {:?}:\n{}", mutant.kind, mutant.text);
        }
    });
    println!("{tally:?} in {:.0?}", started.elapsed());
    assert!(count < 100 || tally.parsed > 0, "some mutants still parse");
}
