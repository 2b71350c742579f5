//! One way in which the session may go, from its start or forked from another.

use std::rc::Rc;

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_scenario::expect::{Judge, TraceEnd};
use onescan_server::checkpoint::Checkpoint;
use onescan_server::digest::Digest;
use onescan_server::end::SessionEnd;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::session::Session;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;

use super::ExploreError;
use super::deviation::Deviation;
use crate::error::Usage;
use crate::run::RunError;
use crate::run::chosen::Chosen;
use crate::run::expectation::{self, ExpectationReport};
use crate::run::in_process::in_process;

/// An edge, and the boundary before the step that brings it.
#[derive(Clone)]
pub(super) struct Fork {
    /// Number of the signal among those that may be late.
    pub(super) signal: usize,
    pub(super) rises: bool,
    /// When the edge arrives.
    pub(super) edge: VirtualTime,
    checkpoint: Rc<Checkpoint>,
    /// What the expectations have seen until the boundary.
    judge: Rc<Judge>,
}

/// What came of a way.
pub(super) struct Path {
    pub(super) digest: Option<Digest>,
    /// Expectations that did not hold.
    pub(super) violated: Vec<ExpectationReport>,
    /// How a client failed, if one did.
    pub(super) failure: Option<String>,
    /// Its edges in their order, if they were asked for.
    pub(super) forks: Vec<Fork>,
}

/// What all ways of an exploration have in common.
pub(super) struct Ground<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) until: VirtualTime,
    signals: Vec<SignalName>,
}

impl<'a> Ground<'a> {
    pub(super) fn new(scenario: &'a Scenario, until: VirtualTime) -> Self {
        let signals = scenario.late().iter().map(|late| late.signal.clone()).collect();
        Self { scenario, until, signals }
    }

    /// Goes the way with these deviations, from the fork of the last of them if it has one.
    ///
    /// # Errors
    /// The session cannot be formed, saved or taken up.
    pub(super) fn go(
        &self,
        from: Option<&Fork>,
        deviations: &[Deviation],
        keeps_forks: bool,
    ) -> Result<Path, ExploreError> {
        let mut lockstep = self.form(deviations)?;
        let mut judge = match from {
            Some(fork) => {
                lockstep.resume(&fork.checkpoint).map_err(RunError::Save)?;
                Judge::clone(&fork.judge)
            }
            None => expectation::judge(self.scenario),
        };
        let (mut edges, mut columns) = (Chosen::new(&self.signals), Chosen::new(&self.scenario.expectations().signals));
        edges.find(lockstep.session());
        columns.find(lockstep.session());
        let mut forks = Vec::new();
        if from.is_none() {
            lockstep.run_to(VirtualTime::ZERO)?;
            see(&mut judge, &columns, lockstep.session());
        }
        let mut last: Vec<bool> = levels(&edges, lockstep.session());
        loop {
            // Before the step, because what it brings is to be late.
            let before = keeps_forks.then(|| lockstep.checkpoint()).transpose();
            let before = match before {
                Ok(before) => before.map(Rc::new),
                // A session that is over is left to tell how.
                Err(_) if lockstep.session().end().is_some() => None,
                Err(error) => return Err(RunError::Save(error).into()),
            };
            let judged = keeps_forks.then(|| Rc::new(judge.clone()));
            let next = lockstep.session().t_v() + lockstep.session().step();
            if lockstep.session().t_v() >= self.until || lockstep.run_to(next)? == Reached::End {
                break;
            }
            see(&mut judge, &columns, lockstep.session());
            let now = levels(&edges, lockstep.session());
            if let (Some(checkpoint), Some(judge)) = (before, judged) {
                let changed = now.iter().zip(&last).enumerate().filter(|(_, (now, last))| now != last);
                forks.extend(changed.map(|(signal, (now, _))| Fork {
                    signal,
                    rises: *now,
                    edge: lockstep.session().t_v(),
                    checkpoint: Rc::clone(&checkpoint),
                    judge: Rc::clone(&judge),
                }));
            }
            last = now;
        }
        let outcome = lockstep.run()?;
        let failure = if let SessionEnd::Failed(failure) = &outcome.end { Some(failure.to_string()) } else { None };
        let end = if failure.is_none() { TraceEnd::Complete } else { TraceEnd::Cut };
        let mut reports = expectation::reports(self.scenario, judge, end);
        reports.retain(ExpectationReport::is_violated);
        Ok(Path { digest: outcome.digest, violated: reports, failure, forks })
    }

    fn form(&self, deviations: &[Deviation]) -> Result<Lockstep, RunError> {
        let elsewhere = |name: &ClientName, _: &Member| {
            let message = format!("client `{name}` is not in this process, where it could be saved and forked");
            Usage::new(message, Some("explore with a soft PLC in its place".to_owned()))
        };
        let deviating = deviations.iter().flat_map(Deviation::operations);
        in_process(self.scenario, self.until, deviating, elsewhere)
    }
}

fn see(judge: &mut Judge, columns: &Chosen, session: &Session) {
    judge.push(session.t_v().as_nanos(), columns.numbers(session));
}

fn levels(signals: &Chosen, session: &Session) -> Vec<bool> {
    signals.bytes(session).map(|bytes| bytes.iter().any(|byte| *byte != 0)).collect()
}
