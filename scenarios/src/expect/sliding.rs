//! What is joined over a window that moves: a queue made of two stacks joins every member at most three times,
//! whatever the window's length.

use std::collections::VecDeque;

use super::sample::{Certain, Judged, Sample};
use super::truth::{Scale, Worth};

/// What members of a window come to; joining is associative, in the order of time.
pub(super) trait Joined: Copy {
    /// What no member comes to.
    const NOTHING: Self;

    fn then(self, later: Self) -> Self;

    /// What may be reported of a violation.
    fn certain(&self) -> Option<Certain>;
}

#[derive(Clone, Copy, Debug)]
pub(super) struct All {
    pub(super) worth: Worth,
    /// Of the first that does not.
    pub(super) broken: Option<Certain>,
}

impl All {
    pub(super) fn of(judged: &Judged) -> Self {
        Self { worth: judged.worth, broken: judged.if_false() }
    }
}

impl Joined for All {
    const NOTHING: Self = Self { worth: Worth::TOP, broken: None };

    fn then(self, later: Self) -> Self {
        Self { worth: self.worth.and(later.worth), broken: self.broken.or(later.broken) }
    }

    fn certain(&self) -> Option<Certain> {
        self.broken
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Any {
    pub(super) worth: Worth,
    /// Of the last one.
    pub(super) last: Option<Certain>,
}

impl Any {
    pub(super) fn of(judged: &Judged) -> Self {
        Self { worth: judged.worth, last: Some(judged.certain) }
    }
}

impl Joined for Any {
    const NOTHING: Self = Self { worth: Worth::BOTTOM, last: None };

    fn then(self, later: Self) -> Self {
        Self { worth: self.worth.or(later.worth), last: later.last.or(self.last) }
    }

    fn certain(&self) -> Option<Certain> {
        self.last
    }
}

/// The right one is reached, and the left one held until then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pursuit {
    pub(super) reached: Worth,
    /// The left one held all the time.
    pub(super) held: Worth,
    /// Of the first at which the left one does not hold, if the right one was false until then and there.
    pub(super) broken: Option<Certain>,
    /// Whether the right one was not false somewhere.
    stopped: bool,
}

impl Pursuit {
    pub(super) fn of(left: &Judged, right: &Judged) -> Self {
        let stopped = !right.worth.is_false();
        let broken = if stopped { None } else { left.if_false() };
        Self { reached: right.worth, held: left.worth, broken, stopped }
    }
}

impl Joined for Pursuit {
    const NOTHING: Self = Self { reached: Worth::BOTTOM, held: Worth::TOP, broken: None, stopped: false };

    fn then(self, later: Self) -> Self {
        Self {
            reached: self.reached.or(self.held.and(later.reached)),
            held: self.held.and(later.held),
            broken: self.broken.or(if self.stopped { None } else { later.broken }),
            stopped: self.stopped || later.stopped,
        }
    }

    fn certain(&self) -> Option<Certain> {
        self.broken
    }
}

/// The mirror image: the left one held since the right one was reached.
#[derive(Clone, Copy, Debug)]
pub(super) struct Since {
    pub(super) reached: Worth,
    pub(super) held: Worth,
}

impl Joined for Since {
    const NOTHING: Self = Self { reached: Worth::BOTTOM, held: Worth::TOP };

    fn then(self, later: Self) -> Self {
        Self { reached: later.reached.or(later.held.and(self.reached)), held: self.held.and(later.held) }
    }

    fn certain(&self) -> Option<Certain> {
        None
    }
}

/// A window that takes members at its end and gives them away at its beginning.
#[derive(Clone, Debug)]
pub(super) struct Sliding<J> {
    members: VecDeque<(Sample, J)>,
    /// Each of the first members joined with those behind it; the first one's is the last here.
    leaving: Vec<J>,
    /// What all others come to.
    arrived: J,
    /// Set where nothing will be given away again: members need not be kept.
    grows_only: bool,
}

impl<J: Joined> Sliding<J> {
    pub(super) fn new() -> Self {
        Self { members: VecDeque::new(), leaving: Vec::new(), arrived: J::NOTHING, grows_only: false }
    }

    /// From now on nothing is given away.
    pub(super) fn grow_only(&mut self) {
        self.arrived = self.all();
        self.leaving = Vec::new();
        self.members = VecDeque::new();
        self.grows_only = true;
    }

    pub(super) fn push(&mut self, sample: Sample, member: J) {
        if !self.grows_only {
            self.members.push_back((sample, member));
        }
        self.arrived = self.arrived.then(member);
    }

    /// Gives the first member away.
    pub(super) fn pop(&mut self) -> Option<(Sample, J)> {
        if self.leaving.is_empty() {
            let mut all = J::NOTHING;
            // A queue of two stacks: each member is turned over once, so that a `pop` costs the same on average however long
            // the window is.
            for (_, member) in self.members.iter().rev() {
                all = member.then(all);
                self.leaving.push(all);
            }
            self.arrived = J::NOTHING;
        }
        self.leaving.pop();
        self.members.pop_front()
    }

    /// The time of the member in this place, counted from the beginning.
    pub(super) fn at(&self, place: usize) -> Option<Sample> {
        self.members.get(place).map(|(sample, _)| *sample)
    }

    /// What all members come to.
    pub(super) fn all(&self) -> J {
        self.leaving.last().copied().unwrap_or(J::NOTHING).then(self.arrived)
    }
}

#[cfg(test)]
impl<J> Sliding<J> {
    pub(super) fn len(&self) -> usize {
        self.members.len() + self.leaving.len()
    }
}
