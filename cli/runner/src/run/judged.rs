//! A session in this process that is judged step by step, as one that forks is.

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_scenario::expect::{Judge, Outcome, TraceEnd};
use onescan_server::checkpoint::{Checkpoint, CheckpointError, StateHash};
use onescan_server::digest::Digest;
use onescan_server::end::{Failure, SessionEnd};
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::observer::RecordError;
use onescan_server::session::Session;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::Scheduled;

use super::chosen::Chosen;
use super::error::RunError;
use super::expectation::{self, ExpectationReport};
use super::in_process::in_process;
use crate::error::Usage;

/// A session, and what its expectations have seen of it.
pub struct Judged<'a> {
    scenario: &'a Scenario,
    lockstep: Lockstep,
    until: VirtualTime,
    judge: Judge,
    columns: Chosen,
    seen: SeenHash,
}

/// A hash over all values by which expectations have been judged so far.
pub type SeenHash = [u8; 32];

/// A boundary from which other sessions go on.
pub struct Moment {
    checkpoint: Checkpoint,
    judge: Judge,
    seen: SeenHash,
}

/// What came of a session.
pub struct Judgement {
    pub digest: Option<Digest>,
    /// Expectations that did not hold.
    pub violated: Vec<ExpectationReport>,
    /// How a client failed, if one did.
    pub failure: Option<Failure>,
}

/// What each expectation of a session is worth.
pub struct Measured {
    pub digest: Option<Digest>,
    /// In the order of the scenario.
    pub outcomes: Vec<Outcome>,
    /// How a client failed, if one did.
    pub failure: Option<Failure>,
}

impl<'a> Judged<'a> {
    /// A session up to `until`, about to begin. Beside what the scenario does by itself it does `more`.
    ///
    /// # Errors
    /// The scenario is wrong, or what `elsewhere` says of a client that is not in this process.
    pub fn form(
        scenario: &'a Scenario,
        until: VirtualTime,
        more: impl IntoIterator<Item = Scheduled>,
        elsewhere: impl Fn(&ClientName, &Member) -> Usage,
    ) -> Result<Self, RunError> {
        let mut lockstep = in_process(scenario, until, more, elsewhere)?;
        lockstep.set_settings(scenario.session_settings());
        let mut columns = Chosen::new(&scenario.expectations().signals);
        columns.find(lockstep.session());
        Ok(Self { scenario, lockstep, until, judge: expectation::judge(scenario), columns, seen: SeenHash::default() })
    }

    /// Sets it up: the image of 0 is there.
    ///
    /// # Errors
    /// A client cannot be set up.
    pub fn begin(&mut self) -> Result<(), RecordError> {
        self.lockstep.run_to(VirtualTime::ZERO)?;
        self.see();
        Ok(())
    }

    /// Goes on from a boundary of another session of the scenario.
    ///
    /// # Errors
    /// Up to there, that one was not what this one is.
    pub fn resume(&mut self, moment: &Moment) -> Result<(), CheckpointError> {
        self.lockstep.resume(&moment.checkpoint)?;
        self.judge = moment.judge.clone();
        self.seen = moment.seen;
        Ok(())
    }

    /// The boundary at which it is. Nothing if it is over.
    ///
    /// # Errors
    /// A client cannot save its state.
    pub fn moment(&mut self) -> Result<Option<Moment>, RunError> {
        match self.lockstep.checkpoint() {
            Ok(checkpoint) => Ok(Some(Moment { checkpoint, judge: self.judge.clone(), seen: self.seen })),
            Err(_) if self.lockstep.session().end().is_some() => Ok(None),
            Err(error) => Err(RunError::Save(error)),
        }
    }

    /// What it will do from here on, as a hash; nothing if it is over.
    ///
    /// # Errors
    /// A client cannot save its state.
    pub fn state(&mut self) -> Result<Option<StateHash>, RunError> {
        match self.lockstep.checkpoint() {
            Ok(checkpoint) => checkpoint.state_hash().map(Some).map_err(RunError::Save),
            Err(_) if self.lockstep.session().end().is_some() => Ok(None),
            Err(error) => Err(RunError::Save(error)),
        }
    }

    /// All that expectations have been judged by so far, as a hash.
    pub fn seen(&self) -> SeenHash {
        self.seen
    }

    /// What is decided of each expectation, whatever comes.
    pub fn settled(&self) -> Vec<Option<bool>> {
        self.judge.settled()
    }

    /// Makes a step; false if there is none.
    ///
    /// # Errors
    /// The session cannot go on.
    pub fn step(&mut self) -> Result<bool, RecordError> {
        let next = self.session().t_v() + self.session().step();
        if self.session().t_v() >= self.until || self.lockstep.run_to(next)? == Reached::End {
            return Ok(false);
        }
        self.see();
        Ok(true)
    }

    /// The session.
    pub fn session(&self) -> &Session {
        self.lockstep.session()
    }

    /// The expectations of which it is known already that they do not hold.
    pub fn violated(&self) -> impl Iterator<Item = &str> {
        let named = &self.scenario.expectations().named;
        self.judge.violated().filter_map(|number| named.get(number).map(|(name, _)| name.as_str()))
    }

    /// What came of it. `end` says whether nothing comes after it.
    ///
    /// # Errors
    /// The session could not go on.
    pub fn finish(mut self, end: TraceEnd) -> Result<Judgement, RecordError> {
        let outcome = self.lockstep.run()?;
        let failure = if let SessionEnd::Failed(failure) = outcome.end { Some(failure) } else { None };
        let end = if failure.is_none() { end } else { TraceEnd::Cut };
        let mut violated = expectation::reports(self.scenario, self.judge, end);
        violated.retain(ExpectationReport::is_violated);
        Ok(Judgement { digest: outcome.digest, violated, failure })
    }

    /// What each expectation is worth now that nothing comes after it. Its clients are gone then.
    ///
    /// # Errors
    /// The session could not go on.
    pub fn measure(mut self) -> Result<Measured, RecordError> {
        let outcome = self.lockstep.run()?;
        let failure = if let SessionEnd::Failed(failure) = outcome.end { Some(failure) } else { None };
        let end = if failure.is_none() { TraceEnd::Complete } else { TraceEnd::Cut };
        Ok(Measured { digest: outcome.digest, outcomes: self.judge.finish(end), failure })
    }

    /// What came of it as far as it is known now; what it would still do is not.
    pub fn abandon(self) -> Vec<ExpectationReport> {
        let mut violated = expectation::reports(self.scenario, self.judge, TraceEnd::Cut);
        violated.retain(ExpectationReport::is_violated);
        violated
    }

    fn see(&mut self) {
        let session = self.lockstep.session();
        let mut hasher = blake3::Hasher::new();
        hasher.update(&self.seen);
        for bytes in self.columns.bytes(session) {
            hasher.update(bytes);
        }
        self.seen = *hasher.finalize().as_bytes();
        self.judge.push(session.t_v().as_nanos(), self.columns.numbers(session));
    }
}
