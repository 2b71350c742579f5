//! A test of `TcUnit` as one of ours.

use onescan_iec::VirtualTime;
use onescan_iec_run::PlcFault;
use onescan_server::client::SourcePlace;
use onescan_server::time::TimeSpan;

use super::super::ran::{FailedAssert, Ran, fault_place};
use super::log::Message;
use super::memory::View;
use super::results::{self, Case, Suite, global};
use super::sources::Sources;
use super::suites;
use onescan_runner::run::RunStatus;

/// What an outcome is called that belongs to no suite.
const ALL: &str = "TcUnit";
/// What messages of the summary begin with, which the report has anyway.
const SUMMARY: &str = "| ";

/// What a run has left behind.
pub(super) struct Judge<'a> {
    pub(super) view: View<'a>,
    pub(super) sources: &'a Sources,
    pub(super) step: TimeSpan,
    /// Virtual time at its end.
    pub(super) now_ns: u64,
    pub(super) messages: &'a [Message],
}

/// Why suites have not finished.
#[derive(Clone, Copy)]
pub(super) enum Reason<'a> {
    /// The time was up.
    Late,
    /// The PLC has stopped.
    Fault(&'a PlcFault),
}

impl Judge<'_> {
    /// The tests that `TcUnit` has stored.
    pub(super) fn stored(&self) -> Vec<Ran> {
        let mut tests: Vec<Ran> = results::stored(self.view).iter().flat_map(|suite| self.suite(suite, None)).collect();
        self.note(&mut tests);
        tests
    }

    /// The tests of suites that have not all finished.
    pub(super) fn unfinished(&self, reason: Reason) -> Vec<Ran> {
        let suites = suites::all(self.view);
        let mut tests: Vec<Ran> = suites.iter().flat_map(|suite| self.suite(suite, Some(reason))).collect();
        let when = self.when(reason);
        let is_reported = |test: &Ran| test.error.as_ref().is_some_and(|error| error.ends_with(&when));
        if !tests.iter().any(is_reported) {
            let error = format!("TcUnit has stored no results {when}");
            let place = if let Reason::Fault(fault) = reason { fault_place(fault) } else { None };
            tests.push(Ran { place, ..self.failed(ALL.to_owned(), error) });
        }
        self.note(&mut tests);
        tests
    }

    fn when(&self, reason: Reason) -> String {
        let now = VirtualTime::from_nanos(self.now_ns);
        match reason {
            Reason::Late => format!("at t_v = {now}"),
            Reason::Fault(fault) => {
                let (kind, at, way) = (&fault.kind, &fault.at, fault.way());
                format!("at t_v = {now}, when the PLC stopped: {kind} in {at}{way}")
            }
        }
    }

    /// The tests of a suite; with `reason` those that have not finished are failures.
    fn suite(&self, suite: &Suite, reason: Option<Reason>) -> Vec<Ran> {
        let mut tests: Vec<Ran> = suite.cases.iter().map(|case| self.case(case, reason)).collect();
        let missing = suite.size.saturating_sub(suite.cases.len() as u64);
        if missing > 0 {
            let error = format!("{missing} of its {} tests are not reported", suite.size);
            let help = "TcUnit has room for MaxNumberOfTestsForEachTestSuite of them";
            tests.push(self.failed(suite.name.clone(), format!("{error}: {help}")));
        }
        if let Some(reason) = reason.filter(|_| suite.cases.is_empty() && !suite.is_begun) {
            tests.push(self.failed(suite.name.clone(), format!("this suite has not begun {}", self.when(reason))));
        }
        tests
    }

    fn failed(&self, name: String, error: String) -> Ran {
        let place = self.sources.place(&self.block(&name), "");
        Ran { error: Some(error), place, step_ns: self.step.as_nanos(), ..Ran::new(name, RunStatus::Failed) }
    }

    /// The block that the suite at a path is an instance of.
    fn block(&self, class: &str) -> String {
        self.view.application.variable(class).map(|variable| variable.type_name).unwrap_or_default()
    }

    fn case(&self, case: &Case, reason: Option<Reason>) -> Ran {
        let block = self.block(&case.class);
        let place = self.sources.place(&block, &case.name);
        let mut ran = Ran {
            class: Some(case.class.clone()),
            tags: self.sources.tags(&block),
            skipped: case.is_skipped,
            virtual_time_ns: (case.duration_s * 1e9).round() as u64,
            step_ns: self.step.as_nanos(),
            asserts_made: case.asserts,
            ..Ran::new(format!("{}@{}", case.class, case.name), RunStatus::Completed)
        };
        if let (Some(reason), false) = (reason, case.is_finished) {
            ran.status = RunStatus::Failed;
            ran.error = Some(format!("suite `{}` has not finished {}", case.class, self.when(reason)));
        }
        ran.asserts = self.asserts(case, place.as_ref());
        ran.place = match reason {
            Some(Reason::Fault(fault)) if self.is_running(case) => fault_place(fault).or(place),
            _ => place,
        };
        ran
    }

    /// True for the test that was called last.
    fn is_running(&self, case: &Case) -> bool {
        let name = self.view.text(&global("CurrentTestNameBeingCalled"));
        !case.is_finished && name.is_some_and(|name| name == case.name)
    }

    /// The asserts of a test that did not hold, as messages report them; else what is stored of the first.
    fn asserts(&self, case: &Case, place: Option<&SourcePlace>) -> Vec<FailedAssert> {
        let nowhere = || SourcePlace { file: case.class.clone(), line: 0, column: 0 };
        let failed = |text: String, at_ns: u64| FailedAssert {
            text,
            kind: None,
            place: place.cloned().unwrap_or_else(nowhere),
            at_ns,
            times: 1,
        };
        let reported =
            self.messages.iter().filter_map(|message| Some((reported_of(case, &message.text)?, message.at_ns)));
        let mut all: Vec<FailedAssert> = reported.map(|(text, at_ns)| failed(text.to_owned(), at_ns)).collect();
        if case.is_failed && all.is_empty() {
            let text = if case.message.is_empty() { "an assert does not hold" } else { &case.message };
            all.push(failed(text.to_owned(), self.now_ns));
        }
        if let Some(first) = all.first_mut() {
            first.kind.clone_from(&case.assertion);
        }
        all
    }

    /// Puts what `TcUnit` complained of beside the asserts to a test of the suite that it names, else to the first.
    fn note(&self, tests: &mut [Ran]) {
        let names: Vec<String> = tests.iter().map(|test| reported(&test.name)).collect();
        for Message { text, .. } in self.messages {
            if text.starts_with(SUMMARY) || names.iter().any(|name| text.starts_with(name)) {
                continue;
            }
            let of_suite = |test: &Ran| test.class.as_ref().is_some_and(|class| is_about(text, class));
            let at = tests.iter().position(of_suite).unwrap_or(0);
            if let Some(test) = tests.get_mut(at) {
                test.notes.push(text.clone());
            }
        }
    }
}

/// True for a message that names the suite, or begins with its name without its program.
fn is_about(message: &str, class: &str) -> bool {
    let last = class.rsplit('.').next().unwrap_or(class);
    message.contains(class) || message.strip_prefix(last).is_some_and(|rest| rest.starts_with(['@', '.']))
}

/// What a message about a failed assert of a test begins with.
fn reported(test: &str) -> String {
    format!("FAILED TEST '{test}'")
}

/// What a message reports of an assert of this test.
fn reported_of<'m>(case: &Case, message: &'m str) -> Option<&'m str> {
    let rest = message.strip_prefix(&reported(&format!("{}@{}", case.class, case.name)))?;
    Some(rest.strip_prefix(", ").unwrap_or(rest))
}
