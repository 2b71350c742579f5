//! The session's own part of a checkpoint.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Session;
use crate::signal::SignalId;
use crate::state::ServerState;
use crate::time::{StepCount, VirtualTime};

/// The session's own part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionState {
    steps: StepCount,
    t_v: VirtualTime,
    wakes: Vec<VirtualTime>,
    image: Vec<u8>,
    forces: BTreeMap<u64, Vec<u8>>,
}

impl SessionState {
    /// Virtual time of the checkpoint.
    pub fn t_v(&self) -> VirtualTime {
        self.t_v
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
            forces: self.image.forces().iter().map(|(offset, bytes)| (*offset as u64, bytes.clone())).collect(),
        })
    }

    /// Takes the place of a session that was saved: same plan, all clients joined, not yet started.
    /// False if `state` cannot be of this session; nothing has changed then.
    pub fn restore(&mut self, state: &SessionState) -> bool {
        let fits = state.wakes.len() == self.members.len()
            && state.image.len() == self.layout.size()
            && state.forces.iter().all(|(offset, bytes)| self.is_signal(*offset, bytes.len()))
            && state.t_v.is_multiple_of(self.plan.step())
            && state.wakes.iter().all(|wake| wake.is_multiple_of(self.plan.step()) && *wake > state.t_v)
            && self.cycle.server() == ServerState::Start
            && self.members.iter().all(Option::is_some);
        if fits {
            self.cycle.resume_at(state.steps, state.t_v, &state.wakes);
            self.image.load(&state.image);
            for (offset, bytes) in &state.forces {
                self.image.force(*offset as usize, bytes.clone());
            }
        }
        fits
    }

    /// True if a signal lies there.
    fn is_signal(&self, offset: u64, size: usize) -> bool {
        let here = |id: SignalId| (self.layout.offset(id) as u64, self.layout.ty(id).size()) == (offset, size);
        self.layout.signals().any(here)
    }
}
