//! One attempt at a lesson: a session from a moment on, watched, measured, recorded.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use onescan_recording::{Choice, Recorder};
use onescan_scenario::compose::Member;
use onescan_scenario::expect::TraceEnd;
use onescan_scenario::{Mode, Scenario};
use onescan_server::digest::Digest;
use onescan_server::end::SessionEnd;
use onescan_server::lockstep::{Lockstep, Outcome, Reached};
use onescan_server::mailbox::Mailbox;
use onescan_server::operation::{Control, OperatorInput};
use onescan_server::pacing::Pace;
use onescan_server::published::Published;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::error::{StartError, TrainError};
use super::examination::Examiner;
use super::moments::{Moment, Moments};
use super::real_plc::{RealPlcs, STEPS_AT_A_TIME};
use super::score::Score;
use crate::error::Usage;
use crate::run::alarms;
use crate::run::config::{RecordRequest, Subject};
use crate::run::in_process::with_clients;
use crate::run::recorded::Recorded;
use crate::web::{AlarmLog, Driving, Failing, LessonBoard};

/// A lesson needs its clients here: the states of others cannot be kept.
pub(super) fn elsewhere(name: &ClientName, member: &Member) -> Usage {
    let what = if matches!(member, Member::Gateway(_)) { "a real PLC" } else { "a program of its own" };
    Usage::new(format!("client `{name}` is {what}, whose state cannot be kept: lessons need it in this process"), None)
}

/// What all attempts of a session have in common.
pub(super) struct Stage {
    /// Where wishes are left.
    pub(super) mailbox: Mailbox,
    pub(super) published: Published,
    /// What has failed, as pages show it.
    pub(super) failing: Failing,
    /// How alarms come and go, as pages show it.
    pub(super) alarm_log: AlarmLog,
    /// How the lesson goes, as pages show it.
    pub(super) board: LessonBoard,
    pub(super) pace: Pace,
    /// Whether moments are kept to go back to.
    pub(super) keeps: bool,
}

/// An attempt that is about to begin.
pub(super) struct Course<'a> {
    /// The scenario as the lesson wants it from its start on.
    pub(super) scenario: &'a Scenario,
    /// Its real PLCs, which stand where it begins.
    pub(super) real: &'a RealPlcs,
    pub(super) from: Moment,
    /// What it begins with is called so.
    pub(super) start: &'a str,
    /// Inputs of operators that are repeated.
    pub(super) inputs: Vec<OperatorInput>,
    /// Where virtual time is held, before anybody does anything new.
    pub(super) hold_at: Option<VirtualTime>,
    /// Real PLCs, until they are where virtual time is held.
    pub(super) driving: Option<Driving>,
    /// The recording: its folder, its number, the scenario's path.
    pub(super) record: Option<(&'a Path, u32, &'a Path)>,
}

/// What came of an attempt.
pub(super) struct Ended {
    pub(super) outcome: Outcome,
    pub(super) began: Digest,
    pub(super) score: Score,
    pub(super) inputs: Vec<OperatorInput>,
}

/// Drives an attempt to its end, keeping moments on the way.
///
/// # Errors
/// The session cannot be formed or go on, or its recording cannot be written.
pub(super) fn drive(course: Course<'_>, stage: &Stage, moments: &mut Moments) -> Result<Ended, TrainError> {
    let Course { scenario, real, from, start, inputs, hold_at, driving, record } = course;
    let mut lockstep = with_clients(scenario, scenario.until(), [], |name| real.client(name), elsewhere)?;
    lockstep.set_settings(scenario.session_settings());
    lockstep.set_published(stage.published.clone());
    lockstep.set_mailbox(stage.mailbox.clone());
    let examination = Rc::new(RefCell::new(from.examination.clone()));
    let heard = Rc::new(RefCell::new(Vec::new()));
    lockstep.observe(Box::new(Examiner { examination: Rc::clone(&examination), inputs: Rc::clone(&heard) }));
    stage.failing.begin_with(from.at_work);
    lockstep.observe(stage.failing.observer());
    alarms::note(&stage.alarm_log, scenario, &mut lockstep);
    // Nobody else records into the attempt's folder until it is over.
    let mut kept = None;
    if let Some((folder, number, path)) = record {
        let (recorded, recorder) = recorded(scenario, folder, number, path)?;
        kept = Some(recorded);
        lockstep.observe(Box::new(recorder));
    }
    lockstep.replay(inputs);
    let failed = |source| StartError::Checkpoint { name: start.to_owned(), source };
    lockstep.resume(&from.checkpoint).map_err(failed)?;
    if let Some(hold_at) = hold_at
        && repeat_to(&mut lockstep, hold_at, driving.as_ref())? == Reached::Boundary
    {
        stage.mailbox.control(Control::Pause);
    }
    drop(driving);
    lockstep.set_pace(stage.pace);
    let step = scenario.plan().step();
    loop {
        let t_v = lockstep.session().t_v();
        if examination.borrow().is_done() {
            lockstep.set_until(Some(t_v));
            break;
        }
        if stage.keeps && moments.is_due(t_v) && lockstep.session().end().is_none() {
            let at_work = stage.failing.now();
            let checkpoint = lockstep.checkpoint().map_err(failed)?;
            moments.keep(Moment { checkpoint, examination: examination.borrow().clone(), at_work });
        }
        if t_v >= scenario.until() || lockstep.run_to(t_v + step)? == Reached::End {
            break;
        }
    }
    let outcome = lockstep.run()?;
    drop(lockstep);
    drop(kept);
    let end = if matches!(outcome.end, SessionEnd::Completed { .. }) { TraceEnd::Complete } else { TraceEnd::Cut };
    let score = examination.borrow().clone().finish(scenario, end);
    let inputs = heard.take();
    Ok(Ended { outcome, began: from.checkpoint.digest(), score, inputs })
}

/// Repeats what operators did up to `t_v`, and says how far a real PLC is on its way there.
fn repeat_to(lockstep: &mut Lockstep, t_v: VirtualTime, driving: Option<&Driving>) -> Result<Reached, TrainError> {
    let Some(driving) = driving else { return Ok(lockstep.run_to(t_v)?) };
    let span = lockstep.session().step().times(STEPS_AT_A_TIME);
    loop {
        let now = lockstep.session().t_v();
        driving.reach(now);
        let next = span.and_then(|span| now.checked_add(span)).map_or(t_v, |next| next.min(t_v));
        let reached = lockstep.run_to(next)?;
        if reached == Reached::End || next == t_v {
            return Ok(reached);
        }
    }
}

fn recorded(scenario: &Scenario, folder: &Path, number: u32, path: &Path) -> Result<(Recorded, Recorder), TrainError> {
    let request = RecordRequest { folder: folder.to_owned(), overwrite: true, choice: Choice::default() };
    let subject = Subject { scenario: path.to_owned(), case: None, until: Some(scenario.until()) };
    Ok(Recorded::begin(&request, &subject, (Mode::Lockstep, &[]), scenario, number)?)
}
