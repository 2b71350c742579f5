//! How far a command has got that nothing ends early but a signal: said in one line when one does.

use std::fmt;
use std::io::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::interrupt;

/// What is counted, and how much of it there is to do. Clones count together.
#[derive(Clone, Debug)]
pub struct HowFar(Arc<Counted>);

#[derive(Debug)]
struct Counted {
    /// What is done, as one of it and as several: `run`, `runs`.
    noun: [&'static str; 2],
    done: AtomicU64,
    /// How many there are, 0 as long as that is not known.
    all: AtomicU64,
    kind: Total,
}

/// What the whole number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Total {
    /// So many there are.
    Exact,
    /// So many may be tried.
    Most,
}

impl HowFar {
    /// Nothing is done yet of what is called so, one and several.
    pub fn of(noun: [&'static str; 2], kind: Total) -> Self {
        Self(Arc::new(Counted { noun, done: AtomicU64::new(0), all: AtomicU64::new(0), kind }))
    }

    /// From now on a signal that asks the process to end ends it at once, after one line that says how far it has got.
    pub fn on_signals(&self) {
        let own = self.clone();
        let line = move || {
            // On a terminal the cursor stands behind a bar, or behind `^C`.
            let begin = if std::io::IsTerminal::is_terminal(&std::io::stderr()) { "\n" } else { "" };
            // Where standard error takes nothing, there is nowhere to say so.
            drop(writeln!(std::io::stderr(), "{begin}{own}"));
        };
        interrupt::end_on_signals(line);
    }

    /// There are so many to do.
    pub fn set_total(&self, all: u64) {
        self.0.all.store(all, Ordering::Relaxed);
    }

    /// One more is done.
    pub fn one_more(&self) {
        self.0.done.fetch_add(1, Ordering::Relaxed);
    }
}

impl fmt::Display for HowFar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Counted { noun: [one, several], done, all, kind } = &*self.0;
        let (done, all) = (done.load(Ordering::Relaxed), all.load(Ordering::Relaxed));
        let noun = |count: u64| if count == 1 { one } else { several };
        match (all, kind) {
            (0, _) => write!(f, "stopped after {done} {}", noun(done)),
            (_, Total::Exact) => write!(f, "stopped after {done} of {all} {}", noun(all)),
            (_, Total::Most) => write!(f, "stopped after {done} of at most {all} {}", noun(all)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_said_in_one_line() {
        let how_far = HowFar::of(["run", "runs"], Total::Most);
        assert_eq!(how_far.to_string(), "stopped after 0 runs");
        how_far.clone().one_more();
        assert_eq!(how_far.to_string(), "stopped after 1 run");
        how_far.set_total(100);
        assert_eq!(how_far.to_string(), "stopped after 1 of at most 100 runs");
        let tests = HowFar::of(["test", "tests"], Total::Exact);
        tests.set_total(1);
        assert_eq!(tests.to_string(), "stopped after 0 of 1 test");
    }
}
