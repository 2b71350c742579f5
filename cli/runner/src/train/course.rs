//! A session: attempt after attempt, as the trainer asks, or one that repeats what somebody did.

use std::collections::BTreeMap;
use std::rc::Rc;

use onescan_scenario::Scenario;
use onescan_scenario::lesson::{Book, Lesson, Start};
use onescan_server::checkpoint::Checkpoint;
use onescan_server::end::SessionEnd;
use onescan_server::layout::ImageLayout;
use onescan_server::mailbox::Mailbox;
use onescan_server::operation::OperatorInput;
use onescan_server::pacing::Pace;
use onescan_server::published::Published;
use onescan_server::time::VirtualTime;

use super::attempt::{Course, Ended, Stage, drive};
use super::config::{Served, TrainConfig};
use super::error::TrainError;
use super::examination::Examination;
use super::moments::{Moment, Moments};
use super::real_plc::RealPlcs;
use super::record::{AttemptRecord, FILE_NAME, Fork, SessionRecord, run_folder};
use super::report;
use super::starts::{Starts, driven};
use crate::error::Usage;
use crate::interrupt::Interrupt;
use crate::run::operator_inputs;
use crate::web::{
    self, AlarmLog, AtWork, Driving, Failing, Forgiven, LessonBoard, Page, Role, Training, Turn, TurnQueue,
};
use onescan_base::notice::NOTICE;

/// A lesson, and all that is needed to hold it.
pub(super) struct Classroom<'a> {
    pub(super) config: &'a TrainConfig,
    pub(super) scenario: &'a Scenario,
    pub(super) book: &'a Book,
    pub(super) lesson: &'a Lesson,
    pub(super) interrupt: &'a Interrupt,
    /// The real PLCs of the scenario.
    pub(super) real: &'a RealPlcs,
}

/// A session that was held.
pub(super) struct Held {
    pub(super) record: SessionRecord,
    pub(super) unequal: Unequal,
    /// Why it ended before anybody wanted it to.
    pub(super) broken_off: Option<TrainError>,
}

/// An attempt whose repetition is another one, in words.
pub(super) type Unequal = Vec<String>;

/// A start as attempts need it: the scenario with the lesson from there on, and the state.
struct Prepared {
    scenario: Scenario,
    checkpoint: Checkpoint,
}

/// The way on which a session is.
struct Way {
    /// The start of the attempt that is under way.
    at: Rc<Prepared>,
    /// All starts of the session.
    prepared: BTreeMap<String, Rc<Prepared>>,
    /// What operators did since the start, along the way that led here.
    line: Vec<OperatorInput>,
}

/// Where the next attempt begins.
struct Next {
    start: String,
    moment: Moment,
    moments: Moments,
    inputs: Vec<OperatorInput>,
    fork: Option<Fork>,
    /// Real PLCs, until they are there.
    driving: Option<Driving>,
}

impl Classroom<'_> {
    /// Holds the lesson, with the expert's score beside it, which soft PLCs give where `soft`, the scenario without real ones,
    /// has them.
    ///
    /// # Errors
    /// See [`TrainError`].
    pub(super) fn hold(&self, soft: &Scenario) -> Result<Held, TrainError> {
        let mut record = SessionRecord::new(self.scenario.name(), &self.lesson.name, &self.config.trainee);
        let (mut unequal, mut broken_off) = (Vec::new(), None);
        match (&self.config.served, &self.config.replay_operator) {
            (Some(served), None) => (record.attempts, broken_off) = self.live(served)?,
            (None, Some(path)) if path.join(FILE_NAME).is_file() => {
                let before = SessionRecord::read(path)?;
                record.trainee.clone_from(&before.trainee);
                for attempt in &before.attempts {
                    let inputs = before.inputs(path, attempt.number)?;
                    let again = self.repeated(&attempt.start, inputs, attempt.number)?;
                    if again.digest != attempt.digest {
                        unequal.push(format!(
                            "attempt {} has digest {}, now {}",
                            again.number, attempt.digest, again.digest
                        ));
                    }
                    record.attempts.push(again);
                }
            }
            (None, Some(path)) => {
                record.attempts = vec![self.repeated(&self.lesson.start, operator_inputs(path)?, 1)?];
            }
            (Some(_), Some(_)) | (None, None) => {
                let help = "`--web` serves it to a trainee and a trainer; `--replay-operator` takes what somebody did";
                return Err(Usage::new("a lesson is taken on a page or from a recording", Some(help.to_owned())).into());
            }
        }
        record.passed = record.last().is_some_and(|attempt| attempt.failure.is_none() && attempt.score.is_passed());
        match self.expert(soft) {
            Ok(expert) => record.expert = expert,
            // What was held has its record, whatever becomes of a real PLC then.
            Err(error) if !self.real.is_empty() => broken_off = broken_off.or(Some(error)),
            Err(error) => return Err(error),
        }
        Ok(Held { record, unequal, broken_off })
    }

    /// What the expert's recording scores: with soft PLCs where `soft` has them for all.
    fn expert(&self, soft: &Scenario) -> Result<Option<AttemptRecord>, TrainError> {
        let Some(expert) = &self.lesson.expert else { return Ok(None) };
        let inputs = operator_inputs(&self.scenario.folder().join(expert))?;
        let quiet = TrainConfig { record: None, ..self.config.clone() };
        let none = RealPlcs::default();
        let is_soft = !soft.plan().clients().iter().any(|name| soft.is_real_plc(name));
        let (scenario, real) = if is_soft { (soft, &none) } else { (self.scenario, self.real) };
        Classroom { config: &quiet, scenario, real, ..*self }.repeated(&self.lesson.start, inputs, 1).map(Some)
    }

    fn start(&self, name: &str) -> Result<&Start, TrainError> {
        let names = || self.book.starts().iter().map(|start| start.name.as_str());
        let missing = || Usage::new(format!("there is no start `{name}`"), onescan_base::did_you_mean(name, names()));
        Ok(self.book.start(name).ok_or_else(missing)?)
    }

    /// The scenario with the lesson, as it is from the start `name` on.
    fn applied(&self, name: &str) -> Result<Scenario, TrainError> {
        let start = self.start(name)?;
        let scenario = self.book.applied(self.scenario, self.lesson, start)?;
        for client in self.real.names() {
            if let Some(what) = scenario.beyond_a_real_plc(client) {
                let lesson = &self.lesson.name;
                let message = format!(
                    "lesson `{lesson}` from `{name}` asks more of client `{client}` than a real PLC does: {what}"
                );
                let help = format!("take it with the soft PLC: leave out `--gateway {client}`");
                return Err(Usage::new(message, Some(help)).into());
            }
        }
        Ok(scenario)
    }

    /// Real PLCs set out to `to`, by way of the start `name`; nothing without any.
    fn set_out(&self, name: &str, to: Option<VirtualTime>, board: &LessonBoard) -> Result<Option<Driving>, TrainError> {
        if self.real.is_empty() {
            return Ok(None);
        }
        let at = self.start(name)?.at;
        let plcs = self.real.names().map(ToString::to_string).collect();
        Ok(Some(board.drive(plcs, name, to.map_or(at, |to| to.max(at)))))
    }

    /// The start `name`; real PLCs are `driving` there.
    fn prepare(&self, name: &str, driving: Option<&Driving>) -> Result<Prepared, TrainError> {
        let (start, scenario) = (self.start(name)?, self.applied(name)?);
        let checkpoint = match driving {
            None => {
                Starts::new(self.scenario, self.book, self.config.starts.as_deref()).prepare(start, self.interrupt)?
            }
            Some(driving) => {
                let whole = self.book.prepared(self.scenario, start)?;
                driven(&whole, start, (self.real, driving), self.interrupt)?
            }
        };
        Ok(Prepared { scenario, checkpoint })
    }

    fn stage(&self, pace: Pace, mailbox: Mailbox) -> Stage {
        let image_bytes = ImageLayout::new(self.scenario.plan().signals()).size();
        Stage {
            mailbox,
            published: Published::new(image_bytes),
            failing: Failing::default(),
            alarm_log: AlarmLog::default(),
            board: LessonBoard::default(),
            pace,
            keeps: false,
        }
    }

    /// One attempt in which nobody takes part.
    fn repeated(&self, start: &str, inputs: Vec<OperatorInput>, number: u32) -> Result<AttemptRecord, TrainError> {
        let stage = self.stage(Pace::Max, Mailbox::new());
        let driving = self.set_out(start, None, &stage.board)?;
        let prepared = self.prepare(start, driving.as_ref())?;
        let next = Next { inputs, ..self.begins(start, &prepared) };
        let (record, _, _) = self.attempt(next, &prepared.scenario, &stage, number)?;
        Ok(record)
    }

    fn first_moment(&self, prepared: &Prepared) -> Moment {
        let lesson = Rc::new(self.lesson.clone());
        let examination = Examination::new(&prepared.scenario, &lesson);
        Moment { checkpoint: prepared.checkpoint.clone(), examination, at_work: AtWork::default() }
    }

    /// Drives an attempt; gives its record, its moments and what operators did.
    fn attempt(
        &self,
        next: Next,
        scenario: &Scenario,
        stage: &Stage,
        number: u32,
    ) -> Result<(AttemptRecord, Moments, Vec<OperatorInput>), TrainError> {
        let Next { start, moment, mut moments, inputs, fork, driving } = next;
        let record = self.config.record.as_deref().map(|folder| (folder, number, self.config.scenario.as_path()));
        let hold_at = fork.map(|fork| VirtualTime::from_nanos(fork.t_v_ns));
        let course =
            Course { scenario, real: self.real, from: moment, start: &start, inputs, hold_at, driving, record };
        stage.board.begin(number, scenario.until().as_nanos());
        let Ended { outcome, began, score, inputs } = drive(course, stage, &mut moments)?;
        stage.board.end(report::result(&score));
        let (end, failure) = match &outcome.end {
            SessionEnd::Completed { .. } => ("completed", None),
            SessionEnd::Stopped { .. } => ("stopped", None),
            SessionEnd::Failed(failure) => ("failed", Some(failure.to_string())),
        };
        let record = AttemptRecord {
            number,
            start,
            fork,
            begin_digest: began.to_string(),
            end: end.to_owned(),
            failure,
            steps: outcome.steps.0,
            digest: outcome.digest.map_or_else(String::new, |digest| digest.to_string()),
            score,
        };
        Ok((record, moments, inputs))
    }

    /// The lesson on two pages, for as long as the trainer wants it.
    fn live(&self, served: &Served) -> Result<(Vec<AttemptRecord>, Option<TrainError>), TrainError> {
        let mailbox = self.interrupt.mailbox();
        let stage = Stage { keeps: self.real.is_empty(), ..self.stage(served.pace, mailbox.clone()) };
        let turns = TurnQueue::new(mailbox);
        let driving = self.set_out(&self.lesson.start, None, &stage.board)?;
        // Pages say how far a real PLC is. Without one they come with the start; until then a signal ends the program at once,
        // since a start may take long to be made.
        let early = driving.as_ref().map(|_| {
            self.interrupt.watch();
            self.pages(served, &self.applied(&self.lesson.start)?, &stage, &turns)
        });
        let early = early.transpose()?;
        let at = Rc::new(self.prepare(&self.lesson.start, driving.as_ref())?);
        drop(driving);
        self.interrupt.watch();
        let prepared = BTreeMap::from([(self.lesson.start.clone(), Rc::clone(&at))]);
        let _pages = match early {
            Some(pages) => pages,
            None => self.pages(served, &at.scenario, &stage, &turns)?,
        };
        let mut next = self.begins(&self.lesson.start, &at);
        let mut way = Way { at, prepared, line: Vec::new() };
        let mut attempts: Vec<AttemptRecord> = Vec::new();
        loop {
            let number = u32::try_from(attempts.len()).unwrap_or(u32::MAX).saturating_add(1);
            let start = next.start.clone();
            let from = next.moment.steps();
            let (record, moments, heard) = self.attempt(next, &way.at.scenario, &stage, number)?;
            way.line.retain(|input| input.step < from);
            way.line.extend(heard);
            attempts.push(record);
            let Some(turn) = turns.take().filter(|_| !self.interrupt.is_raised()) else { return Ok((attempts, None)) };
            next = match self.next(turn, (start, number), moments, &mut way, &stage.board) {
                Ok(next) => next,
                Err(_) if self.interrupt.is_raised() => return Ok((attempts, None)),
                // A real PLC may be lost between two attempts: those that were held have their record.
                Err(error) if !self.real.is_empty() => return Ok((attempts, Some(error))),
                Err(error) => return Err(error),
            };
        }
    }

    /// Where the attempt after attempt `number` begins, which began at `start`.
    fn next(
        &self,
        turn: Turn,
        (start, number): (String, u32),
        mut moments: Moments,
        way: &mut Way,
        board: &LessonBoard,
    ) -> Result<Next, TrainError> {
        match turn {
            Turn::Repeat => {
                way.at = self.again(&start, way, self.set_out(&start, None, board)?.as_ref())?;
                Ok(self.begins(&start, &way.at))
            }
            Turn::Jump(name) => {
                way.at = self.again(&name, way, self.set_out(&name, None, board)?.as_ref())?;
                Ok(self.begins(&name, &way.at))
            }
            Turn::Back(t_v) => {
                let driving = self.set_out(&start, Some(t_v), board)?;
                if driving.is_some() {
                    way.at = self.again(&start, way, driving.as_ref())?;
                    moments = Moments::since(self.first_moment(&way.at));
                }
                let moment = moments.back_to(t_v);
                let t_v = t_v.max(moment.t_v());
                let inputs = way.line.iter().filter(|input| input.step >= moment.steps() && input.t_v < t_v);
                let inputs = inputs.cloned().collect();
                let fork = Fork { attempt: number, step: moment.steps().0, t_v_ns: t_v.as_nanos() };
                Ok(Next { start, moment, moments, inputs, fork: Some(fork), driving })
            }
        }
    }

    /// The start `name`: as it was prepared before, or prepared now, as it always is with real PLCs.
    fn again(&self, name: &str, way: &mut Way, driving: Option<&Driving>) -> Result<Rc<Prepared>, TrainError> {
        let before = way.prepared.get(name);
        if let Some(known) = before.filter(|_| driving.is_none()) {
            return Ok(Rc::clone(known));
        }
        let made = Rc::new(self.prepare(name, driving)?);
        if before.is_some_and(|before| before.checkpoint.digest() != made.checkpoint.digest()) {
            tracing::warn!(
                target: NOTICE,
                "`{name}` is another state than before: a real PLC has run otherwise than it did on the way there"
            );
        }
        way.prepared.insert(name.to_owned(), Rc::clone(&made));
        Ok(made)
    }

    /// An attempt from a start on.
    fn begins(&self, start: &str, prepared: &Prepared) -> Next {
        let moment = self.first_moment(prepared);
        let moments = Moments::since(moment.clone());
        Next { start: start.to_owned(), moment, moments, inputs: Vec::new(), fork: None, driving: None }
    }

    /// The trainee's page and the trainer's.
    fn pages(
        &self,
        served: &Served,
        scenario: &Scenario,
        stage: &Stage,
        turns: &TurnQueue,
    ) -> Result<[Page; 2], TrainError> {
        let pace = match served.pace {
            Pace::Max => "max".to_owned(),
            Pace::Factor(factor) => factor.to_string(),
        };
        let source = |role| web::Source {
            failing: stage.failing.clone(),
            alarm_log: stage.alarm_log.clone(),
            training: Some(Training {
                role,
                turns: turns.clone(),
                lesson: self.lesson.name.clone(),
                about: self.lesson.about.clone(),
                view: self.lesson.view.clone(),
                starts: self.book.starts().iter().map(|start| start.name.clone()).collect(),
                asked: scenario.expectations().named.iter().map(|(name, _)| name.clone()).collect(),
                mistakes: self
                    .lesson
                    .mistakes
                    .iter()
                    .map(|mistake| Forgiven { name: mistake.name.clone(), at_most: mistake.at_most })
                    .collect(),
                board: stage.board.clone(),
            }),
            ..web::Source::new(scenario, stage.published.clone(), stage.mailbox.clone(), pace.clone())
        };
        let trainee = Page::serve(served.trainee, &served.admission, source(Role::Trainee))?;
        let trainer = trainee.beside(served.trainer, &served.admission, source(Role::Trainer))?;
        if let Some(how) = Page::is_absent() {
            tracing::warn!(target: NOTICE, "no pages: {how}");
        }
        tracing::info!(target: NOTICE, "the trainee's page is at {}", trainee.url());
        tracing::info!(target: NOTICE, "the trainer's page is at {}", trainer.url());
        if let Some(folder) = &self.config.record {
            tracing::info!(target: NOTICE, "recorded in {}", run_folder(folder, 1).display());
        }
        Ok([trainee, trainer])
    }
}
