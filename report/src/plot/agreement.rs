//! Which of the runs are the same: what the eye cannot tell from lines on top of each other.

use super::{Panel, Trajectory};

/// How the runs of a panel compare, bit by bit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Agreement {
    /// For each run the first one that is identical with it, possibly itself.
    first_equal: Vec<usize>,
}

impl Agreement {
    /// Compares the runs of a panel.
    pub(super) fn of(panel: &Panel) -> Self {
        let runs = &panel.runs;
        let first = |(index, run)| runs.iter().position(|other| identical(run, other)).unwrap_or(index);
        Self { first_equal: runs.iter().enumerate().map(first).collect() }
    }

    /// The number of runs after `run` that are identical with it.
    pub(super) fn equals_after(&self, run: usize) -> usize {
        let first = self.first_equal.get(run);
        self.first_equal.iter().skip(run + 1).filter(|other| Some(*other) == first).count()
    }

    /// The result in words; nothing if there are not several runs.
    pub(super) fn remark(&self) -> Option<String> {
        let count = self.first_equal.len();
        let distinct = self.first_equal.iter().enumerate().filter(|(run, first)| run == *first).count();
        match distinct {
            _ if count < 2 => None,
            1 => Some(format!("{count} identical runs")),
            all if all == count => Some(format!("{count} different runs")),
            some => Some(format!("{some} different among {count} runs")),
        }
    }
}

fn identical(a: &Trajectory, b: &Trajectory) -> bool {
    a.t_ns == b.t_ns
        && a.values.len() == b.values.len()
        && a.values.iter().zip(&b.values).all(|(a, b)| a.to_bits() == b.to_bits())
}

#[cfg(test)]
mod tests {
    use super::super::Shape;
    use super::*;

    fn agreement(values: &[f64]) -> Agreement {
        let run = |&value: &f64| Trajectory { t_ns: vec![0], values: vec![value] };
        let runs = values.iter().map(run).collect();
        Agreement::of(&Panel { signal: String::new(), unit: None, shape: Shape::Line, runs })
    }

    #[test]
    fn runs_are_compared_bit_by_bit() {
        let remark = |values: &[f64]| agreement(values).remark();
        assert_eq!(remark(&[]), None);
        assert_eq!(remark(&[1.0]), None);
        assert_eq!(remark(&[f64::NAN, f64::NAN]).as_deref(), Some("2 identical runs"));
        assert_eq!(remark(&[0.0, -0.0]).as_deref(), Some("2 different runs"));
        assert_eq!(remark(&[1.0, 2.0, 1.0]).as_deref(), Some("2 different among 3 runs"));
    }

    #[test]
    fn later_equals_are_counted() {
        let agreement = agreement(&[1.0, 2.0, 1.0, 1.0]);
        assert_eq!([0, 1, 2, 3, 4].map(|run| agreement.equals_after(run)), [2, 0, 1, 0, 0]);
    }
}
