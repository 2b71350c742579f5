//! Lookouts: conditions that a session judges without acting on them, for the sake of sessions that fork from it.
//!
//! A case that waits for a condition can fork from a run without that case only where the condition has not come true
//! yet, and only if somebody has seen what the condition remembers. A condition monitor sees it. It is not part of what the
//! session does: the digest and the state hash do not know of it.

use serde::{Deserialize, Serialize};

use super::{Comparison, Judged, Seen, When, bind, comes_true};
use crate::operation::OperationError;
use crate::session::Session;
use crate::time::VirtualTime;

/// A condition that is judged, and what has been seen of it.
#[derive(Clone, Debug)]
pub(super) struct ConditionMonitor {
    when: When,
    condition: Judged<Comparison>,
    seen: Seen,
    /// It has come true, or its past is not known: nobody can fork to it any more.
    passed: bool,
}

/// What a checkpoint keeps of a condition monitor that has yet to come true.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct ConditionMonitorState {
    pub(super) when: When,
    pub(super) seen: Seen,
}

impl ConditionMonitor {
    /// A condition monitor for `when`; nothing for a time, which comes without being looked out for.
    ///
    /// # Errors
    /// A condition on a signal that the session does not have, or with a value that it cannot have.
    pub(super) fn new(when: When, session: &Session) -> Result<Option<Self>, OperationError> {
        let When::Once { condition, .. } = &when else { return Ok(None) };
        let condition = bind(condition, session)?;
        Ok(Some(Self { when, condition, seen: Seen::default(), passed: false }))
    }

    pub(super) fn when(&self) -> &When {
        &self.when
    }

    /// Nothing has been seen: the session starts, or restarts.
    pub(super) fn begin(&mut self) {
        (self.seen, self.passed) = (Seen::nothing(Some(&self.condition)), false);
    }

    /// Judges the image committed at `t_v`.
    pub(super) fn judge(&mut self, session: &Session, t_v: VirtualTime) {
        self.passed = self.passed || comes_true(&self.when, &self.condition, &mut self.seen, session, t_v);
    }

    /// True if it will come true with this image, which has yet to be judged.
    pub(super) fn is_coming(&self, session: &Session, t_v: VirtualTime) -> bool {
        // On a copy: the image is judged in its turn, by the step that begins there.
        !self.passed && comes_true(&self.when, &self.condition, &mut self.seen.clone(), session, t_v)
    }

    /// What a checkpoint keeps; nothing once it has come true.
    pub(super) fn save(&self) -> Option<ConditionMonitorState> {
        (!self.passed).then(|| ConditionMonitorState { when: self.when.clone(), seen: self.seen.clone() })
    }

    /// Goes on from what a checkpoint kept. Without it the past is not known.
    pub(super) fn restore(&mut self, all: &[ConditionMonitorState]) {
        let kept = all.iter().find(|kept| kept.when == self.when && self.condition.fits(&kept.seen.memories));
        self.passed = kept.is_none();
        if let Some(kept) = kept {
            self.seen = kept.seen.clone();
        }
    }
}
