//! The signals that formulas need, sample by sample.

use crate::expect::sample::TraceEnd;

/// Columns of samples over virtual time.
#[derive(Clone, Debug)]
pub(in crate::expect) struct Trace {
    end: TraceEnd,
    t_ns: Vec<u64>,
    columns: Vec<Vec<f64>>,
}

impl Trace {
    /// A trace of so many signals without samples.
    pub(in crate::expect) fn new(columns: usize) -> Self {
        Self { end: TraceEnd::Complete, t_ns: Vec::new(), columns: vec![Vec::new(); columns] }
    }

    /// Says how the trace ends.
    pub(in crate::expect) fn set_end(&mut self, end: TraceEnd) {
        self.end = end;
    }

    /// Takes a sample: a value for each column. Times that do not increase are not taken: the
    /// sample before them stands.
    pub(in crate::expect) fn push(&mut self, t_ns: u64, values: impl IntoIterator<Item = f64>) {
        if self.t_ns.last().is_some_and(|last| *last >= t_ns) {
            return;
        }
        self.t_ns.push(t_ns);
        let mut values = values.into_iter();
        for column in &mut self.columns {
            column.push(values.next().unwrap_or(f64::NAN));
        }
    }

    pub(super) fn is_cut(&self) -> bool {
        self.end == TraceEnd::Cut
    }

    pub(super) fn len(&self) -> usize {
        self.t_ns.len()
    }

    pub(super) fn times_ns(&self) -> &[u64] {
        &self.t_ns
    }

    pub(super) fn end_ns(&self) -> u64 {
        self.t_ns.last().copied().unwrap_or(0)
    }

    pub(super) fn column(&self, index: usize) -> &[f64] {
        self.columns.get(index).map_or(&[], Vec::as_slice)
    }

    /// The number of samples up to and with `t_ns`.
    pub(super) fn samples_until(&self, t_ns: u64) -> usize {
        self.t_ns.partition_point(|t| *t <= t_ns)
    }
}
