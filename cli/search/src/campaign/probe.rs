//! What is read out of a run while it goes.

use std::cell::RefCell;
use std::rc::Rc;

use onescan_scenario::apply::measure::{CampaignMeasures, Injected};
use onescan_scenario::expect::{Judge, Reaction, TraceEnd, Verdict};
use onescan_scenario::report::Measures;
use onescan_server::digest::TrajectoryDigest;
use onescan_server::layout::ImageLayout;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Author, OperatorInput};
use onescan_server::session::Session;
use serde::{Deserialize, Serialize};

use super::reading::Reading;
use onescan_runner::run::chosen::Chosen;
use onescan_runner::run::production::{Metered, Metering};

/// What is read out of a run: of its images, one after the other.
pub(super) struct Probe {
    injected: Option<Injected>,
    measures: CampaignMeasures,
    readouts: Chosen,
    columns: Chosen,
    /// The trajectories up to where the run begins: nothing, or that of the run from which it forks.
    tracks: Vec<Track>,
    /// Counts alarms from the fault on.
    metering: Option<Metering>,
    /// Of the session that began last.
    layout: Option<ImageLayout>,
    seen: Seen,
}

/// Shows a run to a probe that others read.
pub(super) struct Watch(pub(super) Rc<RefCell<Probe>>);

/// What has been seen so far.
pub(super) struct Seen {
    /// The fault comes with the step that is under way.
    coming: bool,
    activated_ns: Option<u64>,
    detected: Option<Reaction>,
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
            detected: measures.detected.clone(),
            judge: Judge::new(formulas, measures.columns.len()),
            tracks: measures.readouts.iter().map(|_| Track::default()).collect(),
            kept: Vec::new(),
        }
    }

    /// What it comes to at the end of the run, of which `known` is known already.
    pub(super) fn reading(self, measures: &CampaignMeasures, end: TraceEnd, known: Reading) -> Reading {
        let judged = if self.activated_ns.is_some() { self.judge.finish(end) } else { Vec::new() };
        let mut held = judged.into_iter().map(|outcome| outcome.verdict == Verdict::Met);
        Reading {
            activated_ns: self.activated_ns,
            detected_after_ns: self.detected.and_then(|detected| detected.finish(end)),
            safe: measures.safe.as_ref().and_then(|_| held.next()),
            collision: measures.collision.as_ref().and_then(|_| held.next()),
            readouts: self.tracks.iter().map(Track::hash).collect(),
            ..known
        }
    }
}

impl Probe {
    pub(super) fn new(measures: &CampaignMeasures, injected: Option<Injected>) -> Self {
        let seen = Seen::nothing(measures);
        Self {
            tracks: seen.tracks.clone(),
            metering: None,
            layout: None,
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
        Self { metering: metered.metering(measures), ..self }
    }

    /// What it has seen; it has seen nothing then.
    pub(super) fn take_seen(&mut self) -> Seen {
        std::mem::replace(&mut self.seen, Seen::nothing(&self.measures))
    }

    /// Looks at images that another run of the same plan has left: this one would have done the same.
    pub(super) fn look_on<'i>(&mut self, images: impl Iterator<Item = (u64, &'i [u8])>) {
        let Some(layout) = self.layout.take() else { return };
        for (t_ns, image) in images {
            self.look(t_ns, &layout, image);
        }
        self.layout = Some(layout);
    }

    fn begin(&mut self, session: &Session) {
        self.readouts.find(session);
        self.columns.find(session);
        if let Some(metering) = &mut self.metering {
            metering.find(session);
        }
        self.layout = Some(session.layout().clone());
        self.seen = Seen { tracks: self.tracks.clone(), ..Seen::nothing(&self.measures) };
        self.look(session.t_v().as_nanos(), session.layout(), session.image());
    }

    fn look(&mut self, t_ns: u64, layout: &ImageLayout, image: &[u8]) {
        let seen = &mut self.seen;
        for (track, bytes) in seen.tracks.iter_mut().zip(self.readouts.bytes_in(layout, image)) {
            track.push(t_ns, bytes);
        }
        let at = self.injected.as_ref().and_then(|injected| injected.at);
        let by_time = at.is_some_and(|at| t_ns >= at.as_nanos());
        if (by_time || seen.coming) && seen.activated_ns.is_none() {
            seen.activated_ns = Some(t_ns);
            if let Some(metering) = &mut self.metering {
                metering.begin_here();
            }
        }
        if seen.activated_ns.is_some() {
            if let Some(metering) = &mut self.metering {
                metering.look(t_ns, layout, image);
            }
            if let Some(detected) = &mut seen.detected {
                detected.push(t_ns, self.columns.numbers_in(layout, image));
            }
            seen.judge.push(t_ns, self.columns.numbers_in(layout, image));
        }
    }

    fn operated(&mut self, input: &OperatorInput) {
        let of_fault = |injected: &Injected| injected.operations.contains(&input.operation);
        if input.author == Author::Timeline && self.injected.as_ref().is_some_and(of_fault) {
            self.seen.coming = true;
        }
    }

    fn saved(&mut self, session: &Session) {
        let tracks = self.seen.tracks.clone();
        self.seen.kept.push((session.t_v().as_nanos(), tracks));
    }
}

impl Observer for Watch {
    fn begin(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.0.borrow_mut().begin(session);
        Ok(())
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.0.borrow_mut().look(session.t_v().as_nanos(), session.layout(), session.image());
        Ok(())
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        self.0.borrow_mut().operated(input);
        Ok(())
    }

    fn saved(&mut self, session: &Session) {
        self.0.borrow_mut().saved(session);
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
