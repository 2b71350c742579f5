//! Expectations of a run: the signals they need, and what came of them.

use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;

use onescan_report::Verdict;
use onescan_report::number::short;
use onescan_scenario::Scenario;
use onescan_scenario::expect::{self, Expectation, Judge, TraceEnd};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::end::SessionEnd;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::session::Session;
use onescan_server::signal::SignalName;
use onescan_server::time::{StepCount, VirtualTime};
use serde::Serialize;

use super::chosen::Chosen;
use crate::error::Usage;
use crate::web::VerdictBoard;

/// What came of one expectation. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExpectationReport {
    pub name: String,
    /// Whether it was met.
    pub verdict: Verdict,
    /// When it was first violated.
    #[serde(rename = "at_ns", skip_serializing_if = "Option::is_none")]
    pub at: Option<VirtualTime>,
    /// What its signals were then.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<SignalValue>,
    /// By how much it was met, negative if it was not; absent where it is infinite, as for BOOLs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// What the margin is measured in, if that is one unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin_unit: Option<String>,
}

/// A signal's value as a number; BOOLs are 0 or 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalValue {
    pub signal: String,
    /// In the signal's unit.
    pub value: f64,
}

/// Steps of a run that expectations may keep together: some 200 bytes each.
const KEPT_STEPS_MAX: u64 = 2_000_000;

/// Refuses a run that is too long for an expectation that keeps every step of it.
pub(super) fn check(scenario: &Scenario, until: VirtualTime) -> Result<(), Usage> {
    let all = &scenario.expectations().named;
    let keeping: Vec<&str> =
        all.iter().filter(|(_, each)| each.keeps_every_sample()).map(|(name, _)| name.as_str()).collect();
    let steps = until.as_nanos() / scenario.plan().step().as_nanos().max(1);
    let Some(first) = keeping.first().filter(|_| steps.saturating_mul(keeping.len() as u64) > KEPT_STEPS_MAX) else {
        return Ok(());
    };
    let message = format!(
        "expectation `{first}` keeps every step until the end of the run, which has {steps}: {KEPT_STEPS_MAX} may be kept, by \
         all expectations together"
    );
    let help = "within another operator, give `always`, `eventually` or `until` a window, as in `always (a implies within \
                10s b)`, or run less (docs/expectations.md)";
    Err(Usage::new(message, Some(help.to_owned())))
}

impl ExpectationReport {
    /// True if the run did not show it.
    pub fn is_violated(&self) -> bool {
        self.verdict == Verdict::Violated
    }

    pub(super) fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write!(out, "  expectation `{}` ", self.name)?;
        write!(out, "{}", self.verdict.coloured())?;
        match (self.verdict, self.at) {
            (Verdict::Violated, Some(at)) => write!(out, " at {at}")?,
            (Verdict::Open, _) => write!(out, " at the end of the run")?,
            _ => {}
        }
        for (index, SignalValue { signal, value }) in self.values.iter().enumerate() {
            write!(out, "{} {signal} = {value}", if index == 0 { ":" } else { "," })?;
        }
        let unit = self.margin_unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
        match self.margin {
            Some(margin) => writeln!(out, " (margin {}{unit})", short(margin)),
            None => writeln!(out),
        }
    }
}

/// What came of all expectations.
pub(crate) fn reports(scenario: &Scenario, judge: Judge, end: TraceEnd) -> Vec<ExpectationReport> {
    let report = |((name, expectation), outcome): (&(String, Expectation), expect::Outcome)| {
        // A margin of -0, which negation gives, reads as if something were missing.
        let margin = outcome.margin.greatest + 0.0;
        let exact = margin.is_finite() && margin == outcome.margin.least;
        let (verdict, at, values) = match outcome.verdict {
            expect::Verdict::Met => (Verdict::Met, None, Vec::new()),
            expect::Verdict::Open => (Verdict::Open, None, Vec::new()),
            expect::Verdict::Violated { at, values } => (Verdict::Violated, Some(at), values),
        };
        let values = values.into_iter().map(|(signal, value)| SignalValue { signal, value }).collect();
        let margin_unit = expectation.unit().filter(|_| exact).map(str::to_owned);
        ExpectationReport { name: name.clone(), verdict, at, values, margin: exact.then_some(margin), margin_unit }
    };
    scenario.expectations().named.iter().zip(judge.finish(end)).map(report).collect()
}

/// A judge of a run that has not begun.
pub(crate) fn judge(scenario: &Scenario) -> Judge {
    let expected = scenario.expectations();
    Judge::new(expected.named.iter().map(|(_, expectation)| expectation.clone()), expected.signals.len())
}

/// Leaves copies of the judge of a run for those who watch it, behind the [`Witness`] that shows the run to it.
pub(super) struct Copyist {
    judge: Rc<RefCell<Judge>>,
    verdict_board: VerdictBoard,
}

impl Copyist {
    pub(super) fn new(judge: Rc<RefCell<Judge>>, verdict_board: VerdictBoard) -> Self {
        Self { judge, verdict_board }
    }

    fn leave(&self, session: &Session, end: TraceEnd) {
        self.verdict_board.leave(session.t_v(), self.judge.borrow().clone(), end);
    }
}

impl Observer for Copyist {
    fn begin(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.leave(session, TraceEnd::Cut);
        Ok(())
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        if self.verdict_board.is_wanted() {
            self.leave(session, TraceEnd::Cut);
        }
        Ok(())
    }

    fn end(&mut self, session: &Session) -> Result<(), RecordError> {
        let is_complete = matches!(session.end(), Some(SessionEnd::Completed { .. }));
        self.leave(session, if is_complete { TraceEnd::Complete } else { TraceEnd::Cut });
        Ok(())
    }
}

/// Shows a run to the judge of its expectations.
pub(super) struct Witness {
    judge: Rc<RefCell<Judge>>,
    chosen: Chosen,
    /// The step that it has shown last.
    shown: StepCount,
}

impl Witness {
    pub(super) fn new(judge: Rc<RefCell<Judge>>, names: &[SignalName]) -> Self {
        Self { judge, chosen: Chosen::new(names), shown: StepCount(0) }
    }

    /// Shows so many steps with the same values, of which the session has just come to the last.
    fn show(&mut self, session: &Session, steps: u64) {
        let (t_ns, step_ns) = (session.t_v().as_nanos(), session.step().as_nanos());
        let first_ns = t_ns.saturating_sub(step_ns.saturating_mul(steps.saturating_sub(1)));
        self.judge.borrow_mut().push_run(first_ns, step_ns, steps, self.chosen.numbers(session));
        self.shown = session.cycle().steps();
    }
}

impl Observer for Witness {
    fn begin(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.chosen.find(session);
        self.judge.borrow_mut().begin();
        self.show(session, 1);
        Ok(())
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        // the steps that it was not shown are those of a rest, with the image that they left
        let steps = session.cycle().steps().0.saturating_sub(self.shown.0);
        self.show(session, steps.max(1));
        Ok(())
    }

    fn wants_idle_steps(&self) -> bool {
        false
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
