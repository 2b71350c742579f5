//! One way in which the session may go, from its start or forked from another.

use std::rc::Rc;

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_scenario::expect::TraceEnd;
use onescan_server::digest::Digest;
use onescan_server::session::Session;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;

use super::ExploreError;
use super::deviation::Deviation;
use crate::error::Usage;
use crate::run::RunError;
use crate::run::chosen::Chosen;
use crate::run::expectation::ExpectationReport;
use crate::run::judged::{Judged, Moment};

/// An edge, and the boundary before the step that brings it.
#[derive(Clone)]
pub(super) struct Fork {
    /// Number of the signal among those that may be late.
    pub(super) signal: usize,
    pub(super) rises: bool,
    /// When the edge arrives.
    pub(super) edge: VirtualTime,
    moment: Rc<Moment>,
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
        let mut judged = self.form(deviations)?;
        match from {
            Some(fork) => judged.resume(&fork.moment).map_err(RunError::Fork)?,
            None => judged.begin()?,
        }
        let mut edges = Chosen::new(&self.signals);
        edges.find(judged.session());
        let mut forks = Vec::new();
        let mut last: Vec<bool> = levels(&edges, judged.session());
        loop {
            // Before the step, because what it brings is to be late.
            let before = if keeps_forks { judged.moment()?.map(Rc::new) } else { None };
            if !judged.step()? {
                break;
            }
            let now = levels(&edges, judged.session());
            if let Some(moment) = before {
                let changed = now.iter().zip(&last).enumerate().filter(|(_, (now, last))| now != last);
                forks.extend(changed.map(|(signal, (now, _))| Fork {
                    signal,
                    rises: *now,
                    edge: judged.session().t_v(),
                    moment: Rc::clone(&moment),
                }));
            }
            last = now;
        }
        let judgement = judged.finish(TraceEnd::Complete)?;
        let failure = judgement.failure.map(|failure| failure.to_string());
        Ok(Path { digest: judgement.digest, violated: judgement.violated, failure, forks })
    }

    fn form(&self, deviations: &[Deviation]) -> Result<Judged<'a>, RunError> {
        let elsewhere = |name: &ClientName, _: &Member| {
            let message = format!("client `{name}` is not in this process, where it could be saved and forked");
            Usage::new(message, Some("explore with a soft PLC in its place".to_owned()))
        };
        let deviating = deviations.iter().flat_map(Deviation::operations);
        Judged::form(self.scenario, self.until, deviating, elsewhere)
    }
}

fn levels(signals: &Chosen, session: &Session) -> Vec<bool> {
    signals.bytes(session).map(|bytes| bytes.iter().any(|byte| *byte != 0)).collect()
}
