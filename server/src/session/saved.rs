//! The session's own part of a checkpoint.

use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Session;
use crate::signal_overlay::SignalOverlay;
use crate::state::ServerState;
use crate::time::{StepCount, VirtualTime};

/// The session's own part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionState {
    steps: StepCount,
    t_v: VirtualTime,
    wakes: Vec<VirtualTime>,
    image: Bytes,
    /// What the writers last wrote, which a force or a fault may hide in `image`.
    staged: Bytes,
    signal_overlay: SignalOverlay,
}

/// The bytes of an image, which may be kept once where two are the same: a search keeps many checkpoints of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Bytes(Arc<[u8]>);

impl Serialize for Bytes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Bytes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::<u8>::deserialize(deserializer).map(|bytes| Self(bytes.into()))
    }
}

impl SessionState {
    /// Virtual time of the checkpoint.
    pub fn t_v(&self) -> VirtualTime {
        self.t_v
    }

    /// Steps committed at the checkpoint.
    pub fn steps(&self) -> StepCount {
        self.steps
    }
}

impl Session {
    /// The session's own part of a checkpoint; `None` where none can be taken: off a boundary, ended.
    pub fn save(&self) -> Option<SessionState> {
        if !self.cycle.is_at_boundary() || self.end.is_some() {
            return None;
        }
        let image = Bytes(self.image.committed().into());
        // Nothing lies over them, as a rule.
        let staged = if *image.0 == *self.image.staged() { image.clone() } else { Bytes(self.image.staged().into()) };
        Some(SessionState {
            steps: self.cycle.steps(),
            t_v: self.cycle.t_v(),
            wakes: self.clients().map(|client| self.cycle.wake(client)).collect(),
            image,
            staged,
            signal_overlay: self.image.signal_overlay().clone(),
        })
    }

    /// Takes the place of a session that was saved: same plan, all clients joined, not yet started.
    /// False if `state` cannot be of this session; nothing has changed then.
    pub fn restore(&mut self, state: &SessionState) -> bool {
        let fits = state.wakes.len() == self.members.len()
            && state.image.0.len() == self.layout.size()
            && state.staged.0.len() == self.layout.size()
            && state.signal_overlay.fits(&self.layout)
            && state.t_v.is_multiple_of(self.plan.step())
            && state.wakes.iter().all(|wake| wake.is_multiple_of(self.plan.step()) && *wake > state.t_v)
            && self.cycle.server() == ServerState::Start
            && self.members.iter().all(Option::is_some);
        if fits {
            self.cycle.resume_at(state.steps, state.t_v, &state.wakes);
            self.image.load(&state.image.0, &state.staged.0, state.signal_overlay.clone());
        }
        fits
    }
}
