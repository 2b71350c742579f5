//! Boundaries at which a run keeps checkpoints.

use std::collections::{BTreeMap, BTreeSet};

use onescan_server::time::VirtualTime;

use onescan_runner::run::RunError;
use onescan_runner::run::judged::{Judged, Moment};

/// Checkpoints that are kept of a run: each takes as much memory as the session.
const FORK_POINTS_MAX: usize = 64;

/// The boundaries from which other runs may fork.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForkPoints(BTreeSet<VirtualTime>);

/// The checkpoints of a run.
pub(crate) type Checkpoints = BTreeMap<VirtualTime, Moment>;

impl ForkPoints {
    /// These boundaries; of too many, some that lie evenly among them.
    pub(crate) fn among(all: BTreeSet<VirtualTime>) -> Self {
        let stride = all.len().div_ceil(FORK_POINTS_MAX).max(1);
        Self(all.into_iter().step_by(stride).collect())
    }

    /// Only the first of these boundaries.
    pub(crate) fn first_of(all: BTreeSet<VirtualTime>) -> Self {
        Self(all.into_iter().take(1).collect())
    }

    /// Keeps a checkpoint if the session is at one of them.
    ///
    /// # Errors
    /// A client cannot save its state.
    pub(super) fn keep(&self, judged: &mut Judged<'_>, checkpoints: &mut Checkpoints) -> Result<(), RunError> {
        let t_v = judged.session().t_v();
        if self.0.contains(&t_v)
            && let Some(checkpoint) = judged.moment()?
        {
            checkpoints.insert(t_v, checkpoint);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_boundaries_some_are_kept_evenly() {
        let boundaries = |count: u64| (0..count).map(VirtualTime::from_nanos).collect::<BTreeSet<_>>();
        let kept = |count| ForkPoints::among(boundaries(count)).0.into_iter().map(VirtualTime::as_nanos);
        assert!(kept(64).eq(0..64));
        assert!(kept(65).eq((0..65).step_by(2)));
        assert_eq!(kept(0).count(), 0);
        assert!(ForkPoints::first_of(boundaries(3)).0.into_iter().eq([VirtualTime::ZERO]));
    }
}
