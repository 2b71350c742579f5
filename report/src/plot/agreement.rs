//! Which of the runs are the same: what the eye cannot see from lines on top of each other.

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

    /// Which runs are the same in all of several panels.
    pub(super) fn of_all(all: &[&Self], run_count: usize) -> Self {
        let same = |a: usize, b: usize| all.iter().all(|one| one.first_equal.get(a) == one.first_equal.get(b));
        let first = |run| (0..run).find(|&earlier| same(earlier, run)).unwrap_or(run);
        Self { first_equal: (0..run_count).map(first).collect() }
    }

    /// Whether no run before this one is identical with it: only such runs are drawn.
    pub(super) fn is_first(&self, run: usize) -> bool {
        self.first_equal.get(run) == Some(&run)
    }

    /// The runs that are identical with one another, in the order of their first ones.
    pub(super) fn groups(&self) -> Vec<Vec<usize>> {
        let firsts = (0..self.first_equal.len()).filter(|&run| self.is_first(run));
        let equals = |first: usize| {
            let all = self.first_equal.iter().enumerate();
            all.filter(|(_, equal)| **equal == first).map(|(run, _)| run).collect()
        };
        firsts.map(equals).collect()
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
        Agreement::of(&Panel { signal: String::new(), unit: None, shape: Shape::Line, names: Vec::new(), runs })
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
    fn equal_runs_are_a_group_if_they_are_so_in_all_panels() {
        let (one, other) = (agreement(&[1.0, 2.0, 1.0, 1.0]), agreement(&[0.0, 0.0, 0.0, 5.0]));
        assert_eq!(one.groups(), [vec![0, 2, 3], vec![1]]);
        assert_eq!(Agreement::of_all(&[&one, &other], 4).groups(), [vec![0, 2], vec![1], vec![3]]);
        assert_eq!(Agreement::of_all(&[], 2).groups(), [vec![0, 1]]);
    }
}
