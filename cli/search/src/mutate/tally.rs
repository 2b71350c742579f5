//! How many mistakes of which kind were noticed.

use std::collections::BTreeMap;

use onescan_iec_project::mutate::MutantKind;
use serde::Serialize;

use super::Judged;
use super::trial::Verdict;

/// Numbers of mistakes by what came of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(super) struct Counts {
    pub(super) killed: usize,
    pub(super) survived: usize,
    pub(super) unreached: usize,
    pub(super) equivalent: usize,
    pub(super) refused: usize,
}

impl Counts {
    fn add(&mut self, verdict: &Verdict) {
        let slot = match verdict {
            Verdict::Killed { .. } => &mut self.killed,
            Verdict::Survived { .. } => &mut self.survived,
            Verdict::Unreached => &mut self.unreached,
            Verdict::Equivalent => &mut self.equivalent,
            Verdict::Refused { .. } => &mut self.refused,
        };
        *slot += 1;
    }

    /// Those that are programs.
    pub(super) fn mutants(&self) -> usize {
        self.killed + self.survived + self.unreached + self.equivalent
    }

    /// How many of those that can be distinguished from the program were noticed, %.
    pub(super) fn score_pct(&self) -> f64 {
        let distinct = self.killed + self.survived + self.unreached;
        if distinct == 0 { 100.0 } else { 100.0 * self.killed as f64 / distinct as f64 }
    }
}

/// All kinds.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally(BTreeMap<MutantKind, Counts>);

impl Tally {
    pub(super) fn of(judged: &[Judged]) -> Self {
        let mut tally = Self::default();
        for one in judged {
            tally.0.entry(one.mistake.mutant.kind).or_default().add(&one.verdict);
        }
        tally
    }

    /// Kind by kind.
    pub(super) fn kinds(&self) -> impl Iterator<Item = (MutantKind, &Counts)> {
        self.0.iter().map(|(kind, counts)| (*kind, counts))
    }

    /// All together.
    pub(super) fn all(&self) -> Counts {
        self.0.values().fold(Counts::default(), |all, one| Counts {
            killed: all.killed + one.killed,
            survived: all.survived + one.survived,
            unreached: all.unreached + one.unreached,
            equivalent: all.equivalent + one.equivalent,
            refused: all.refused + one.refused,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_distinguished_does_not_count() {
        let counts = Counts { killed: 19, survived: 1, unreached: 0, equivalent: 7, refused: 3 };
        assert_eq!((counts.mutants(), counts.score_pct()), (27, 95.0));
        assert_eq!(Counts { unreached: 1, ..counts }.score_pct().round(), 90.0);
        assert_eq!(Counts { equivalent: 2, ..Counts::default() }.score_pct(), 100.0);
    }
}
