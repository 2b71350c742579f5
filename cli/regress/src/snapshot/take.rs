//! The trajectory of a run.

use std::cell::RefCell;
use std::rc::Rc;

use onescan_scenario::case::{Catalogue, DEFAULT};
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::session::Session;
use onescan_server::signal::{SignalId, SignalName, SignalType, did_you_mean};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::{Sampled, Snapshot, Track};

/// A run has about so many samples unless the scenario says otherwise.
const SAMPLES: u64 = 100;

/// Which signals a snapshot holds, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The signals, in the order of the snapshot.
    pub signals: Vec<SignalName>,
    /// How far apart samples of REAL and LREAL are.
    pub every: TimeSpan,
    /// By how much a signal may differ.
    pub tolerances: std::collections::BTreeMap<String, f64>,
}

impl Choice {
    /// What the scenario says of its snapshots.
    ///
    /// # Errors
    /// It names signals that it has not, or a sampling that is none.
    pub fn of(scenario: &Scenario, catalogue: &Catalogue) -> Result<Self, ScenarioError> {
        let (file, declared) = (catalogue.snapshot(), &scenario.file().signals);
        let known = |name: &SignalName, place| {
            if declared.contains_key(name) {
                return Ok(());
            }
            let help = did_you_mean(name.as_str(), declared.keys().map(SignalName::as_str));
            Err(catalogue.wrong(format!("the scenario has no signal `{name}`"), place, help))
        };
        for signal in &file.signals {
            known(signal.get_ref(), Some(signal.span()))?;
        }
        for (name, tolerance) in &file.tolerance {
            known(name, Some(tolerance.span()))?;
            if !(0.0..f64::INFINITY).contains(tolerance.get_ref()) {
                let message = format!("the tolerance of `{name}` is a number from 0");
                return Err(catalogue.wrong(message, Some(tolerance.span()), None));
            }
        }
        let every = file.sample.unwrap_or_else(|| usual_sampling(scenario));
        if !every.is_multiple_of(scenario.file().step) {
            let message = format!("samples every {every} do not fall on the step of {}", scenario.file().step);
            return Err(catalogue.wrong(message, None, Some("write a multiple of the step".to_owned())));
        }
        let plotted = scenario.file().plot.signals.iter();
        let first = |named: Vec<SignalName>, or: Vec<SignalName>| if named.is_empty() { or } else { named };
        let signals = first(
            file.signals.iter().map(|signal| signal.get_ref().clone()).collect(),
            first(plotted.map(|signal| signal.get_ref().clone()).collect(), declared.keys().cloned().collect()),
        );
        let tolerances = file.tolerance.iter().map(|(name, value)| (name.to_string(), *value.get_ref())).collect();
        Ok(Self { signals, every, tolerances })
    }
}

/// The least of 1, 2, 5, 10, … steps that gives no more than about [`SAMPLES`].
fn usual_sampling(scenario: &Scenario) -> TimeSpan {
    let (step, wanted) = (scenario.file().step, scenario.until().as_nanos() / SAMPLES);
    let powers = (0..19).map(|power| 10_u64.pow(power));
    let counts = powers.flat_map(|power| [1, 2, 5].map(|factor| power.saturating_mul(factor)));
    let mut spans = counts.filter_map(|count| step.times(count));
    spans.find(|span| span.as_nanos() >= wanted).unwrap_or(step)
}

/// One signal as it is taken.
struct Taken {
    id: SignalId,
    track: Track,
    hasher: blake3::Hasher,
}

/// Takes the trajectory of a session.
pub struct Taker {
    choice: Choice,
    names: (String, String),
    taken: Vec<Taken>,
    snapshot: Rc<RefCell<Option<Snapshot>>>,
}

impl Taker {
    /// One that leaves the trajectory in `snapshot` when the session ends.
    pub fn new(scenario: &Scenario, choice: Choice, snapshot: Rc<RefCell<Option<Snapshot>>>) -> Self {
        let case = scenario.case().map_or(DEFAULT, |case| case.name.as_str());
        Self { choice, names: (scenario.name().to_owned(), case.to_owned()), taken: Vec::new(), snapshot }
    }
}

impl Taken {
    fn take(&mut self, session: &Session) {
        let bytes = session.layout().bytes(self.id, session.image());
        let due = match self.track.sampled {
            Some(Sampled { every, .. }) => {
                self.hasher.update(bytes);
                session.t_v().is_multiple_of(every)
            }
            None => true,
        };
        if due && self.track.changes.last().is_none_or(|(_, last)| last != bytes) {
            self.track.changes.push((session.t_v(), bytes.to_vec()));
        }
    }

    fn finish(&self) -> Track {
        let digest = self.hasher.finalize();
        let mut first = [0; 8];
        first.copy_from_slice(&digest.as_bytes()[..8]);
        let sampled = self.track.sampled.map(|sampled| Sampled { digest: u64::from_be_bytes(first), ..sampled });
        Track { sampled, ..self.track.clone() }
    }
}

impl Observer for Taker {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        let taken = |name: &SignalName| {
            let id = session.signal_id(name.as_str())?;
            let ty = session.layout().ty(id);
            let is_real = matches!(ty, SignalType::REAL | SignalType::LREAL);
            let sampled = is_real.then_some(Sampled { every: self.choice.every, digest: 0 });
            let unit = session.plan().signals().iter().find(|signal| signal.name == *name)?.unit.clone();
            let track = Track { name: name.to_string(), ty, unit, sampled, changes: Vec::new() };
            Some(Taken { id, track, hasher: blake3::Hasher::new() })
        };
        self.taken = self.choice.signals.iter().filter_map(taken).collect();
        self.step(session, digest)
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.taken.iter_mut().for_each(|taken| taken.take(session));
        Ok(())
    }

    fn end(&mut self, session: &Session) -> Result<(), RecordError> {
        let (scenario, case) = self.names.clone();
        let (step, end): (TimeSpan, VirtualTime) = (session.step(), session.t_v());
        let signals = self.taken.iter().map(Taken::finish).collect();
        self.snapshot.replace(Some(Snapshot { scenario, case, step, end, signals }));
        Ok(())
    }
}
