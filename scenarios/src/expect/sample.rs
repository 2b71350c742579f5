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

/// Which samples of a block an operand is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Look {
    Every,
    /// Of samples with the same values, those that a window with these ends distinguishes: the first and the last ones,
    /// and those at the ends of the window.
    Around([u64; 2]),
}

/// Samples with the same values, evenly spaced.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: Sample,
    count: u64,
    step_ns: u64,
}

impl Run {
    fn sample(&self, place: u64) -> Sample {
        Sample { number: self.first.number + place, t_ns: self.first.t_ns + place * self.step_ns }
    }

    /// The first place from `from` on that is looked at.
    fn next(&self, from: u64, look: Look) -> Option<u64> {
        if from >= self.count {
            return None;
        }
        let Look::Around(ends) = look else { return Some(from) };
        let last = self.count - 1;
        // a window keeps its newest sample apart from those before it, so the neighbours of an end count, too
        let near = ends.map(|end_ns| end_ns.saturating_sub(self.first.t_ns).checked_div(self.step_ns).unwrap_or(0));
        let near = near.into_iter().flat_map(|place| [place.saturating_sub(1), place, place.saturating_add(1)]);
        let wanted = near.chain([0, last.saturating_sub(1), last]);
        wanted.filter(|place| (from..=last).contains(place)).min()
    }

    fn places(self, look: Look) -> impl Iterator<Item = u64> {
        std::iter::successors(self.next(0, look), move |place| self.next(place + 1, look))
    }
}

/// Samples that follow each other, as runs of equal ones.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The number of the first.
    first: u64,
    /// The number behind that of the last.
    end: u64,
    runs: Vec<Run>,
    /// A value for each run.
    columns: Vec<Vec<f64>>,
}

impl Block {
    pub(super) fn new(columns: usize) -> Self {
        Self { first: 0, end: 0, runs: Vec::new(), columns: vec![Vec::new(); columns] }
    }

    /// Empties it for samples from this number on.
    pub(super) fn begin(&mut self, first: u64) {
        (self.first, self.end) = (first, first);
        self.runs.clear();
        self.columns.iter_mut().for_each(Vec::clear);
    }

    /// Takes `count` samples with the same values, at least one: the first at `t_ns`, each `step_ns` behind the one before.
    pub(super) fn push(&mut self, t_ns: u64, step_ns: u64, count: u64, values: impl IntoIterator<Item = f64>) {
        self.runs.push(Run { first: Sample { number: self.end, t_ns }, count, step_ns });
        self.end += count;
        let mut values = values.into_iter();
        for column in &mut self.columns {
            column.push(values.next().unwrap_or(f64::NAN));
        }
    }

    /// How many runs of equal samples it holds.
    pub(super) fn runs(&self) -> usize {
        self.runs.len()
    }

    /// The first sample, if it holds any.
    pub(super) fn first_sample(&self) -> Option<Sample> {
        self.runs.first().map(|run| run.first)
    }

    /// The number of the first sample.
    pub(super) fn first(&self) -> u64 {
        self.first
    }

    /// The number behind that of the last sample.
    pub(super) fn end(&self) -> u64 {
        self.end
    }

    pub(super) fn holds(&self, number: u64) -> bool {
        (self.first..self.end).contains(&number)
    }

    /// Each sample that is looked at, with its place in the columns.
    pub(super) fn samples(&self, look: Look) -> impl Iterator<Item = (usize, Sample)> {
        let runs = self.runs.iter().copied().enumerate();
        runs.flat_map(move |(place, run)| run.places(look).map(move |within| (place, run.sample(within))))
    }

    pub(super) fn value(&self, column: usize, place: usize) -> f64 {
        self.columns.get(column).and_then(|values| values.get(place)).copied().unwrap_or(f64::NAN)
    }

    /// The value of a sample that it holds.
    pub(super) fn value_at(&self, column: usize, number: u64) -> Option<f64> {
        let place = self.runs.partition_point(|run| run.first.number <= number).checked_sub(1)?;
        self.columns.get(column)?.get(place).copied().filter(|_| self.holds(number))
    }
}
