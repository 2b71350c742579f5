//! What a lesson does, moved from its own time, which begins with it, to that of the session.

use onescan_server::time::{TimeSpan, VirtualTime};
use toml::Spanned;

use crate::case::file::{DisturbanceFile, FaultFile, ForceFile, InputFile};

/// Where a lesson begins, and how long a step is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shift {
    pub(super) start: VirtualTime,
    pub(super) step: TimeSpan,
}

impl Shift {
    /// A time of the lesson. What comes with its start comes with the first step behind it: the start itself is past.
    fn moved(self, at: VirtualTime) -> VirtualTime {
        let moved = TimeSpan::from_nanos(at.as_nanos()).map_or(self.start, |span| self.start + span);
        moved.max(self.start + self.step)
    }

    /// Conditions count from the start on; what has no time begins with it.
    fn period(self, from: &mut Option<VirtualTime>, until: &mut Option<VirtualTime>, waits: bool) {
        *from = Some(match *from {
            Some(from) => self.moved(from),
            None if waits => self.start,
            None => self.start + self.step,
        });
        *until = until.map(|until| self.moved(until));
    }

    pub(super) fn input(self, input: &Spanned<InputFile>) -> Spanned<InputFile> {
        let mut moved = input.get_ref().clone();
        moved.at = self.moved(moved.at);
        Spanned::new(input.span(), moved)
    }

    pub(super) fn fault(self, fault: &Spanned<FaultFile>) -> Spanned<FaultFile> {
        let mut moved = fault.get_ref().clone();
        self.period(&mut moved.from, &mut moved.until, moved.when.is_some());
        Spanned::new(fault.span(), moved)
    }

    pub(super) fn disturbance(self, disturbance: &Spanned<DisturbanceFile>) -> Spanned<DisturbanceFile> {
        let mut moved = disturbance.get_ref().clone();
        self.period(&mut moved.from, &mut moved.until, moved.when.is_some());
        Spanned::new(disturbance.span(), moved)
    }

    pub(super) fn force(self, force: &Spanned<ForceFile>) -> Spanned<ForceFile> {
        let mut moved = force.get_ref().clone();
        self.period(&mut moved.from, &mut moved.until, moved.when.is_some());
        Spanned::new(force.span(), moved)
    }
}
