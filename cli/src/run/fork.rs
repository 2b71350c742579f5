//! Checkpoints from which other cases fork: what they have in common is run once.

use onescan_report::file;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::time::VirtualTime;
use onescan_server::timeline::When;

use super::config::ForkRequest;
use super::error::RunError;

/// A checkpoint that was taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fork {
    /// The boundary.
    pub(crate) t_v: VirtualTime,
    /// The conditions that come true in the step that begins there.
    pub(crate) coming: Vec<When>,
}

/// Takes all checkpoints that are asked for, up to `end`. The session has gone past the last of them then.
///
/// # Errors
/// A client cannot save, or a file cannot be written. The session can go on.
pub(super) fn take(lockstep: &mut Lockstep, request: &ForkRequest, end: VirtualTime) -> Result<Vec<Fork>, RunError> {
    file::create_folder(&request.folder)?;
    let mut taken = Vec::new();
    let mut times = request.times.iter().copied().peekable();
    let mut waiting = request.conditions.len();
    loop {
        let next = times.peek().copied().filter(|next| *next < end).unwrap_or(end);
        if next == end && waiting == 0 {
            return Ok(taken);
        }
        if lockstep.run_to_fork(next)? == Reached::End || lockstep.session().t_v() >= end {
            return Ok(taken);
        }
        let t_v = lockstep.session().t_v();
        let coming: Vec<When> = lockstep.coming().cloned().collect();
        waiting = waiting.saturating_sub(coming.len());
        while times.next_if(|time| *time <= t_v).is_some() {}
        let bytes = lockstep.checkpoint().and_then(|checkpoint| checkpoint.to_bytes()).map_err(RunError::Save)?;
        file::write_whole(&ForkRequest::fork_file(&request.folder, t_v), &bytes)?;
        taken.push(Fork { t_v, coming });
    }
}
