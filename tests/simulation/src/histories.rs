//! Histories by their seeds, on all processors.
//!
//! `ONESCAN_HISTORIES` says how many there are of all kinds together; each kind has its share. One that fails names its seed, and
//! `ONESCAN_HISTORY` repeats that alone: `ONESCAN_HISTORY=recordings:123`.

use std::io::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A kind of history.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub name: &'static str,
    /// How many are tried if nobody says how many.
    pub few: u64,
    /// Its share of the histories that somebody wants, percent.
    pub share: u64,
}

/// One in so many is tried twice, and must be the same both times.
const TWICE: u64 = 64;

/// Tries histories of a kind. Each gives a hash of all that has happened in it.
///
/// # Panics
/// One of them ends as it must not, or not twice in the same way.
pub fn try_all(kind: Kind, history: impl Fn(u64) -> Result<u64, String> + Sync) {
    let Some((first, count)) = chosen(kind) else { return };
    let begun = Instant::now();
    let (next, events) = (AtomicU64::new(first), AtomicU64::new(0));
    let failed = std::thread::scope(|scope| {
        let work = || {
            loop {
                let seed = next.fetch_add(1, Ordering::Relaxed);
                if seed >= first + count {
                    return None;
                }
                if let Err(wrong) = tried(&history, seed, &events) {
                    // The others end with what they are at.
                    next.store(first + count, Ordering::Relaxed);
                    return Some((seed, wrong));
                }
            }
        };
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let threads: Vec<_> = (0..processors).map(|_| scope.spawn(work)).collect();
        threads.into_iter().filter_map(|thread| thread.join().expect("a history does not panic")).min()
    });
    let name = kind.name;
    if let Some((seed, wrong)) = failed {
        panic!("history {seed} of {name}: {wrong}; repeat it with ONESCAN_HISTORY={name}:{seed}");
    }
    let seconds = begun.elapsed().as_secs();
    let mut out = std::io::stdout().lock();
    writeln!(out, "{name}: {count} histories in {seconds} s").expect("somebody reads the tests' output");
}

fn tried(history: &impl Fn(u64) -> Result<u64, String>, seed: u64, events: &AtomicU64) -> Result<(), String> {
    let hash = history(seed)?;
    events.fetch_xor(hash, Ordering::Relaxed);
    if seed.is_multiple_of(TWICE) && history(seed)? != hash {
        return Err("it is another one when it is repeated".to_owned());
    }
    Ok(())
}

/// The first seed, and how many there are; nothing if another kind is to be repeated.
fn chosen(kind: Kind) -> Option<(u64, u64)> {
    if let Ok(one) = std::env::var("ONESCAN_HISTORY") {
        let (name, seed) = one.split_once(':').expect("KIND:SEED");
        return (name == kind.name).then(|| (seed.parse().expect("a number"), 1));
    }
    let wanted = std::env::var("ONESCAN_HISTORIES").ok().map(|all| all.parse::<u64>().expect("a number"));
    Some((0, wanted.map_or(kind.few, |all| all * kind.share / 100)))
}
