//! Watches an attempt and measures it. Its state is plain data: an attempt that goes back to a moment goes on measuring
//! from what had been seen by then.

use std::cell::RefCell;
use std::rc::Rc;

use onescan_scenario::Scenario;
use onescan_scenario::expect::{Judge, TraceEnd, Verdict};
use onescan_scenario::lesson::file::CostKind;
use onescan_scenario::lesson::{Cost, Lesson, Malfunction, Mistake, Sought};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::OperatorInput;
use onescan_server::session::Session;

use super::score::{Expected, Handled, Made, Response, Score, Spent};
use crate::run::chosen::Chosen;
use crate::run::expectation;

/// What is known of an attempt so far.
#[derive(Clone)]
pub(super) struct Examination {
    lesson: Rc<Lesson>,
    judge: Judge,
    judged: Chosen,
    trials: Vec<Trial>,
    slips: Vec<Slips>,
    meters: Vec<Meter>,
    done: Option<Chosen>,
    is_done: bool,
    begin_ns: Option<u64>,
    now_ns: u64,
}

/// A malfunction of the attempt.
#[derive(Clone)]
struct Trial {
    /// It comes with the next image.
    is_coming: bool,
    begun_ns: Option<u64>,
    identify: Option<Search>,
    act: Option<Search>,
}

/// How often a mistake has been made.
#[derive(Clone)]
struct Slips {
    signals: Chosen,
    /// Whether its formula held in the last image; nothing before the first.
    held: Option<bool>,
    was_excused: bool,
    count: u32,
    first_ns: Option<u64>,
}

/// A formula whose first time is looked for.
#[derive(Clone)]
struct Search {
    judge: Judge,
    signals: Chosen,
}

/// A cost as it grows.
#[derive(Clone)]
struct Meter {
    signals: Chosen,
    last: Option<f64>,
    risen: f64,
    fallen: f64,
    greatest: f64,
    integral: f64,
}

impl Search {
    fn new(sought: &Sought) -> Self {
        Self { judge: sought.judge(), signals: Chosen::new(&sought.signals) }
    }

    fn response(self, begun_ns: Option<u64>, within_ns: Option<u64>, end: TraceEnd) -> Response {
        let outcome = self.judge.finish(end).into_iter().next();
        let at_ns = outcome.and_then(|outcome| match outcome.verdict {
            Verdict::Violated { at, .. } => Some(at.as_nanos()),
            Verdict::Met | Verdict::Open => None,
        });
        let after_ns = at_ns.zip(begun_ns).map(|(at_ns, begun_ns)| at_ns.saturating_sub(begun_ns));
        Response { at_ns, after_ns, within_ns }
    }
}

impl Trial {
    fn new(malfunction: &Malfunction) -> Self {
        Self {
            is_coming: false,
            begun_ns: None,
            identify: malfunction.identify.as_ref().map(Search::new),
            act: malfunction.act.as_ref().map(Search::new),
        }
    }
}

impl Slips {
    fn new(mistake: &Mistake) -> Self {
        let signals = Chosen::new(&mistake.signals);
        Self { signals, held: None, was_excused: false, count: 0, first_ns: None }
    }

    /// Takes an image. What held from the beginning on is nobody's mistake.
    fn see(&mut self, mistake: &Mistake, session: &Session, t_ns: u64) {
        let values: Vec<f64> = self.signals.numbers(session).collect();
        let holds = mistake.when.holds(&values);
        let is_excused = mistake.unless.as_ref().is_some_and(|unless| unless.holds(&values));
        if holds && self.held == Some(false) && !is_excused && !self.was_excused {
            self.count = self.count.saturating_add(1);
            self.first_ns.get_or_insert(t_ns);
        }
        (self.held, self.was_excused) = (Some(holds), is_excused);
    }
}

impl Meter {
    fn new(cost: &Cost) -> Self {
        Self {
            signals: Chosen::new(&cost.signals),
            last: None,
            risen: 0.0,
            fallen: 0.0,
            greatest: f64::NEG_INFINITY,
            integral: 0.0,
        }
    }

    fn see(&mut self, session: &Session, since_s: f64) {
        let value: f64 = self.signals.numbers(session).sum();
        let last = self.last.unwrap_or(value);
        // A signal holds its value from one image to the next.
        self.integral += last * since_s;
        self.risen += (value - last).max(0.0);
        self.fallen += (last - value).max(0.0);
        (self.last, self.greatest) = (Some(value), self.greatest.max(value));
    }

    fn value(&self, of: CostKind) -> f64 {
        match of {
            CostKind::Rise => self.risen,
            CostKind::Fall => self.fallen,
            CostKind::Greatest => self.greatest,
            CostKind::Integral => self.integral,
        }
    }
}

impl Examination {
    /// Of an attempt that has yet to begin; `scenario` is that of the lesson.
    pub(super) fn new(scenario: &Scenario, lesson: &Rc<Lesson>) -> Self {
        Self {
            lesson: Rc::clone(lesson),
            judge: expectation::judge(scenario),
            judged: Chosen::new(&scenario.expectations().signals),
            trials: lesson.malfunctions.iter().map(Trial::new).collect(),
            slips: lesson.mistakes.iter().map(Slips::new).collect(),
            meters: lesson.costs.iter().map(Meter::new).collect(),
            done: lesson.done.as_ref().map(|(_, signals)| Chosen::new(signals)),
            is_done: false,
            begin_ns: None,
            now_ns: 0,
        }
    }

    /// Whether the lesson is over.
    pub(super) fn is_done(&self) -> bool {
        self.is_done
    }

    /// Finds the signals in a session that begins or goes on.
    fn find(&mut self, session: &Session) {
        let trials = self.trials.iter_mut().flat_map(|trial| trial.identify.iter_mut().chain(&mut trial.act));
        let searched = trials.map(|search| &mut search.signals);
        let metered = self.meters.iter_mut().map(|meter| &mut meter.signals);
        let slips = self.slips.iter_mut().map(|slips| &mut slips.signals);
        for chosen in searched.chain(slips).chain(metered).chain(&mut self.done).chain([&mut self.judged]) {
            chosen.find(session);
        }
    }

    /// Takes an image.
    fn see(&mut self, session: &Session) {
        let t_ns = session.t_v().as_nanos();
        let since_s = if self.begin_ns.is_some() { t_ns.saturating_sub(self.now_ns) as f64 / 1e9 } else { 0.0 };
        self.begin_ns.get_or_insert(t_ns);
        self.now_ns = t_ns;
        self.judge.push(t_ns, self.judged.numbers(session));
        for trial in &mut self.trials {
            if std::mem::take(&mut trial.is_coming) {
                trial.begun_ns.get_or_insert(t_ns);
            }
            if trial.begun_ns.is_some() {
                for search in trial.identify.iter_mut().chain(&mut trial.act) {
                    search.judge.push(t_ns, search.signals.numbers(session));
                }
            }
        }
        for (slips, mistake) in self.slips.iter_mut().zip(&self.lesson.mistakes) {
            slips.see(mistake, session, t_ns);
        }
        self.meters.iter_mut().for_each(|meter| meter.see(session, since_s));
        if let (Some((present, _)), Some(signals)) = (&self.lesson.done, &self.done) {
            self.is_done = present.holds(&signals.numbers(session).collect::<Vec<f64>>());
        }
    }

    fn hear(&mut self, input: &OperatorInput) {
        for (trial, malfunction) in self.trials.iter_mut().zip(&self.lesson.malfunctions) {
            if trial.begun_ns.is_none() && malfunction.begins_with(&input.operation) {
                trial.is_coming = true;
            }
        }
    }

    /// What came of it. `end` says whether nothing comes after it.
    pub(super) fn finish(self, scenario: &Scenario, end: TraceEnd) -> Score {
        let handled = |(trial, malfunction): (Trial, &Malfunction)| {
            let begun_ns = trial.begun_ns;
            let within = |span: Option<onescan_server::time::TimeSpan>| span.map(onescan_base::TimeSpan::as_nanos);
            Handled {
                name: malfunction.name.clone(),
                begun_ns,
                identified: trial
                    .identify
                    .map(|search| search.response(begun_ns, within(malfunction.identify_within), end)),
                acted: trial.act.map(|search| search.response(begun_ns, within(malfunction.act_within), end)),
            }
        };
        let expected = |report: expectation::ExpectationReport| Expected {
            name: report.name,
            verdict: report.verdict,
            at_ns: report.at.map(onescan_base::VirtualTime::as_nanos),
            margin: report.margin,
            unit: report.margin_unit,
        };
        let made = |(slips, mistake): (&Slips, &Mistake)| Made {
            name: mistake.name.clone(),
            count: slips.count,
            at_most: mistake.at_most,
            first_ns: slips.first_ns,
        };
        let spent = |(meter, cost): (&Meter, &Cost)| Spent {
            name: cost.name.clone(),
            value: meter.value(cost.of),
            unit: cost.unit.clone(),
        };
        Score {
            begin_ns: self.begin_ns.unwrap_or_default(),
            end_ns: self.now_ns,
            done: self.done.is_some().then_some(self.is_done),
            malfunctions: self.trials.into_iter().zip(&self.lesson.malfunctions).map(handled).collect(),
            expectations: expectation::reports(scenario, self.judge, end).into_iter().map(expected).collect(),
            mistakes: self.slips.iter().zip(&self.lesson.mistakes).map(made).collect(),
            costs: self.meters.iter().zip(&self.lesson.costs).map(spent).collect(),
        }
    }
}

/// Shows an attempt to its examination, and keeps what operators do.
pub(super) struct Examiner {
    pub(super) examination: Rc<RefCell<Examination>>,
    pub(super) inputs: Rc<RefCell<Vec<OperatorInput>>>,
}

impl Observer for Examiner {
    fn begin(&mut self, session: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        let mut examination = self.examination.borrow_mut();
        examination.find(session);
        // An attempt that goes on from a moment has seen its image before.
        if examination.begin_ns.is_none() {
            examination.see(session);
        }
        Ok(())
    }

    fn step(&mut self, session: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        self.examination.borrow_mut().see(session);
        Ok(())
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        self.examination.borrow_mut().hear(input);
        if input.author == onescan_server::operation::Author::Operator {
            self.inputs.borrow_mut().push(input.clone());
        }
        Ok(())
    }

    fn end(&mut self, _: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
