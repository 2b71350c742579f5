//! The session's own part of a checkpoint.

use serde::{Deserialize, Serialize};

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
    image: Vec<u8>,
    /// What the writers last wrote, which a force or a fault may hide in `image`.
    staged: Vec<u8>,
    signal_overlay: SignalOverlay,
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
        (self.cycle.is_at_boundary() && self.end.is_none()).then(|| SessionState {
            steps: self.cycle.steps(),
            t_v: self.cycle.t_v(),
            wakes: self.clients().map(|client| self.cycle.wake(client)).collect(),
            image: self.image.committed().to_vec(),
            staged: self.image.staged().to_vec(),
            signal_overlay: self.image.signal_overlay().clone(),
        })
    }

    /// Takes the place of a session that was saved: same plan, all clients joined, not yet started.
    /// False if `state` cannot be of this session; nothing has changed then.
    pub fn restore(&mut self, state: &SessionState) -> bool {
        let fits = state.wakes.len() == self.members.len()
            && state.image.len() == self.layout.size()
            && state.staged.len() == self.layout.size()
            && state.signal_overlay.fits(&self.layout)
            && state.t_v.is_multiple_of(self.plan.step())
            && state.wakes.iter().all(|wake| wake.is_multiple_of(self.plan.step()) && *wake > state.t_v)
            && self.cycle.server() == ServerState::Start
            && self.members.iter().all(Option::is_some);
        if fits {
            self.cycle.resume_at(state.steps, state.t_v, &state.wakes);
            self.image.load(&state.image, &state.staged, state.signal_overlay.clone());
        }
        fits
    }
}
