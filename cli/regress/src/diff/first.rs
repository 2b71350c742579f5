//! The first step at which two recordings differ.
//!
//! Digests are chained: once two runs differ they differ for ever. So the first step is found by
//! halves. Runs of other steps or signals have other digests throughout, and with `--from` the
//! digests have parted already: then the signals that both have are compared at the times that both
//! have.

use std::fmt;
use std::ops::RangeInclusive;

use onescan_recording::header::HeaderSignal;
use onescan_recording::{Column, Recording, RecordingError, Row, Rows};
use onescan_report::number::counted;
use onescan_server::signal::pattern::{SignalPattern, choose};
use onescan_server::signal::{ClientName, SignalName, SignalType};
use onescan_server::time::VirtualTime;

use super::error::DiffError;
use onescan_runner::error::Usage;

/// Steps that are compared by value at once.
const WINDOW_STEPS: u64 = 4_096;
/// Steps shown before and after the first that differs.
const AROUND_STEPS: u64 = 4;
/// Most signals of which the surroundings are shown.
const AROUND_SIGNALS: usize = 4;

/// What the comparison went by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The digests of every step.
    Digests,
    /// The signals that both have, at the times that both have.
    Values,
}

/// What was compared, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// The digests of these steps: all signals, recorded or not.
    Digests { from: u64, to: u64 },
    /// The values of so many signals.
    Values { signals: u64 },
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Digests { from, to } => write!(f, "the digests of steps {from} to {to}"),
            Self::Values { signals } => write!(f, "the values of {}", counted(*signals, "signal")),
        }
    }
}

/// A signal that differs, as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    pub signal: SignalName,
    pub ty: SignalType,
    pub writer: Option<ClientName>,
    /// What it is in the first and in the second.
    pub values: [String; 2],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Divergence {
    pub at: VirtualTime,
    /// The step in each.
    pub steps: [u64; 2],
    /// How it was found.
    pub basis: Basis,
    /// The recorded signals that differ there; none if only others do, or if one ends there.
    pub differences: Vec<Difference>,
    /// The recording that ends before the other, if that is all: 0 or 1.
    pub ended: Option<usize>,
}

/// Chosen signals around the first difference: a row a time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Around {
    pub signals: Vec<SignalName>,
    /// Times with the values of each signal in both; absent where a recording has none.
    pub rows: Vec<(VirtualTime, Vec<[Option<String>; 2]>)>,
}

/// Two recordings and what of them is compared.
pub struct Comparison<'r> {
    recordings: &'r [Recording; 2],
    /// Signals that both have, and that were chosen.
    signals: Vec<SignalPattern>,
    since: VirtualTime,
    basis: Basis,
}

impl<'r> Comparison<'r> {
    /// Finds what can be compared.
    ///
    /// # Errors
    /// A pattern of no signal, recordings without a common signal or step.
    pub fn new(
        recordings: &'r [Recording; 2],
        since: VirtualTime,
        patterns: &[SignalPattern],
    ) -> Result<Self, DiffError> {
        let [a, b] = recordings;
        let in_both = |signal: &&HeaderSignal| {
            let other = b.header().signals.iter().find(|other| other.name == signal.name);
            signal.recorded && other.is_some_and(|other| other.recorded && other.ty == signal.ty)
        };
        let common: Vec<&SignalName> = a.header().signals.iter().filter(in_both).map(|signal| &signal.name).collect();
        let chosen =
            choose(patterns, common.iter().copied()).map_err(|unmatched| Usage::new(unmatched.to_string(), None))?;
        let exact = |name: &SignalName| name.as_str().parse().ok();
        let signals = chosen.into_iter().filter_map(|index| exact(common[index])).collect();
        for recording in recordings {
            if recording.steps().is_none() {
                let message = format!("{} has no complete part: no step is recorded", recording.folder().display());
                return Err(Usage::new(message, None).into());
            }
        }
        let types = |recording: &Recording| -> Vec<(SignalName, SignalType)> {
            recording.header().signals.iter().map(|signal| (signal.name.clone(), signal.ty)).collect()
        };
        let (first, second) = (a.header(), b.header());
        let chained = types(a) == types(b) && first.step == second.step && first.first_step == second.first_step;
        let whole = patterns.is_empty() && since == VirtualTime::ZERO;
        let basis = if chained && whole { Basis::Digests } else { Basis::Values };
        Ok(Self { recordings, signals, since, basis })
    }

    /// Finds the first difference, if there is one.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn first(&self) -> Result<Option<Divergence>, DiffError> {
        let found = match self.basis {
            Basis::Digests => self.by_digest()?,
            Basis::Values => self.by_value()?,
        };
        match found {
            Some(found) => Ok(Some(found)),
            None => self.by_length(),
        }
    }

    /// What an answer of "no difference" rests on.
    pub fn compared(&self) -> Compared {
        match self.basis {
            Basis::Digests => {
                let [a, b] = [self.steps(0), self.steps(1)];
                Compared::Digests { from: *a.start(), to: *a.end().min(b.end()) }
            }
            Basis::Values => Compared::Values { signals: self.signals.len() as u64 },
        }
    }

    fn steps(&self, index: usize) -> RangeInclusive<u64> {
        self.recordings[index].steps().unwrap_or(0..=0)
    }

    fn by_digest(&self) -> Result<Option<Divergence>, DiffError> {
        let [a, b] = self.recordings;
        let (mut equal, mut low) = (None, *self.steps(0).start());
        let mut high = *self.steps(0).end().min(self.steps(1).end());
        if a.digest(high)? == b.digest(high)? {
            return Ok(None);
        }
        // Invariant: all before `low` are equal, `high` differs.
        while low < high {
            let middle = low + (high - low) / 2;
            if a.digest(middle)? == b.digest(middle)? {
                equal = Some(middle);
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        tracing::debug!(?equal, first = low, "digests part");
        let rows = [self.row(0, low)?, self.row(1, low)?];
        let differences = differences(&rows);
        let at = rows[0].rows.first().map_or(VirtualTime::ZERO, |row| row.t_v);
        Ok(Some(Divergence { at, steps: [low, low], basis: Basis::Digests, differences, ended: None }))
    }

    fn row(&self, index: usize, step: u64) -> Result<Rows, RecordingError> {
        self.recordings[index].rows(&self.signals, step..=step)
    }

    fn by_value(&self) -> Result<Option<Divergence>, DiffError> {
        let Some(mut steps) = self.recordings[0].steps_between(self.since, VirtualTime::MAX)? else { return Ok(None) };
        while !steps.is_empty() {
            let window = *steps.start()..=(*steps.start() + WINDOW_STEPS - 1).min(*steps.end());
            if let Some(found) = self.in_window(window.clone())? {
                return Ok(Some(found));
            }
            steps = *window.end() + 1..=*steps.end();
        }
        Ok(None)
    }

    fn in_window(&self, window: RangeInclusive<u64>) -> Result<Option<Divergence>, DiffError> {
        let ours = self.recordings[0].rows(&self.signals, window)?;
        let (Some(first), Some(last)) = (ours.rows.first(), ours.rows.last()) else { return Ok(None) };
        let Some(steps) = self.recordings[1].steps_between(first.t_v, last.t_v)? else { return Ok(None) };
        let theirs = self.recordings[1].rows(&self.signals, steps)?;
        let mut behind = theirs.rows.iter().peekable();
        for row in &ours.rows {
            while behind.next_if(|other| other.t_v < row.t_v).is_some() {}
            let Some(other) = behind.next_if(|other| other.t_v == row.t_v) else { continue };
            if ours.columns.iter().zip(&theirs.columns).any(|(x, y)| row.bytes(x) != other.bytes(y)) {
                let one = |rows: &Rows, row: &Row| Rows { columns: rows.columns.clone(), rows: vec![row.clone()] };
                let differences = differences(&[one(&ours, row), one(&theirs, other)]);
                let (at, steps) = (row.t_v, [row.step.0, other.step.0]);
                return Ok(Some(Divergence { at, steps, basis: Basis::Values, differences, ended: None }));
            }
        }
        Ok(None)
    }

    /// Runs that are equal as far as both go are still not equal if one goes on.
    fn by_length(&self) -> Result<Option<Divergence>, DiffError> {
        let last = |index: usize| -> Result<VirtualTime, DiffError> {
            let step = *self.steps(index).end();
            let row = self.recordings[index].rows(&self.signals, step..=step)?;
            Ok(row.rows.first().map_or(VirtualTime::ZERO, |row| row.t_v))
        };
        let ends = [last(0)?, last(1)?];
        let ended = usize::from(ends[1] < ends[0]);
        // Where steps differ the shorter may just have no step at the other's last time.
        let grid = self.recordings[ended].header().step;
        let over = ends[1 - ended] - ends[ended];
        let (at, steps) = (ends[ended], [*self.steps(0).end(), *self.steps(1).end()]);
        Ok((over >= grid.as_nanos()).then_some(Divergence {
            at,
            steps,
            basis: self.basis,
            differences: Vec::new(),
            ended: Some(ended),
        }))
    }

    /// The trajectory around a difference.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn around(&self, found: &Divergence) -> Result<Around, DiffError> {
        let signals: Vec<SignalName> =
            found.differences.iter().take(AROUND_SIGNALS).map(|difference| difference.signal.clone()).collect();
        if signals.is_empty() {
            return Ok(Around::default());
        }
        let exact: Vec<SignalPattern> = signals.iter().filter_map(|name| name.as_str().parse().ok()).collect();
        let mut around = Around { signals: signals.clone(), rows: Vec::new() };
        for (index, step) in found.steps.into_iter().enumerate() {
            let rows = self.recordings[index].rows(&exact, step.saturating_sub(AROUND_STEPS)..=step + AROUND_STEPS)?;
            for row in &rows.rows {
                let at = around.rows.partition_point(|(t_v, _)| *t_v < row.t_v);
                if around.rows.get(at).is_none_or(|(t_v, _)| *t_v != row.t_v) {
                    around.rows.insert(at, (row.t_v, vec![[None, None]; signals.len()]));
                }
                for column in &rows.columns {
                    if let Some(place) = signals.iter().position(|signal| *signal == column.name) {
                        around.rows[at].1[place][index] = Some(shown(column.ty, row.bytes(column)));
                    }
                }
            }
        }
        Ok(around)
    }
}

fn differences([a, b]: &[Rows; 2]) -> Vec<Difference> {
    let (Some(ours), Some(theirs)) = (a.rows.first(), b.rows.first()) else { return Vec::new() };
    let pairs = a.columns.iter().zip(&b.columns);
    let differing = pairs.filter(|(x, y)| ours.bytes(x) != theirs.bytes(y));
    let difference = |(x, y): (&Column, &Column)| Difference {
        signal: x.name.clone(),
        ty: x.ty,
        writer: x.writer.clone(),
        values: [shown(x.ty, ours.bytes(x)), shown(y.ty, theirs.bytes(y))],
    };
    differing.map(difference).collect()
}

/// A value as an engineer reads it.
fn shown(ty: SignalType, bytes: &[u8]) -> String {
    match (ty, bytes) {
        (SignalType::BOOL, [0]) => "FALSE".to_owned(),
        (SignalType::BOOL, _) => "TRUE".to_owned(),
        _ => ty.to_text(bytes),
    }
}
