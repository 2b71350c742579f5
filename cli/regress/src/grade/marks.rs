//! The marks of a submission, from what its process said.

use std::time::Duration;

use onescan_base::foreign::one_line;
use onescan_iec_run::Coverage;
use onescan_runner::run::RunStatus;
use onescan_server::client::SourcePlace;

use super::limit::OUT_OF_MEMORY;
use super::line::{Line, Read, Refused, Suspect};
use super::submission::Submission;
use super::task::{Item, Task};
use crate::regress::limited::{Limits, Said};
use crate::regress::ran::Ran;

/// What came of a submission.
pub(super) struct Graded {
    pub(super) submission: Submission,
    pub(super) standing: Standing,
    /// What there is to say of its program, if that compiles.
    pub(super) read: Option<Read>,
    /// What came of each case, in their order; nothing of those that were not run.
    pub(super) ran: Vec<Option<Ran>>,
    /// What came of each expectation, in their order.
    pub(super) marked: Vec<Marked>,
    /// The lines that are to be looked at first.
    pub(super) suspects: Vec<Suspect>,
    pub(super) coverage: Coverage,
    /// Names of submissions that are equal to it.
    pub(super) alike: Vec<String>,
    /// How long it took.
    pub(super) wall_time: Duration,
}

/// How far a submission came.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Standing {
    /// Every case was run.
    Graded,
    /// There was no program to run.
    Refused(Refused),
    /// It was ended at a limit: what had been run before counts.
    Stopped(String),
    /// Its process failed, which is this program's fault.
    Broken(String),
}

impl Standing {
    /// As it is written in reports.
    pub(super) fn word(&self) -> &'static str {
        match self {
            Self::Graded => "graded",
            Self::Refused(_) => "refused",
            Self::Stopped(_) => "stopped",
            Self::Broken(_) => "broken",
        }
    }

    /// Why it was not graded in full.
    pub(super) fn why(&self) -> Option<&str> {
        match self {
            Self::Graded => None,
            Self::Refused(Refused { why, .. }) | Self::Stopped(why) | Self::Broken(why) => Some(why),
        }
    }
}

/// What came of an expectation.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Marked {
    pub(super) given: u32,
    /// The cases that do not show it; none if the submission was not graded.
    pub(super) missed: Vec<Missed>,
}

/// A case that does not show an expectation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Missed {
    /// The number of the case.
    pub(super) case: usize,
    pub(super) how: How,
    /// The statement that is most likely the mistake, if one is known.
    pub(super) place: Option<SourcePlace>,
    /// Statements that have to do with it, in words.
    pub(super) statements: Vec<String>,
}

/// How an expectation was missed.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum How {
    /// It was violated at this time, ns; its signals had these values.
    Violated { at_ns: u64, values: Vec<(String, f64)> },
    /// The run ended with a fault before it could be shown.
    Ended,
    /// The case was not run.
    NotRun,
}

impl Marked {
    /// True if `item`, which this is the mark of, is an expectation of safety and violated.
    pub(super) fn endangers(&self, item: &Item) -> bool {
        item.worth.is_safety && self.is_violated()
    }

    /// True if a case shows the contrary.
    pub(super) fn is_violated(&self) -> bool {
        self.missed.iter().any(|missed| matches!(missed.how, How::Violated { .. }))
    }
}

impl Graded {
    /// What a process said of a submission within its limits.
    pub(super) fn of(task: &Task, submission: Submission, said: &Said, (limits, memory_mib): (Limits, u32)) -> Self {
        let mut this = Self {
            submission,
            standing: Standing::Graded,
            read: None,
            ran: vec![None; task.cases.len()],
            marked: Vec::new(),
            suspects: Vec::new(),
            coverage: Coverage::default(),
            alike: Vec::new(),
            wall_time: Duration::ZERO,
        };
        let (mut found, mut is_done) = (Vec::new(), false);
        // The last line of a process that was ended may be a part of one.
        let lines = said
            .stdout
            .split_inclusive(|byte| *byte == b'\n')
            .filter_map(|line| serde_json::from_slice::<Line>(line).ok());
        for line in lines {
            match line {
                Line::Read(read) => this.read = Some(read),
                Line::Refused(refused) => this.standing = Standing::Refused(refused),
                Line::Ran(number, ran) => {
                    if let Some(slot) = this.ran.get_mut(number) {
                        *slot = Some(*ran);
                    }
                }
                Line::Found(one) => found.push(one),
                Line::Suspects(suspects) => this.suspects = suspects,
                Line::Covered(rows) => rows.iter().for_each(|row| this.coverage.add(&row.row(""))),
                Line::Done => is_done = true,
            }
        }
        // What was still to be explained changes no mark.
        is_done |= this.ran.iter().all(Option::is_some);
        if !is_done && this.standing == Standing::Graded {
            this.standing = ended(said, limits, memory_mib);
        }
        this.marked = task.items.iter().enumerate().map(|(number, item)| this.mark(task, number, item)).collect();
        for one in found {
            let missed = this.marked.get_mut(one.item).map(|marked| &mut marked.missed);
            if let Some(missed) = missed.into_iter().flatten().find(|missed| missed.case == one.case) {
                (missed.place, missed.statements) = (one.place, one.lines);
            }
        }
        this
    }

    /// The marks of an expectation: all, or none.
    fn mark(&self, task: &Task, number: usize, item: &Item) -> Marked {
        if let Standing::Refused(_) | Standing::Broken(_) = self.standing {
            return Marked::default();
        }
        let mut missed = Vec::new();
        for (case, of_task) in task.cases.iter().enumerate() {
            let Some(column) = of_task.judged.iter().position(|judged| *judged == number) else { continue };
            let how = self.how(case, column);
            missed.extend(how.map(|how| Missed { case, how, place: None, statements: Vec::new() }));
        }
        Marked { given: if missed.is_empty() { item.worth.marks } else { 0 }, missed }
    }

    /// How a case misses the expectation in a column of its verdicts; nothing if it shows it. What the end of a run leaves
    /// open is shown.
    fn how(&self, case: usize, column: usize) -> Option<How> {
        let Some(ran) = self.ran.get(case).and_then(Option::as_ref) else { return Some(How::NotRun) };
        let shown = ran.expectations.get(column);
        match shown.filter(|shown| shown.is_violated()) {
            Some(shown) => {
                Some(How::Violated { at_ns: shown.at_ns.unwrap_or(ran.virtual_time_ns), values: shown.values.clone() })
            }
            None if shown.is_none() || ran.status != RunStatus::Completed => Some(How::Ended),
            None => None,
        }
    }

    /// All its marks.
    pub(super) fn given(&self) -> u32 {
        self.marked.iter().map(|marked| marked.given).sum()
    }

    /// How many expectations of safety are violated.
    pub(super) fn safety_violations(&self, task: &Task) -> usize {
        let pairs = task.items.iter().zip(&self.marked);
        pairs.filter(|(item, marked)| marked.endangers(item)).count()
    }

    /// The digests of all cases, if every one has come to its end.
    pub(super) fn digests(&self) -> Option<Vec<&str>> {
        self.ran.iter().map(|ran| ran.as_ref()?.digest.as_deref()).collect()
    }

    /// What is written about the cases that ended with a fault, with where.
    pub(super) fn faults<'t>(&'t self, task: &'t Task) -> impl Iterator<Item = (&'t str, &'t Ran)> {
        let ended = |ran: &&Ran| ran.status != RunStatus::Completed;
        let pairs = task.cases.iter().zip(&self.ran);
        pairs.filter_map(move |(case, ran)| Some((case.name.as_str(), ran.as_ref().filter(ended)?)))
    }
}

/// Why a process came to no end of its own.
fn ended(said: &Said, limits: Limits, memory_mib: u32) -> Standing {
    let words = String::from_utf8_lossy(&said.stderr);
    if said.status.is_none() {
        let seconds = limits.time.as_secs_f64();
        return Standing::Stopped(format!("it was not done within {seconds} s, which is the limit (`--time-limit`)"));
    }
    if let Some(bytes_max) = limits.output_max.filter(|bytes_max| said.stdout.len() as u64 >= *bytes_max) {
        return Standing::Stopped(format!("it has more to say than {bytes_max} bytes, which is the limit"));
    }
    if words.contains(OUT_OF_MEMORY) {
        let why = format!("it needs more memory than {memory_mib} MiB, which is the limit (`--memory-limit`)");
        return Standing::Stopped(why);
    }
    let status = said.status.map_or_else(String::new, |status| status.to_string());
    let last = words.trim_end().lines().last().unwrap_or_default();
    Standing::Broken(one_line(&format!("its process ended with {status}: {last}")).into_owned())
}

/// So many percent, rounded to a tenth towards none: equal on every machine.
pub(super) fn percent(given: u32, all: u32) -> String {
    let tenths = u64::from(given) * 1000 / u64::from(all.max(1));
    format!("{}.{}", tenths / 10, tenths % 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percents_are_whole_tenths() {
        assert_eq!(
            [(0, 7), (1, 3), (2, 3), (7, 7)].map(|(given, all)| percent(given, all)),
            ["0.0", "33.3", "66.6", "100.0"]
        );
        assert_eq!(percent(0, 0), "0.0");
    }
}
