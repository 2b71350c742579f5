//! What a formula is worth at a sample, and blocks of samples.

use super::truth::Worth;

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceEnd {
    /// It was over: nothing comes after it.
    Complete,
    /// It was stopped or failed: something would have come.
    Cut,
}

/// Of which samples a part of a formula is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Demand {
    First,
    Every,
}

/// A sample: its number and its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sample {
    pub(super) number: u64,
    pub(super) t_ns: u64,
}

/// When it became certain that a formula is false.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Certain {
    /// The instant, which may lie between two samples: the end of a window does.
    pub(super) at_ns: u64,
    /// The number of the sample whose values held then.
    pub(super) sample: u64,
}

impl Certain {
    pub(super) fn at(sample: Sample) -> Self {
        Self { at_ns: sample.t_ns, sample: sample.number }
    }
}

/// What a formula is worth at a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged {
    pub(super) sample: Sample,
    pub(super) worth: Worth,
    /// If it is false: since when that is certain. It is never before the sample.
    pub(super) certain: Certain,
}

impl Judged {
    /// Certain at the sample itself.
    pub(super) fn here(sample: Sample, worth: Worth) -> Self {
        Self { sample, worth, certain: Certain::at(sample) }
    }

    pub(super) fn if_false(&self) -> Option<Certain> {
        self.worth.is_false().then_some(self.certain)
    }
}

/// Samples that follow each other.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The number of the first.
    first: u64,
    t_ns: Vec<u64>,
    columns: Vec<Vec<f64>>,
}

impl Block {
    pub(super) fn new(columns: usize) -> Self {
        Self { first: 0, t_ns: Vec::new(), columns: vec![Vec::new(); columns] }
    }

    /// Empties it for samples from this number on.
    pub(super) fn begin(&mut self, first: u64) {
        self.first = first;
        self.t_ns.clear();
        self.columns.iter_mut().for_each(Vec::clear);
    }

    pub(super) fn push(&mut self, t_ns: u64, values: impl IntoIterator<Item = f64>) {
        self.t_ns.push(t_ns);
        let mut values = values.into_iter();
        for column in &mut self.columns {
            column.push(values.next().unwrap_or(f64::NAN));
        }
    }

    pub(super) fn len(&self) -> usize {
        self.t_ns.len()
    }

    /// The number behind that of the last sample.
    pub(super) fn end(&self) -> u64 {
        self.first + self.t_ns.len() as u64
    }

    pub(super) fn holds(&self, number: u64) -> bool {
        (self.first..self.end()).contains(&number)
    }

    /// Each sample with its place in the columns.
    pub(super) fn samples(&self) -> impl Iterator<Item = (usize, Sample)> {
        let numbered = self.t_ns.iter().zip(self.first..);
        numbered.map(|(t_ns, number)| Sample { number, t_ns: *t_ns }).enumerate()
    }

    pub(super) fn value(&self, column: usize, place: usize) -> f64 {
        self.columns.get(column).and_then(|values| values.get(place)).copied().unwrap_or(f64::NAN)
    }

    /// The value of a sample that it holds.
    pub(super) fn value_at(&self, column: usize, number: u64) -> Option<f64> {
        let place = usize::try_from(number.checked_sub(self.first)?).ok()?;
        self.columns.get(column)?.get(place).copied()
    }
}
