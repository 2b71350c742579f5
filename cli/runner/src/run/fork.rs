//! Checkpoints from which other cases fork: what they have in common is run once.

use std::collections::BTreeMap;

use onescan_report::file;
use onescan_server::checkpoint::StateHash;
use onescan_server::digest::TrajectoryDigest;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::observer::RecordError;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::When;

use super::config::ForkRequest;
use super::error::RunError;

/// A checkpoint that was taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fork {
    /// Virtual time of the boundary at which its state was that of the other one.
    pub t_v: VirtualTime,
    /// The conditions that come true in the step that begins there.
    pub coming: Vec<When>,
}

/// Where a session came together with another.
pub struct Joined {
    pub t_v: VirtualTime,
    /// The digest up to there, as it grows.
    pub digest: TrajectoryDigest,
}

/// What was taken of a session.
#[derive(Debug, Default)]
pub(super) struct Taken {
    pub(super) forks: Vec<Fork>,
    /// Its state at the boundaries that were asked for.
    pub(super) states: Vec<(VirtualTime, StateHash)>,
}

/// Takes all checkpoints and states that are asked for, up to `end`. The session has gone past the last of them then.
///
/// # Errors
/// A client cannot save, or a file cannot be written. The session can go on.
pub(super) fn take(lockstep: &mut Lockstep, request: &ForkRequest, end: VirtualTime) -> Result<Taken, RunError> {
    file::create_folder(&request.folder)?;
    let mut taken = Taken::default();
    let mut times = request.times.iter().copied().peekable();
    let mut fork_points = request.states.iter().copied().peekable();
    let mut waiting = request.conditions.len();
    loop {
        let next = [times.peek(), fork_points.peek()].into_iter().flatten().copied().min();
        let next = next.filter(|next| *next < end).unwrap_or(end);
        if next == end && waiting == 0 {
            return Ok(taken);
        }
        if lockstep.run_to_fork(next)? == Reached::End || lockstep.session().t_v() >= end {
            return Ok(taken);
        }
        let t_v = lockstep.session().t_v();
        let coming: Vec<When> = lockstep.coming().cloned().collect();
        waiting = waiting.saturating_sub(coming.len());
        let (mut is_fork, mut is_spot) = (!coming.is_empty(), false);
        while times.next_if(|time| *time <= t_v).is_some() {
            is_fork = true;
        }
        while let Some(fork_point) = fork_points.next_if(|fork_point| *fork_point <= t_v) {
            is_spot |= fork_point == t_v;
        }
        let checkpoint = lockstep.checkpoint().map_err(RunError::Save)?;
        if is_spot {
            taken.states.push((t_v, checkpoint.state_hash().map_err(RunError::Save)?));
        }
        if is_fork {
            let bytes = checkpoint.to_bytes().map_err(RunError::Save)?;
            file::write_whole(&ForkRequest::fork_file(&request.folder, t_v), &bytes)?;
            taken.forks.push(Fork { t_v, coming });
        }
    }
}

/// Goes on until the session is in one of these states of another run at the same virtual time, and lets it end there.
/// Nothing if it ends before, or never is.
///
/// # Errors
/// A recording cannot be written.
pub(super) fn join(
    lockstep: &mut Lockstep,
    states: &BTreeMap<VirtualTime, String>,
) -> Result<Option<Joined>, RecordError> {
    for (at, state) in states {
        if *at <= lockstep.session().t_v() {
            continue;
        }
        if lockstep.run_to(*at)? == Reached::End {
            return Ok(None);
        }
        let checkpoint = match lockstep.checkpoint() {
            Ok(checkpoint) => checkpoint,
            Err(error) => {
                tracing::debug!(%error, "it cannot be seen whether it comes together with another run");
                return Ok(None);
            }
        };
        if checkpoint.state_hash().is_ok_and(|own| own.to_string() == *state) {
            lockstep.set_until(Some(*at));
            return Ok(Some(Joined { t_v: *at, digest: checkpoint.trajectory().clone() }));
        }
    }
    Ok(None)
}
