//! Operators on the past: what they say of a sample is known at once.

use super::formula::Window;
use super::sample::Sample;
use super::sliding::{Joined, Sliding};

/// A window back from each sample, to the start at most. The value that holds where it begins is in it.
#[derive(Clone, Debug)]
pub(super) struct Back<J> {
    window: Window,
    seen: Sliding<J>,
    /// What lies between the window and the sample.
    tail: Sliding<J>,
}

impl<J: Joined> Back<J> {
    pub(super) fn new(window: Window) -> Self {
        let mut seen = Sliding::new();
        if window.to_ns.is_none() {
            seen.grow_only();
        }
        Self { window, seen, tail: Sliding::new() }
    }

    /// Takes the next sample: what its window comes to, and what lies behind that.
    pub(super) fn push(&mut self, sample: Sample, member: J) -> (J, J) {
        self.tail.push(sample, member);
        let last_ns = sample.t_ns.checked_sub(self.window.from_ns);
        while self.tail.at(0).is_some_and(|first| last_ns.is_some_and(|last_ns| first.t_ns <= last_ns)) {
            if let Some((passed, member)) = self.tail.pop() {
                self.seen.push(passed, member);
            }
        }
        let first_ns = self.window.to_ns.and_then(|to_ns| sample.t_ns.checked_sub(to_ns));
        while self.seen.at(1).is_some_and(|second| first_ns.is_some_and(|first_ns| second.t_ns <= first_ns)) {
            self.seen.pop();
        }
        (self.seen.all(), self.tail.all())
    }
}

#[cfg(test)]
impl<J: Joined> Back<J> {
    pub(super) fn held(&self) -> usize {
        self.seen.len() + self.tail.len()
    }
}
