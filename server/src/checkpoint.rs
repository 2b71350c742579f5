//! A checkpoint: everything that a session is at a step boundary, as a value.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::client::StateError;
use crate::digest::{Digest, TrajectoryDigest};
use crate::plan::{Coupling, SessionPlan};
use crate::session::SessionState;
use crate::signal::{ClientName, SignalDecl, SignalName, SignalType};
use crate::time::{StepCount, TimeSpan, VirtualTime};
use crate::timeline::{TimelineError, TimelineState};

const MAGIC: &[u8; 16] = b"onescan state 5\n";
const MAGIC_ANY: &[u8; 14] = b"onescan state ";
const CHECK_BYTES: usize = 32;

/// What a session is made of beside its plan: said by whoever composes it, compared when a checkpoint
/// is taken up.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionSettings {
    /// What people call it, as the name of a case.
    pub name: String,
    /// Everything that was set otherwise than the scenario says, by path.
    pub settings: BTreeMap<String, String>,
}

/// The plan of the session that a checkpoint was taken of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PlanSummary {
    step: TimeSpan,
    /// The clients in their order, or nothing in parallel coupling.
    order: Option<Vec<ClientName>>,
    signals: Vec<PlannedSignal>,
    clients: Vec<ClientName>,
}

/// A signal of that plan. A declaration itself leaves out what is absent, which the binary form of
/// checkpoints cannot.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct PlannedSignal {
    name: SignalName,
    ty: SignalType,
    writer: Option<ClientName>,
}

/// The state of a session and of all its clients.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(crate) plan: PlanSummary,
    pub(crate) settings: SessionSettings,
    pub(crate) session: SessionState,
    pub(crate) timeline: TimelineState,
    pub(crate) digest: TrajectoryDigest,
    pub(crate) clients: Vec<(ClientName, Vec<u8>)>,
}

/// A hash over what a session will do from here on: image, delays, what lies over signals, what the
/// timeline has yet to do, and the state of every client.
///
/// Two runs whose hashes are equal at the same virtual time go on alike, however they came there. The
/// digest, in contrast, is over the whole way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StateHash(pub(crate) [u8; 32]);

impl fmt::Display for StateHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("s1:")?;
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl Serialize for StateHash {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Why there is no checkpoint, or why it cannot be taken up.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CheckpointError {
    /// Not a checkpoint at all.
    #[error("not a checkpoint of onescan")]
    Foreign,
    /// A checkpoint that another version of the program wrote.
    #[error("a checkpoint of another version of onescan; take it again with this one")]
    Version,
    /// A checkpoint that was cut or changed.
    #[error("the checkpoint is damaged: its check sum does not fit its bytes")]
    Damaged,
    /// A checkpoint of a session with another plan.
    #[error("the checkpoint belongs to another session: {0}")]
    OtherSession(String),
    /// A checkpoint of the same session, set otherwise.
    #[error("the checkpoint is of {theirs}; {ours} has another `{setting}`: {here} instead of {there}")]
    OtherSetting {
        /// What the session of the checkpoint is called.
        theirs: String,
        /// What this session is called.
        ours: String,
        setting: String,
        /// Its value in this session, or that it is not set.
        here: String,
        /// Its value in the checkpoint's.
        there: String,
    },
    /// A checkpoint of a session to which other things have happened.
    #[error("the checkpoint is of {theirs}, this is {ours}: {source}")]
    OtherTimeline {
        /// What the session of the checkpoint is called.
        theirs: String,
        /// What this session is called.
        ours: String,
        /// What happened in one of them only.
        source: TimelineError,
    },
    #[error("a checkpoint can be taken only at a step boundary of a session that goes on")]
    NotNow,
    #[error("client `{client}`: {source}")]
    Client { client: ClientName, source: StateError },
}

impl PlanSummary {
    pub(crate) fn of(plan: &SessionPlan) -> Self {
        let order = match plan.coupling() {
            Coupling::Parallel => None,
            Coupling::Sequential { order } => {
                Some(order.iter().map(|client| plan.clients()[client.index()].clone()).collect())
            }
        };
        let planned = |signal: &SignalDecl| PlannedSignal {
            name: signal.name.clone(),
            ty: signal.ty,
            writer: signal.writer.clone(),
        };
        let signals = plan.signals().iter().map(planned).collect();
        Self { step: plan.step(), order, signals, clients: plan.clients().to_vec() }
    }

    /// The first thing in which `other` is not this plan, in words; nothing if it is the same.
    pub(crate) fn difference(&self, other: &Self) -> Option<String> {
        if self.step != other.step {
            return Some(format!("its step is {}, not {}", self.step, other.step));
        }
        if self.order != other.order {
            return Some("its clients are coupled in another way".to_owned());
        }
        let client = |of: &Self, not: &Self| of.clients.iter().find(|name| !not.clients.contains(name)).cloned();
        if let Some(name) = client(self, other) {
            return Some(format!("it has a client `{name}`, which this session does not have"));
        }
        if let Some(name) = client(other, self) {
            return Some(format!("it does not have client `{name}`"));
        }
        let find =
            |of: &Self, signal: &PlannedSignal| of.signals.iter().find(|other| other.name == signal.name).cloned();
        for signal in &self.signals {
            match find(other, signal) {
                None => {
                    return Some(format!("it has a signal `{}`, which this session does not have", signal.name));
                }
                Some(here) if here.ty != signal.ty => {
                    return Some(format!("its signal `{}` is {}, not {}", signal.name, signal.ty, here.ty));
                }
                Some(here) if here.writer != signal.writer => {
                    return Some(format!("its signal `{}` has another writer", signal.name));
                }
                Some(_) => {}
            }
        }
        let new = other.signals.iter().find(|signal| find(self, signal).is_none())?;
        Some(format!("it does not have signal `{}`", new.name))
    }
}

impl SessionSettings {
    /// The settings in which this is not `there`.
    pub fn differing<'a>(&'a self, there: &'a Self) -> impl Iterator<Item = &'a String> {
        let paths = self.settings.keys().chain(there.settings.keys());
        paths.filter(|path| self.settings.get(*path) != there.settings.get(*path))
    }

    /// The first setting in which this is not `there`, beside those that may differ, as the error of a session with these
    /// settings.
    pub(crate) fn difference(&self, there: &Self, may_differ: &BTreeSet<String>) -> Option<CheckpointError> {
        let setting = self.differing(there).filter(|path| !may_differ.contains(*path)).min()?;
        let value =
            |of: &Self| of.settings.get(setting).cloned().unwrap_or_else(|| "the scenario's own value".to_owned());
        Some(CheckpointError::OtherSetting {
            theirs: there.name.clone(),
            ours: self.name.clone(),
            setting: setting.clone(),
            here: value(self),
            there: value(there),
        })
    }
}

impl Checkpoint {
    /// Virtual time at which it was taken.
    pub fn t_v(&self) -> VirtualTime {
        self.session.t_v()
    }

    /// Steps committed until then.
    pub fn steps(&self) -> StepCount {
        self.session.steps()
    }

    /// The digest up to there.
    pub fn digest(&self) -> Digest {
        self.digest.value()
    }

    /// The same as it grows, for one who knows what images follow.
    pub fn trajectory(&self) -> &TrajectoryDigest {
        &self.digest
    }

    /// What the session was made of.
    pub fn settings(&self) -> &SessionSettings {
        &self.settings
    }

    /// What the session will do from here on, as a hash.
    ///
    /// # Errors
    /// None for a checkpoint that a session gave.
    pub fn state_hash(&self) -> Result<StateHash, CheckpointError> {
        // Without the digest, which is of the way here, and without what has happened already.
        let ahead = (&self.plan, &self.session, self.timeline.pending(), &self.clients);
        let bytes = postcard::to_stdvec(&ahead).map_err(|_| CheckpointError::Damaged)?;
        Ok(StateHash(*blake3::hash(&bytes).as_bytes()))
    }

    /// The checkpoint as a file's bytes.
    ///
    /// # Errors
    /// None for a checkpoint that a session gave.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CheckpointError> {
        let body = postcard::to_stdvec(self).map_err(|_| CheckpointError::Damaged)?;
        let mut bytes = Vec::with_capacity(MAGIC.len() + CHECK_BYTES + body.len());
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(blake3::hash(&body).as_bytes());
        bytes.extend_from_slice(&body);
        Ok(bytes)
    }

    /// The checkpoint in a file's bytes.
    ///
    /// # Errors
    /// Bytes of anything else, cut or changed bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            let ours = bytes.starts_with(MAGIC_ANY);
            return Err(if ours { CheckpointError::Version } else { CheckpointError::Foreign });
        };
        let (check, body) = rest.split_at_checked(CHECK_BYTES).ok_or(CheckpointError::Damaged)?;
        if blake3::hash(body).as_bytes() != check {
            return Err(CheckpointError::Damaged);
        }
        postcard::from_bytes(body).map_err(|_| CheckpointError::Damaged)
    }
}
