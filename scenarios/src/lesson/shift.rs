//! What a lesson does, moved from its own time, which begins with it, to that of the session.

use onescan_server::time::{TimeSpan, VirtualTime};
use toml::Spanned;

use crate::case::file::InputFile;
use crate::timed::Timed;

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

    /// The same for what has a beginning and an end.
    pub(super) fn entry<Entry: Timed + Clone>(self, entry: &Spanned<Entry>) -> Spanned<Entry> {
        let (mut moved, mut times) = (entry.get_ref().clone(), entry.get_ref().times());
        self.period(&mut times.from, &mut times.until, times.when.is_some());
        moved.set_times(times);
        Spanned::new(entry.span(), moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_with_the_start_comes_with_the_first_step_behind_it() {
        let second = TimeSpan::millis::<1000>();
        let shift = Shift { start: VirtualTime::ZERO + second, step: TimeSpan::millis::<10>() };
        let millis = |t: VirtualTime| t.as_nanos() / 1_000_000;
        assert_eq!(millis(shift.moved(VirtualTime::ZERO)), 1010);
        assert_eq!(millis(shift.moved(VirtualTime::ZERO + second)), 2000);
        let (mut from, mut until) = (None, Some(VirtualTime::ZERO + second));
        shift.period(&mut from, &mut until, false);
        assert_eq!((from.map(millis), until.map(millis)), (Some(1010), Some(2000)));
        let mut waiting = None;
        shift.period(&mut waiting, &mut None, true);
        assert_eq!(waiting.map(millis), Some(1000), "a condition counts from the start on");
    }
}
