//! Text as a snapshot.

use std::iter::Peekable;
use std::str::Lines;

use onescan_server::signal::SignalName;
use onescan_server::time::{TimeSpan, VirtualTime};
use thiserror::Error;

use super::value::read;
use super::write::{decimals, instant};
use super::{DONE, Sampled, Snapshot, Track, VERSION};

/// A text that is not a snapshot.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {message}")]
pub struct SnapshotError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub message: String,
}

impl Snapshot {
    /// The snapshot that `text` is.
    ///
    /// # Errors
    /// The first line that is wrong; for a text that was cut off, the one that is missing.
    pub fn parse(text: &str) -> Result<Self, SnapshotError> {
        let mut reader = Reader { lines: text.lines().peekable(), line: 0 };
        reader.snapshot()
    }
}

struct Reader<'t> {
    lines: Peekable<Lines<'t>>,
    line: usize,
}

type Read<T> = Result<T, SnapshotError>;

impl<'t> Reader<'t> {
    fn wrong<T>(&self, message: impl Into<String>) -> Read<T> {
        Err(SnapshotError { line: self.line.max(1), message: message.into() })
    }

    fn next(&mut self) -> Read<&'t str> {
        self.line += 1;
        match self.lines.next() {
            Some(line) => Ok(line),
            None => self.wrong("the file is cut off here"),
        }
    }

    /// What stands behind a word at the beginning of the next line.
    fn field(&mut self, word: &str) -> Read<&'t str> {
        let line = self.next()?;
        match line.strip_prefix(word).and_then(|rest| rest.strip_prefix(' ')) {
            Some(rest) => Ok(rest),
            None => self.wrong(format!("this line begins with `{word} `")),
        }
    }

    fn snapshot(&mut self) -> Read<Snapshot> {
        if self.field("onescan trajectory")? != VERSION.to_string() {
            return self.wrong(format!("this program reads version {VERSION}"));
        }
        let scenario = self.field("scenario")?.to_owned();
        let case = self.field("case")?.to_owned();
        let step = self.field("step")?;
        let step = self.span(step)?;
        let end = self.field("end")?;
        let end = self.instant(end, decimals(step))?;
        self.blank()?;
        let mut signals: Vec<Track> = Vec::new();
        while self.lines.peek().is_some_and(|line| line.starts_with("signal ")) {
            let track = self.track(step, end)?;
            if signals.iter().any(|other| other.name == track.name) {
                return self.wrong(format!("`{}` is there twice", track.name));
            }
            signals.push(track);
        }
        if self.next()? != DONE {
            return self.wrong(format!("a signal or `{DONE}` is wanted here"));
        }
        if self.lines.next().is_some() {
            self.line += 1;
            return self.wrong(format!("nothing follows `{DONE}`"));
        }
        Ok(Snapshot { scenario, case, step, end, signals })
    }

    fn blank(&mut self) -> Read<()> {
        if self.next()?.is_empty() { Ok(()) } else { self.wrong("this line is empty") }
    }

    fn track(&mut self, step: TimeSpan, end: VirtualTime) -> Read<Track> {
        let mut track = self.header()?;
        let digits = decimals(step);
        while self.lines.peek().is_some_and(|line| line.starts_with(' ')) {
            let line = self.next()?;
            let Some((t_v, text)) = line.trim_start().split_once("  ") else {
                return self.wrong("an instant and a value are wanted here");
            };
            let t_v = self.instant(t_v, digits)?;
            let Some(bytes) = read(track.ty, text) else {
                return self.wrong(format!("`{text}` is not a value of {}", track.ty));
            };
            let grid = track.sampled.map_or(step, |sampled| sampled.every);
            let in_order = match track.changes.last() {
                None => t_v == VirtualTime::ZERO,
                Some((last, before)) => *last < t_v && *before != bytes,
            };
            if !in_order || !t_v.is_multiple_of(grid) || t_v > end {
                return self.wrong("only changes are written, each later than the one before, the first at 0");
            }
            track.changes.push((t_v, bytes));
        }
        if track.changes.is_empty() {
            self.line += 1;
            return self.wrong(format!("`{}` has no value", track.name));
        }
        self.blank()?;
        Ok(track)
    }

    fn header(&mut self) -> Read<Track> {
        let line = self.field("signal")?;
        let Some((name, rest)) = line.split_once(" : ").filter(|(name, _)| SignalName::new(*name).is_ok()) else {
            return self.wrong("a signal's name and type are wanted here");
        };
        let (rest, sampled) = match rest.rsplit_once(" every ") {
            Some((rest, sampled)) => (rest, Some(self.sampled(sampled)?)),
            None => (rest, None),
        };
        let (ty, unit) = match rest.split_once(" (") {
            Some((ty, unit)) => match unit.strip_suffix(')') {
                Some(unit) => (ty, Some(unit.to_owned())),
                None => return self.wrong("a unit stands in parentheses"),
            },
            None => (rest, None),
        };
        match ty.parse() {
            Ok(ty) => Ok(Track { name: name.to_owned(), ty, unit, sampled, changes: Vec::new() }),
            Err(error) => self.wrong(error.to_string()),
        }
    }

    fn sampled(&self, text: &str) -> Read<Sampled> {
        let parts = text.split_once(" of ");
        let parts =
            parts.and_then(|(every, digest)| Some((every, u64::from_str_radix(digest, 16).ok()?, digest.len())));
        match parts {
            Some((every, digest, 16)) => Ok(Sampled { every: self.span(every)?, digest }),
            _ => self.wrong("`every TIME of DIGEST` is wanted here"),
        }
    }

    fn span(&self, text: &str) -> Read<TimeSpan> {
        text.parse().or_else(|error: onescan_server::time::DurationError| self.wrong(error.to_string()))
    }

    fn instant(&self, text: &str, decimals: usize) -> Read<VirtualTime> {
        let found = format!("{text}s").parse::<VirtualTime>().ok();
        match found.filter(|t_v| instant(*t_v, decimals) == text) {
            Some(t_v) => Ok(t_v),
            None => self.wrong(format!("`{text}` is not an instant in seconds")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_server::signal::SignalType;
    use proptest::prelude::*;

    fn snapshot(step_us: u64, runs: &[Vec<(u64, i32)>]) -> Snapshot {
        let step = TimeSpan::from_nanos(step_us * 1_000).unwrap();
        let track = |(index, steps): (usize, &Vec<(u64, i32)>)| {
            let ty = if index % 2 == 0 { SignalType::DINT } else { SignalType::LREAL };
            let bytes = |value: i32| match ty {
                SignalType::LREAL => (f64::from(value) / 7.0).to_le_bytes().to_vec(),
                _ => value.to_le_bytes().to_vec(),
            };
            let mut changes = vec![(VirtualTime::ZERO, bytes(0))];
            for (gap, value) in steps {
                let (last, before) = changes.last().unwrap().clone();
                if before != bytes(*value) {
                    changes.push((last + step.times(*gap).unwrap(), bytes(*value)));
                }
            }
            let sampled = (index % 2 == 1).then_some(Sampled { every: step, digest: 77 << index });
            let unit = (index % 3 == 0).then(|| "m/s (a)".to_owned());
            Track { name: format!("s{index}"), ty, unit, sampled, changes }
        };
        let signals: Vec<Track> = runs.iter().enumerate().map(track).collect();
        let end = signals.iter().filter_map(|track| track.changes.last()).map(|(t_v, _)| *t_v).max();
        let (scenario, case) = ("a b".to_owned(), "c,x=1".to_owned());
        Snapshot { scenario, case, step, end: end.unwrap_or_default(), signals }
    }

    fn runs() -> impl Strategy<Value = Vec<Vec<(u64, i32)>>> {
        prop::collection::vec(prop::collection::vec((1_u64..500, -3_i32..3), 0..12), 0..5)
    }

    proptest! {
        #[test]
        fn what_is_written_reads_back(step_us in 1_u64..100_000, runs in runs()) {
            let snapshot = snapshot(step_us, &runs);
            prop_assert_eq!(Snapshot::parse(&snapshot.to_text()), Ok(snapshot));
        }

        #[test]
        fn a_cut_text_is_reported(runs in runs(), at in 0.0_f64..1.0) {
            let text = snapshot(10_000, &runs).to_text();
            // Without its last line break a text is still whole.
            let cut = ((text.len() - 1) as f64 * at) as usize;
            prop_assert!(Snapshot::parse(&text[..cut]).is_err());
        }

        #[test]
        fn a_garbled_text_never_panics(runs in runs(), at in 0.0_f64..1.0, with in any::<char>()) {
            let text = snapshot(10_000, &runs).to_text();
            let at = (text.len() as f64 * at) as usize;
            let garbled = format!("{}{with}{}", &text[..at], &text[(at + 1).min(text.len())..]);
            let _ = Snapshot::parse(&garbled);
        }

        #[test]
        fn no_text_makes_reading_panic(text in "(?s).{0,200}") {
            prop_assert!(Snapshot::parse(&text).is_err());
        }
    }

    #[test]
    fn a_wrong_line_is_named() {
        let text = snapshot(10_000, &[vec![(1, 2)]]).to_text();
        let wrong = |from: &str, to: &str| Snapshot::parse(&text.replace(from, to)).unwrap_err().to_string();
        assert_eq!(wrong("trajectory 1", "trajectory 2"), "line 1: this program reads version 1");
        assert_eq!(wrong("0.01  2", "0.01  x"), "line 9: `x` is not a value of DINT");
        assert_eq!(
            wrong("0.01  2", "0.01  0"),
            "line 9: only changes are written, each later than the one before, the first at 0"
        );
        assert_eq!(wrong("\ndone\n", ""), "line 10: the file is cut off here");
    }
}
