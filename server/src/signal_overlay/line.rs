//! Faults on a line of bytes: single bytes are lost or changed, or none comes through.
//!
//! What a fault has done to a byte stays with that byte for as long as the line's window holds it, also when the fault
//! itself is over: a reader that comes late must not find a byte that was lost.

use onescan_base::byte_line::{ByteLine, ByteLineMut, Sent};
use serde::{Deserialize, Serialize};

use super::draws::{Draws, Onset};
use crate::operation::SignalFault;
use crate::signal::SignalType;

/// Bits of a mark beside those that are inverted.
const LOST: u16 = 0x100;

/// A fault of a line at work.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) struct LineFault {
    kind: Kind,
    /// The number of the first byte that no mark has been made for.
    next: u64,
    /// What has been done to the bytes of the window, each at its number modulo the window: bits that are inverted, or
    /// [`LOST`].
    marks: Vec<u16>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
enum Kind {
    /// Each byte is lost or not.
    Lost(Draws),
    /// The bytes of a step are lost together or not: what is drawn for the step under way.
    LostSteps(Draws, bool),
    /// A bit of a byte is inverted or not.
    Flipped(Draws),
    Silent,
    /// Nothing comes through, and a connection is no more.
    Cut,
    /// The fault is over.
    Over,
}

impl LineFault {
    /// The fault as it begins; nothing if a line cannot have it.
    pub(super) fn begin(fault: &SignalFault, onset: &Onset<'_>) -> Option<Self> {
        let kind = match fault {
            SignalFault::Lost { rate, seed } => Kind::Lost(Draws::at_rate(rate, *seed, onset)?),
            SignalFault::LostSteps { rate, seed } => {
                let mut draws = Draws::at_rate(rate, *seed, onset)?;
                let lost = draws.happens();
                Kind::LostSteps(draws, lost)
            }
            SignalFault::Flipped { rate, seed } => Kind::Flipped(Draws::at_rate(rate, *seed, onset)?),
            SignalFault::Silent => Kind::Silent,
            SignalFault::Cut => Kind::Cut,
            _ => return None,
        };
        let line = ByteLine::of(onset.ty, onset.committed)?;
        Some(Self { kind, next: line.count(), marks: vec![0; usize::from(line.window())] })
    }

    /// The fault in place of another of the same line, whose marks stay.
    pub(super) fn after(mut self, before: Self) -> Self {
        (self.next, self.marks) = (before.next, before.marks);
        self
    }

    /// Ends the fault; false if it was over.
    pub(super) fn end(&mut self) -> bool {
        !matches!(std::mem::replace(&mut self.kind, Kind::Over), Kind::Over)
    }

    /// True if it is over and nothing is left of it.
    pub(super) fn is_gone(&self) -> bool {
        matches!(self.kind, Kind::Over) && self.marks.iter().all(|mark| *mark == 0)
    }

    /// What arrives of a value.
    pub(super) fn pass(&mut self, ty: SignalType, bytes: &mut [u8], ends_step: bool) {
        let Some(mut line) = ByteLineMut::of(ty, bytes) else {
            debug_assert!(false, "{ty} is not a line, and `begin` refuses it");
            return;
        };
        let (oldest, count) = (line.line().oldest(), line.line().count());
        // A line that restarts, as after a write from outside, has no bytes that are known.
        if count < self.next {
            self.next = oldest;
        }
        for number in self.next.max(oldest)..count {
            let mark = self.mark();
            if let Some(place) = self.place(number) {
                self.marks[place] = mark;
            }
        }
        self.next = count;
        for number in oldest..count {
            let mark = self.place(number).map_or(0, |place| self.marks[place]);
            match (mark, line.line().at(number)) {
                (0, _) | (_, Sent::Lost) => {}
                (LOST, _) => line.set(number, Sent::Lost),
                (mask, Sent::Byte(byte)) => line.set(number, Sent::Byte(byte ^ mask as u8)),
            }
        }
        let link = line.line().link();
        if matches!(self.kind, Kind::Cut) && link % 2 == 1 {
            line.set_link(link.wrapping_add(1));
        }
        if let (Kind::LostSteps(draws, lost), true) = (&mut self.kind, ends_step) {
            *lost = draws.happens();
        }
    }

    fn place(&self, number: u64) -> Option<usize> {
        number.checked_rem(self.marks.len() as u64).and_then(|place| usize::try_from(place).ok())
    }

    /// What happens to the next byte.
    fn mark(&mut self) -> u16 {
        match &mut self.kind {
            Kind::Lost(draws) => LOST * u16::from(draws.happens()),
            Kind::LostSteps(_, lost) => LOST * u16::from(*lost),
            Kind::Flipped(draws) => draws.bit().map_or(0, |bit| 1 << (bit % 8)),
            Kind::Silent | Kind::Cut => LOST,
            Kind::Over => 0,
        }
    }

    /// True if a signal of this type could have it.
    pub(super) fn fits(&self, ty: SignalType) -> bool {
        matches!(ty, SignalType::Bytes(window) if self.marks.len() == usize::from(window))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{StepCount, TimeSpan};

    const TY: SignalType = SignalType::Bytes(16);

    fn begun(fault: &SignalFault, committed: &[u8]) -> LineFault {
        let step = TimeSpan::from_millis(1).expect("not zero");
        LineFault::begin(fault, &Onset { ty: TY, committed, step, steps: StepCount(0) }).expect("a fault of a line")
    }

    /// What a reader of every step finds of so many bytes, `each` a step.
    fn read(fault: &mut LineFault, sent: &mut [u8], count: u64, each: u64) -> Vec<Sent> {
        let mut seen = Vec::new();
        for _ in 0..count / each {
            let before = ByteLine::of(TY, sent).expect("a line").count();
            let mut line = ByteLineMut::of(TY, sent).expect("a line");
            (before..before + each).for_each(|number| line.put(number as u8));
            let mut arrived = sent.to_vec();
            fault.pass(TY, &mut arrived, true);
            let line = ByteLine::of(TY, &arrived).expect("a line");
            seen.extend((before..line.count()).map(|number| line.at(number)));
        }
        seen
    }

    #[test]
    fn so_many_bytes_are_lost_or_flipped_as_the_rate_says() {
        for rate in [0.0_f64, 0.01, 0.3, 1.0] {
            let text = rate.to_string();
            let faults =
                [SignalFault::Lost { rate: text.clone(), seed: 3 }, SignalFault::Flipped { rate: text, seed: 3 }];
            for fault in faults {
                let mut sent = vec![0; TY.size()];
                let seen = read(&mut begun(&fault, &sent), &mut sent, 100_000, 5);
                let wrong = (0..).zip(&seen).filter(|(number, sent)| **sent != Sent::Byte(*number as u8)).count();
                // 5 σ of a binomial
                let spread = 5.0 * (1e5 * rate * (1.0 - rate)).sqrt();
                assert!((wrong as f64 - 1e5 * rate).abs() <= spread, "{fault}: {wrong}");
                let flipped_once = |(number, sent): (u64, &Sent)| match sent {
                    Sent::Byte(byte) => (byte ^ number as u8).count_ones() <= 1,
                    Sent::Lost => matches!(fault, SignalFault::Lost { .. }),
                };
                assert!((0..).zip(&seen).all(flipped_once));
            }
        }
    }

    #[test]
    fn a_byte_that_was_lost_stays_lost_when_the_fault_is_over() {
        let mut sent = vec![0; TY.size()];
        let mut fault = begun(&SignalFault::Silent, &sent);
        assert!(read(&mut fault, &mut sent, 3, 3).iter().all(|each| *each == Sent::Lost));
        assert!(fault.end() && !fault.end());
        assert_eq!(read(&mut fault, &mut sent, 2, 2), [Sent::Byte(3), Sent::Byte(4)]);
        let mut late = sent.clone();
        fault.pass(TY, &mut late, true);
        assert_eq!(ByteLine::of(TY, &late).expect("a line").at(2), Sent::Lost);
        assert!(!fault.is_gone());
        let after = read(&mut fault, &mut sent, 15, 5);
        assert!(fault.is_gone() && after.iter().all(|each| *each != Sent::Lost));
    }

    #[test]
    fn a_cut_ends_the_connection() {
        let mut sent = vec![0; TY.size()];
        ByteLineMut::of(TY, &mut sent).expect("a line").set_link(3);
        let mut fault = begun(&SignalFault::Cut, &sent);
        fault.pass(TY, &mut sent, true);
        assert_eq!(ByteLine::of(TY, &sent).expect("a line").link(), 4);
    }

    #[test]
    fn within_a_step_nothing_is_drawn_twice() {
        let fault = SignalFault::Lost { rate: "0.5".to_owned(), seed: 1 };
        let mut sent = vec![0; TY.size()];
        let (mut once, mut twice) = (begun(&fault, &sent), begun(&fault, &sent));
        for _ in 0..100 {
            let mut line = ByteLineMut::of(TY, &mut sent).expect("a line");
            (0..3).for_each(|byte| line.put(byte));
            let (mut first, mut second, mut third) = (sent.clone(), sent.clone(), sent.clone());
            once.pass(TY, &mut first, true);
            twice.pass(TY, &mut second, false);
            twice.pass(TY, &mut third, true);
            assert!(first == second && second == third);
        }
    }
}
