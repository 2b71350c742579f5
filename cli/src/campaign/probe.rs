//! What is read out of a run while it goes.

use std::cell::RefCell;
use std::rc::Rc;

use onescan_scenario::apply::measure::{CampaignMeasures, Injected};
use onescan_scenario::expect::{Judge, Reaction, TraceEnd, Verdict};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Author, OperatorInput};
use onescan_server::session::Session;

use super::reading::Reading;
use crate::run::chosen::Chosen;

/// Watches a run for what its campaign measures.
pub(super) struct Probe {
    injected: Option<Injected>,
    measures: CampaignMeasures,
    readouts: Chosen,
    columns: Chosen,
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
}

/// A readout: its trajectory as a hash, and what it was last.
#[derive(Default)]
struct Track {
    hasher: blake3::Hasher,
    last: Option<Vec<u8>>,
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
        }
    }

    /// What it comes to at the end of the run.
    pub(super) fn reading(self, measures: &CampaignMeasures, end: TraceEnd) -> Reading {
        let judged = if self.activated_ns.is_some() { self.judge.finish(end) } else { Vec::new() };
        let mut held = judged.into_iter().map(|outcome| outcome.verdict == Verdict::Met);
        let hash = |track: Track| track.hasher.finalize().to_hex()[..16].to_owned();
        Reading {
            activated_ns: self.activated_ns,
            told_after_ns: self.told.and_then(|told| told.finish(end)),
            safe: measures.safe.as_ref().and_then(|_| held.next()),
            collision: measures.collision.as_ref().and_then(|_| held.next()),
            readouts: self.tracks.into_iter().map(hash).collect(),
            ..Reading::default()
        }
    }
}

impl Probe {
    pub(super) fn new(measures: &CampaignMeasures, injected: Option<Injected>, seen: Rc<RefCell<Seen>>) -> Self {
        Self {
            injected,
            readouts: Chosen::new(&measures.readouts),
            columns: Chosen::new(&measures.columns),
            measures: measures.clone(),
            seen,
        }
    }
}

impl Observer for Probe {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.readouts.find(session);
        self.columns.find(session);
        self.seen.replace(Seen::nothing(&self.measures));
        self.step(session, digest)
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        let t_v = session.t_v();
        let mut seen = self.seen.borrow_mut();
        for (track, bytes) in seen.tracks.iter_mut().zip(self.readouts.bytes(session)) {
            if track.last.as_deref() != Some(bytes) {
                track.hasher.update(&t_v.as_nanos().to_le_bytes()).update(bytes);
                track.last.get_or_insert_default().clear();
                track.last.get_or_insert_default().extend_from_slice(bytes);
            }
        }
        let by_time = self.injected.as_ref().and_then(|injected| injected.at).is_some_and(|at| t_v >= at);
        if by_time || seen.coming {
            seen.activated_ns.get_or_insert(t_v.as_nanos());
        }
        if seen.activated_ns.is_some() {
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

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
