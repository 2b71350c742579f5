//! What is read out of a run while it goes.

use std::cell::RefCell;
use std::rc::Rc;

use onescan_scenario::apply::measure::{CampaignMeasures, Injected};
use onescan_scenario::expect::{Judge, Reaction, TraceEnd, Verdict};
use onescan_scenario::report::Measures;
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Author, OperatorInput};
use onescan_server::session::Session;
use serde::{Deserialize, Serialize};

use super::reading::Reading;
use crate::run::chosen::Chosen;
use crate::run::production::Metered;

/// Watches a run for what its campaign measures.
pub(super) struct Probe {
    injected: Option<Injected>,
    measures: CampaignMeasures,
    readouts: Chosen,
    columns: Chosen,
    /// The trajectories up to where the run begins: nothing, or that of the run from which it forks.
    tracks: Vec<Track>,
    /// Counts alarms from the fault on.
    metering: Option<Box<dyn Observer>>,
    seen: Rc<RefCell<Seen>>,
}

/// What has been seen so far.
pub(super) struct Seen {
    /// The fault comes with the step that is under way.
    coming: bool,
    activated_ns: Option<u64>,
    told: Option<Reaction>,
    judge: Judge,
    tracks: Vec<Track>,
    /// Virtual time of each checkpoint that was taken, and the trajectories up to there.
    pub(super) kept: Vec<(u64, Vec<Track>)>,
}

/// A readout: its trajectory as a hash, and what it was last.
///
/// The hash is a chain, a link for each change, so that it can be put down and taken up again by a run that forks.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Track {
    chain: [u8; 32],
    last: Option<Vec<u8>>,
}

impl Track {
    fn push(&mut self, t_ns: u64, bytes: &[u8]) {
        if self.last.as_deref() != Some(bytes) {
            let mut link = blake3::Hasher::new();
            link.update(&self.chain).update(&t_ns.to_le_bytes()).update(bytes);
            self.chain = *link.finalize().as_bytes();
            let last = self.last.get_or_insert_default();
            last.clear();
            last.extend_from_slice(bytes);
        }
    }

    fn hash(&self) -> String {
        blake3::Hash::from_bytes(self.chain).to_hex()[..16].to_owned()
    }
}

impl Seen {
    pub(super) fn nothing(measures: &CampaignMeasures) -> Self {
        let formulas = measures.safe.iter().chain(&measures.collision).cloned();
        Self {
            coming: false,
            activated_ns: None,
            told: measures.told.clone(),
            judge: Judge::new(formulas, measures.columns.len()),
            tracks: measures.readouts.iter().map(|_| Track::default()).collect(),
            kept: Vec::new(),
        }
    }

    /// What it comes to at the end of the run.
    pub(super) fn reading(self, measures: &CampaignMeasures, end: TraceEnd) -> Reading {
        let judged = if self.activated_ns.is_some() { self.judge.finish(end) } else { Vec::new() };
        let mut held = judged.into_iter().map(|outcome| outcome.verdict == Verdict::Met);
        Reading {
            activated_ns: self.activated_ns,
            told_after_ns: self.told.and_then(|told| told.finish(end)),
            safe: measures.safe.as_ref().and_then(|_| held.next()),
            collision: measures.collision.as_ref().and_then(|_| held.next()),
            readouts: self.tracks.iter().map(Track::hash).collect(),
            ..Reading::default()
        }
    }
}

impl Probe {
    pub(super) fn new(measures: &CampaignMeasures, injected: Option<Injected>, seen: Rc<RefCell<Seen>>) -> Self {
        let tracks = seen.borrow().tracks.clone();
        Self {
            tracks,
            metering: None,
            injected,
            readouts: Chosen::new(&measures.readouts),
            columns: Chosen::new(&measures.columns),
            measures: measures.clone(),
            seen,
        }
    }

    /// The same in a run that forks from one that has seen these trajectories.
    pub(super) fn forking(self, tracks: Vec<Track>) -> Self {
        Self { tracks, ..self }
    }

    /// The same, counting alarms from the fault on.
    pub(super) fn metering(self, metered: &Metered, measures: Option<&Measures>) -> Self {
        Self { metering: metered.observer(measures), ..self }
    }
}

impl Observer for Probe {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.readouts.find(session);
        self.columns.find(session);
        self.seen.replace(Seen { tracks: self.tracks.clone(), ..Seen::nothing(&self.measures) });
        self.step(session, digest)
    }

    fn step(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        let t_v = session.t_v();
        let mut seen = self.seen.borrow_mut();
        for (track, bytes) in seen.tracks.iter_mut().zip(self.readouts.bytes(session)) {
            track.push(t_v.as_nanos(), bytes);
        }
        let by_time = self.injected.as_ref().and_then(|injected| injected.at).is_some_and(|at| t_v >= at);
        let is_first = (by_time || seen.coming) && seen.activated_ns.is_none();
        if is_first {
            seen.activated_ns = Some(t_v.as_nanos());
        }
        if seen.activated_ns.is_some() {
            match &mut self.metering {
                Some(metering) if is_first => metering.begin(session, digest)?,
                Some(metering) => metering.step(session, digest)?,
                None => {}
            }
            if let Some(told) = &mut seen.told {
                told.push(t_v.as_nanos(), self.columns.numbers(session));
            }
            seen.judge.push(t_v.as_nanos(), self.columns.numbers(session));
        }
        Ok(())
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        let of_fault = |injected: &Injected| injected.operations.contains(&input.operation);
        if input.author == Author::Timeline && self.injected.as_ref().is_some_and(of_fault) {
            self.seen.borrow_mut().coming = true;
        }
        Ok(())
    }

    fn saved(&mut self, session: &Session) {
        let mut seen = self.seen.borrow_mut();
        let tracks = seen.tracks.clone();
        seen.kept.push((session.t_v().as_nanos(), tracks));
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
