//! Which statements have to do with a violated expectation: those that wrote its signals last, and the one in which the run
//! parts from that of a solution, where the program is like one.

use std::collections::BTreeSet;
use std::sync::PoisonError;

use onescan_base::foreign::one_line;
use onescan_iec::Input;
use onescan_runner::error::Usage;
use onescan_runner::run::judged::Judged;
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::SourcePlace;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;
use onescan_soft_plc::Written;
use similar::{Algorithm, DiffOp, capture_diff_slices};

use super::line::{Found, Suspect};
use super::structure;
use super::suspect::{At, Evidence, Parting, Spectrum};
use super::task::Task;
use crate::regress::cause;
use crate::regress::ran::{Ran, Shown};
use crate::why::report::Runs;
use crate::why::{self, Place, Side};

/// Cases of a submission that are held against a solution: what breaks more breaks them for the same reason as a rule.
const COMPARED_MAX: usize = 2;
/// Cases of which it is looked who wrote the signals.
const TRACED_MAX: usize = 6;
/// A program that is less like a solution than this, %, was written another way: statements of the two cannot be paired.
const LIKENESS_PCT: usize = 50;

/// Finds the reasons of a submission.
pub(super) struct Reasons<'a> {
    task: &'a Task,
    /// The task with the submission.
    scenario: &'a Scenario,
    /// The task with the solution that is most like it.
    solution: Option<Scenario>,
    compared: usize,
    traced: usize,
    evidence: Evidence,
}

/// An expectation that a case violates, by its number, and when.
struct Violated<'a> {
    item: usize,
    at: VirtualTime,
    shown: &'a Shown,
}

impl<'a> Reasons<'a> {
    pub(super) fn new(task: &'a Task, scenario: &'a Scenario) -> Self {
        let (solution, evidence) = (solution(task, scenario), Evidence::default());
        Self { task, scenario, solution, compared: 0, traced: 0, evidence }
    }

    /// The lines to be looked at first, by all that has been found.
    pub(super) fn suspects(&self, spectrum: &Spectrum) -> Vec<Suspect> {
        self.evidence.suspects(spectrum)
    }

    /// The reasons of what a case violates, in the order of time.
    pub(super) fn of_case(&mut self, number: usize, ran: &Ran) -> Vec<Found> {
        let case = &self.task.cases[number];
        let pairs = case.judged.iter().zip(&ran.expectations).filter(|(_, shown)| shown.is_violated());
        let violated = pairs.filter_map(|(item, shown)| {
            Some(Violated { item: *item, at: VirtualTime::from_nanos(shown.at_ns?), shown })
        });
        let mut violated: Vec<Violated<'_>> = violated.collect();
        violated.sort_by_key(|one| (one.at, one.item));
        if violated.is_empty() || self.traced == TRACED_MAX {
            return Vec::new();
        }
        self.traced += 1;
        // A case that cannot be applied has not run.
        let Ok(applied) = self.task.applied(self.scenario, case) else { return Vec::new() };
        let mut found = self.written(number, &applied.unobserved(), &violated);
        if let Some(parting) = self.parting(number, &applied, ran, &violated) {
            match found.iter_mut().find(|one| one.item == parting.item) {
                Some(known) => {
                    known.place = parting.place.or(known.place.take());
                    known.lines.splice(0..0, parting.lines);
                }
                None => found.push(parting),
            }
        }
        found
    }

    /// The statements that wrote the signals of expectations last before each was violated: the case is run once more, up
    /// to the last of them.
    fn written(&mut self, number: usize, applied: &Scenario, violated: &[Violated<'_>]) -> Vec<Found> {
        let mut traced = applied.clone();
        let sink = traced.trace(self.own_signals());
        let elsewhere = |name: &ClientName, _: &Member| Usage::new(format!("`{name}` is not in this process"), None);
        let Ok(mut session) = Judged::form(&traced, applied.until(), [], elsewhere) else { return Vec::new() };
        if session.begin().is_err() {
            return Vec::new();
        }
        let mut found = Vec::new();
        for Violated { item, at, shown } in violated {
            // A run that ends before has nothing more to show.
            while session.session().t_v() < *at && session.step().unwrap_or(false) {}
            let sink = sink.lock().unwrap_or_else(PoisonError::into_inner);
            let names = shown.values.iter().filter_map(|(name, _)| SignalName::new(name.clone()).ok());
            let writers = names.filter_map(|name| sink.writers.get_key_value(&name));
            let writers: Vec<(&SignalName, &Written)> = writers.collect();
            for (signal, written) in &writers {
                let site = &written.site.at;
                self.evidence.wrote((site.file.clone(), site.line), signal.as_str());
                if let Some(way) = written.within.first() {
                    self.evidence.wrote((way.file.clone(), way.line), signal.as_str());
                }
            }
            let place = writers.first().map(|(_, written)| place(written));
            let lines = writers.iter().map(|(signal, written)| line(signal, written)).collect();
            if place.is_some() {
                found.push(Found { case: number, item: *item, place, lines });
            }
        }
        found
    }

    /// The signals that the program writes.
    fn own_signals(&self) -> BTreeSet<SignalName> {
        let signals = self.scenario.plan().signals().iter();
        let own = signals.filter(|signal| signal.writer.as_ref() == Some(&self.task.client));
        own.map(|signal| signal.name.clone()).collect()
    }

    /// The line of the submission at which a statement of the solution is missing; nothing if their sources are laid out
    /// otherwise than as text.
    fn missing_at(&self, Place { file, line, text, .. }: &Place) -> Option<At> {
        let programs =
            [self.solution.as_ref()?, self.scenario].map(|scenario| scenario.program(&self.task.client).ok());
        let [Some(theirs), Some(ours)] = &programs else { return None };
        let theirs = theirs.iter().find(|input| input.file().name() == file).map(lines_of)?;
        let at = (*line as usize).checked_sub(1)?;
        // Of a drawing, lines are those of its elements, and not of a text.
        if !theirs.get(at)?.contains(text.split_whitespace().next()?) {
            return None;
        }
        // With several files, it is missing in the one that is most like the solution's.
        let alike = |input: &&Input| lines_of(input).iter().filter(|line| theirs.contains(line)).count();
        let own = ours.iter().max_by_key(alike)?;
        let line = line_for(at, &theirs, &lines_of(own))?;
        Some((own.file().name().to_owned(), u32::try_from(line).ok()? + 1))
    }

    /// Where the run parts from the solution's, for the first thing that is violated.
    fn parting(&mut self, number: usize, applied: &Scenario, ran: &Ran, violated: &[Violated<'_>]) -> Option<Found> {
        let solution = self.solution.as_ref()?;
        if self.compared == COMPARED_MAX {
            return None;
        }
        self.compared += 1;
        let first = violated.first()?;
        let right = self.task.applied(solution, &self.task.cases[number]).ok()?;
        let (right, wrong) = (right.unobserved(), applied.unobserved());
        let sides = [&right, &wrong].map(|scenario| Side { scenario, inputs: Vec::new() });
        let names = first.shown.values.iter().filter_map(|(name, _)| SignalName::new(name.clone()).ok());
        let signals: Vec<SignalName> = names.collect();
        let end = VirtualTime::from_nanos(ran.virtual_time_ns);
        let until = first.at.min(end);
        let why = why::explain_violation(sides.each_ref(), &signals, until, end).ok().flatten()?;
        let parted = why.root().and_then(|root| match &root.at {
            [_, Some(own)] => Some(((own.file.clone(), own.line), Parting::Statement)),
            [Some(of_solution), None] => Some((self.missing_at(of_solution)?, Parting::Missing)),
            [None, None] => None,
        });
        let place = parted.as_ref().map(|((file, line), _)| SourcePlace { file: file.clone(), line: *line, column: 1 });
        if let Some((at, how)) = parted {
            self.evidence.parted(at, how);
        }
        let shown = cause::Lines::of(&why, &Runs::named(["the solution", "the submission"]));
        let lines = shown.shown.iter().map(|line| one_line(line).into_owned()).collect();
        Some(Found { case: number, item: first.item, place, lines })
    }
}

/// The line of one text at which a line of another, counted from 0, would stand, by what stands around it.
fn line_for(at: usize, theirs: &[&str], ours: &[&str]) -> Option<usize> {
    let operations = capture_diff_slices(Algorithm::Myers, theirs, ours);
    let around = operations.iter().find(|operation| operation.old_range().contains(&at))?;
    let (old, new) = (around.old_range(), around.new_range());
    let within = if let DiffOp::Delete { .. } = around { 0 } else { at - old.start };
    Some((new.start + within.min(new.len().saturating_sub(1))).min(ours.len().checked_sub(1)?))
}

/// The lines of a source without their indents.
fn lines_of(input: &Input) -> Vec<&str> {
    input.file().text().lines().map(str::trim).collect()
}

/// The task with the solution that the program is most like; nothing if it is like none.
fn solution<'a>(task: &'a Task, scenario: &Scenario) -> Option<Scenario> {
    let own = scenario.program(&task.client).ok()?;
    let alike = |program: &'a Vec<Input>| Some((structure::likeness_pct(program, &own)?, program));
    let all = task.solutions.iter().filter_map(alike).filter(|(pct, _)| *pct >= LIKENESS_PCT);
    // The first of those that are equally like it.
    let best = all.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map(|(_, program)| task.scenario.clone().with_program(&task.client, program.clone()))
}

fn place(written: &Written) -> SourcePlace {
    let at = &written.site.at;
    SourcePlace { file: at.file.clone(), line: at.line, column: at.column }
}

/// A statement that wrote a signal, and the decision that led to it.
fn line(signal: &SignalName, written: &Written) -> String {
    let site = &written.site;
    let within = written.within.first().map(|way| format!(", within {way}")).unwrap_or_default();
    let (file, at) = (&site.at.file, site.at.line);
    let text = format!("{signal} was written at {} by {file}:{at}: {}{within}", written.t_v, site.statement);
    one_line(&text).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_statement_is_missing_where_its_neighbours_stand() {
        let solution = ["a;", "b;", "c;", "d;"];
        assert_eq!(line_for(1, &solution, &["(* mine *)", "a;", "c;", "d;"]), Some(2));
        assert_eq!(line_for(3, &solution, &["a;", "b;", "c;"]), Some(2), "the last line there is");
        assert_eq!(line_for(1, &solution, &["a;", "x;", "c;", "d;"]), Some(1));
        assert_eq!((line_for(9, &solution, &solution), line_for(0, &solution, &[])), (None, None));
    }
}
