//! Spells: times during which something holds.

/// How often and how long something held.
///
/// It holds from the image that shows it to the image that no longer does, or to the end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Spells {
    pub(super) count: u64,
    pub(super) total_ns: u64,
    pub(super) longest_ns: u64,
    /// When the one that has not ended yet began.
    since_ns: Option<u64>,
}

/// What an image changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// It holds now, and did not before.
    Began,
    /// It does not hold any more.
    Ended,
}

impl Spells {
    /// Whether it holds at `t_ns`.
    pub(super) fn push(&mut self, t_ns: u64, holds: bool) -> Option<Change> {
        match (self.since_ns, holds) {
            (None, true) => {
                self.since_ns = Some(t_ns);
                self.count += 1;
                Some(Change::Began)
            }
            (Some(since_ns), false) => {
                self.add(t_ns.saturating_sub(since_ns));
                self.since_ns = None;
                Some(Change::Ended)
            }
            (None, false) | (Some(_), true) => None,
        }
    }

    /// True if it holds.
    pub(super) fn is_on(&self) -> bool {
        self.since_ns.is_some()
    }

    /// The same at the end of a run, where a spell that goes on is as long as it was seen.
    pub(super) fn until(&self, end_ns: u64) -> Self {
        let mut all = self.clone();
        if let Some(since_ns) = self.since_ns {
            all.add(end_ns.saturating_sub(since_ns));
        }
        all
    }

    fn add(&mut self, length_ns: u64) {
        self.total_ns += length_ns;
        self.longest_ns = self.longest_ns.max(length_ns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spell_at_the_start_and_one_at_the_end_count() {
        let mut spells = Spells::default();
        let changes: Vec<_> = [true, true, false, true, false, false, true]
            .iter()
            .zip(0..)
            .filter_map(|(holds, t)| spells.push(t * 10, *holds))
            .collect();
        assert_eq!(changes.iter().filter(|change| **change == Change::Began).count(), 3);
        let seen = spells.until(65);
        // From 0 to 20, from 30 to 40, from 60 to the end.
        assert_eq!((seen.count, seen.total_ns, seen.longest_ns), (3, 35, 20));
    }
}
