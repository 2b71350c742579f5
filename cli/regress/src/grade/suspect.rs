//! Which lines of a submission are to be looked at first.
//!
//! Three witnesses are heard, in the order in which they are believed: the statement in which a run parts from that of a
//! solution; the statements that wrote what was violated, and the decisions within which they did; and what is executed, or is
//! not, in the cases that miss something rather than in the others, by the coefficient of Ochiai.

use std::collections::{BTreeMap, BTreeSet};

use onescan_base::foreign::one_line;
use onescan_iec::diagnostic::counted;
use onescan_iec_run::Coverage;
use onescan_iec_run::coverage::{Counted, Row};

use super::line::Suspect;

/// Lines that are named: nobody looks at more.
const SUSPECTS_MAX: usize = 5;

/// A line of a file of the submission.
pub(super) type At = (String, u32);

/// What is executed in the cases that miss something, and in the others.
#[derive(Debug, Default)]
pub(super) struct Spectrum {
    others: usize,
    missing: usize,
    /// How many of them execute a line, or one of the outcomes of a decision there.
    rows: BTreeMap<(At, Option<(u32, u32)>), Executed>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Executed {
    others: usize,
    missing: usize,
}

impl Spectrum {
    /// Takes in what a case has executed.
    pub(super) fn add(&mut self, coverage: &Coverage, misses: bool) {
        *(if misses { &mut self.missing } else { &mut self.others }) += 1;
        for Row { file, line, of, count } in coverage.rows() {
            let outcome = match of {
                Counted::Unit(_) => continue,
                Counted::Line => None,
                Counted::Outcome { column, outcome } => Some((column, outcome)),
            };
            let row = self.rows.entry(((file, line), outcome)).or_default();
            *(if misses { &mut row.missing } else { &mut row.others }) += usize::from(count > 0);
        }
    }

    /// The lines that are suspected more than one that every case executes: how much, and why.
    fn suspected(&self) -> BTreeMap<&At, (f64, String)> {
        let mut found: BTreeMap<&At, (f64, String)> = BTreeMap::new();
        let base = squared_ochiai(self.missing, self.missing, self.others);
        for ((at, outcome), row) in &self.rows {
            let absent = Executed { others: self.others - row.others, missing: self.missing - row.missing };
            // What no case executes distinguishes them as little as what all execute.
            let ways = [("executed", *row), ("not executed", absent)];
            for (word, Executed { others, missing }) in ways {
                let how_much = squared_ochiai(missing, self.missing, others);
                if how_much <= base || found.get(at).is_some_and(|(known, _)| *known >= how_much) {
                    continue;
                }
                let what = if outcome.is_some() { format!("a branch is {word}") } else { word.to_owned() };
                let all = self.missing;
                let why = format!(
                    "{what} in {missing} of {all} cases with something missed, and in {others} of the other {}",
                    self.others
                );
                found.insert(at, (how_much, why));
            }
        }
        found
    }
}

/// The square of the coefficient of Ochiai, which orders as that does: of `hits` among `all` cases that miss something,
/// where `others` do the same.
fn squared_ochiai(hits: usize, all: usize, others: usize) -> f64 {
    let below = all * (hits + others);
    if below == 0 { 0.0 } else { (hits * hits) as f64 / below as f64 }
}

/// What a run parts from the solution's by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Parting {
    /// The submission executes this one where the solution executes another.
    Statement,
    /// One of the solution that is missing there.
    Missing,
}

/// What is known against the lines of a submission.
#[derive(Debug, Default)]
pub(super) struct Evidence {
    /// In the order in which the cases were compared.
    parted: Vec<(At, Parting)>,
    /// How often a line wrote something that was violated, and which signals.
    wrote: BTreeMap<At, (usize, BTreeSet<String>)>,
}

impl Evidence {
    /// A case parts from the solution's there.
    pub(super) fn parted(&mut self, at: At, how: Parting) {
        self.parted.push((at, how));
    }

    /// A statement or a decision there had to do with `signal` as it was last written before a violation.
    pub(super) fn wrote(&mut self, at: At, signal: &str) {
        let (count, signals) = self.wrote.entry(at).or_default();
        *count += 1;
        signals.insert(signal.to_owned());
    }

    /// The lines to be looked at first, the most suspected first.
    pub(super) fn suspects(&self, spectrum: &Spectrum) -> Vec<Suspect> {
        let suspected = spectrum.suspected();
        let mut found: Vec<(&At, String)> = self.partings();
        let how_much = |at: &At| suspected.get(at).map_or(0.0, |(how_much, _)| *how_much);
        let mut wrote: Vec<_> = self.wrote.iter().collect();
        wrote.sort_by(|(a, (m, _)), (b, (n, _))| how_much(b).total_cmp(&how_much(a)).then(n.cmp(m)).then(a.cmp(b)));
        found.extend(wrote.into_iter().map(|(at, (count, signals))| {
            let signals = signals.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
            (at, format!("it has to do with {signals} at {}", counted(*count, "violation")))
        }));
        let mut others: Vec<_> = suspected.iter().collect();
        others.sort_by(|(a, (m, _)), (b, (n, _))| n.total_cmp(m).then(a.cmp(b)));
        found.extend(others.into_iter().map(|(at, (_, why))| (*at, why.clone())));
        let mut seen = BTreeSet::new();
        found.retain(|(at, _)| seen.insert(*at));
        let suspect = |((file, line), why): (&At, String)| Suspect {
            file: file.clone(),
            line: *line,
            why: one_line(&why).into_owned(),
        };
        found.into_iter().take(SUSPECTS_MAX).map(suspect).collect()
    }

    /// Where runs part, what more of them do first.
    fn partings(&self) -> Vec<(&At, String)> {
        let mut first: BTreeMap<&(At, Parting), (usize, usize)> = BTreeMap::new();
        for (number, parting) in self.parted.iter().enumerate() {
            first.entry(parting).or_insert((number, 0)).1 += 1;
        }
        let mut all: Vec<_> = first.into_iter().collect();
        all.sort_by_key(|(_, (number, count))| (self.parted.len() - count, *number));
        all.into_iter()
            .map(|((at, how), (_, count))| {
                let of = format!("{count} of {} compared runs", self.parted.len());
                let missing = if *how == Parting::Missing { ", where a statement is missing" } else { "" };
                (at, format!("here the solution goes another way, in {of}{missing}"))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32) -> At {
        ("main.st".to_owned(), line)
    }

    /// Two cases that miss something and two others; lines 1 to 4.
    fn spectrum() -> Spectrum {
        let mut spectrum = Spectrum::default();
        let of = |lines: &[u32]| {
            let mut coverage = Coverage::default();
            for line in 1..=4 {
                let count = u64::from(lines.contains(&line));
                coverage.add(&Row { file: "main.st".to_owned(), line, of: Counted::Line, count });
            }
            coverage
        };
        for (lines, misses) in [(vec![1, 3], true), (vec![1, 3], true), (vec![1, 2], false), (vec![1, 2, 3], false)] {
            spectrum.add(&of(&lines), misses);
        }
        spectrum
    }

    #[test]
    fn what_tells_the_cases_from_each_other_is_suspected() {
        let spectrum = spectrum();
        let suspects = Evidence::default().suspects(&spectrum);
        // Line 2 is missing wherever something is missed; line 1 is everywhere and line 4 nowhere.
        assert_eq!(suspects.iter().map(|one| one.line).collect::<Vec<_>>(), [2, 3]);
        assert_eq!(suspects[0].why, "not executed in 2 of 2 cases with something missed, and in 0 of the other 2");
    }

    #[test]
    fn what_parts_from_the_solution_comes_first_and_what_wrote_next() {
        let mut evidence = Evidence::default();
        evidence.wrote(at(4), "Up");
        evidence.wrote(at(3), "Up");
        evidence.parted(at(9), Parting::Statement);
        evidence.parted(at(8), Parting::Missing);
        evidence.parted(at(8), Parting::Missing);
        let suspects = evidence.suspects(&spectrum());
        assert_eq!(suspects.iter().map(|one| one.line).collect::<Vec<_>>(), [8, 9, 3, 4, 2]);
        assert_eq!(
            suspects[0].why,
            "here the solution goes another way, in 2 of 3 compared runs, where a statement is missing"
        );
        assert_eq!(suspects[2].why, "it has to do with Up at 1 violation");
    }

    #[test]
    fn a_class_in_which_all_is_missed_suspects_nothing_by_it() {
        let mut spectrum = Spectrum::default();
        let mut coverage = Coverage::default();
        coverage.add(&Row { file: "main.st".to_owned(), line: 1, of: Counted::Line, count: 1 });
        spectrum.add(&coverage, true);
        assert!(Evidence::default().suspects(&spectrum).is_empty());
    }
}
