//! The alarms of a session as it runs, for those who watch it.

use super::annunciator::{Annunciator, Passage};
use super::measures::Measures;
use super::numbers::Numbers;

/// Says which alarms come and go, image by image.
#[derive(Clone, Debug)]
pub struct Bell {
    numbers: Numbers,
    annunciator: Annunciator,
}

impl Bell {
    /// Of a run that has not begun.
    pub fn new(measures: &Measures) -> Self {
        Self { numbers: Numbers::new(&measures.signals), annunciator: Annunciator::new(&measures.alarms) }
    }

    /// Takes the image of `t_ns`: the bytes of each signal, in the order of [`Measures::signals`]. Times do not fall.
    pub fn push<'b>(&mut self, t_ns: u64, bytes: impl Iterator<Item = &'b [u8]>) -> Vec<Passage> {
        if self.numbers.take(bytes) {
            self.annunciator.push(t_ns, self.numbers.values())
        } else {
            self.annunciator.pass(t_ns)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::offline::measures;

    const LATE: &str = r#"
        [report]
        [[report.alarm]]
        name = "late"
        when = "A"
        priority = "high"
        on_delay = "30ms"
        off_delay = "20ms"
        [[report.alarm]]
        name = "at once"
        when = "A"
    "#;

    /// The passages of `A` as it is drawn, step by step; all other steps are left out.
    fn passages(drawn: &str) -> Vec<(usize, u64, bool)> {
        let mut bell = Bell::new(&measures(LATE).expect("measures"));
        let mut seen = Vec::new();
        for (step, letter) in drawn.chars().enumerate().filter(|(_, letter)| *letter != '.') {
            let byte = [u8::from(letter == 'a')];
            let came = bell.push(step as u64 * 10_000_000, std::iter::once(&byte[..]));
            seen.extend(came.iter().map(|passage| (passage.alarm, passage.t_ns / 1_000_000, passage.has_come)));
        }
        seen
    }

    #[test]
    fn an_alarm_comes_after_its_on_delay_and_goes_after_its_off_delay() {
        assert_eq!(passages("_aaaaa___"), [(1, 10, true), (0, 40, true), (1, 60, false), (0, 80, false)]);
    }

    #[test]
    fn what_does_not_last_is_no_alarm() {
        assert_eq!(passages("aaa__a"), [(1, 0, true), (1, 30, false), (1, 50, true)]);
        // For less than the off-delay it is not gone.
        assert_eq!(passages("aaaa_a"), [(1, 0, true), (0, 30, true), (1, 40, false), (1, 50, true)]);
    }

    #[test]
    fn an_image_that_comes_late_reports_what_was_due_before_it() {
        assert_eq!(passages("a......._"), [(1, 0, true), (0, 30, true), (1, 80, false)]);
    }
}
