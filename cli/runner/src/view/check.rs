//! The re-run of a recording, each step held against the digest that was recorded for it.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use onescan_scenario::expect::TraceEnd;
use onescan_server::digest::Digest;
use onescan_server::lockstep::Reached;
use onescan_server::time::{StepCount, VirtualTime};

use super::ViewError;
use super::recorded::Recorded;
use crate::error::Usage;
use crate::past::{Keeper, Kept};
use crate::run::chosen::Chosen;
use crate::run::{alarms, expectation, forked};
use crate::web::{AlarmLog, VerdictBoard, WebError};

/// Steps that are read of the recording at once.
const BLOCK_STEPS: u64 = 4_096;

/// What came of the re-run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Checked {
    /// All steps are as recorded.
    Same { steps: StepCount, t_v: VirtualTime, digest: Digest },
    /// From this step on they are not.
    Differs { step: StepCount, t_v: VirtualTime },
    /// Nobody wanted to know the rest.
    Left { steps: StepCount, t_v: VirtualTime },
}

impl Checked {
    pub(super) fn t_v(&self) -> VirtualTime {
        match self {
            Self::Same { t_v, .. } | Self::Differs { t_v, .. } | Self::Left { t_v, .. } => *t_v,
        }
    }
}

impl fmt::Display for Checked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Same { steps, digest, .. } => {
                write!(f, "run again, all steps up to {steps} are as recorded: digest {digest}")
            }
            Self::Differs { step, t_v } => {
                write!(
                    f,
                    "run again, the recording differs from step {step} on, at {t_v}: another version of onescan, or a real PLC, has made it"
                )
            }
            Self::Left { steps, .. } => {
                write!(f, "run again up to step {steps}, which is as recorded; the rest was not looked at")
            }
        }
    }
}

/// Runs the recording again, keeps moments of it, and says whether it is the same, until somebody has seen `enough`.
///
/// # Errors
/// It cannot be run again, or the recording not be read any more.
pub(super) fn check(
    recorded: &Recorded,
    kept: &Kept,
    (verdict_board, alarm_log): (&VerdictBoard, &AlarmLog),
    enough: &AtomicBool,
) -> Result<Checked, ViewError> {
    let mut lockstep = forked::former(&recorded.scenario)().map_err(|why| Usage::new(why, None))?;
    lockstep.replay(recorded.inputs.clone());
    alarms::note(alarm_log, &recorded.scenario, &mut lockstep);
    let mut keeper = Keeper::new(kept.clone()).map_err(WebError::Thread)?;
    let none = || Usage::new("the recording has no step", None);
    let steps = recorded.recording.steps().ok_or_else(none)?;
    let mut judge = expectation::judge(&recorded.scenario);
    let mut columns = Chosen::new(&recorded.scenario.expectations().signals);
    columns.find(lockstep.session());
    let mut last = None;
    for first in steps.clone().step_by(BLOCK_STEPS as usize) {
        let block = first..=(first + BLOCK_STEPS - 1).min(*steps.end());
        for row in recorded.recording.digests(block)? {
            if enough.load(Ordering::Acquire) {
                return Ok(last
                    .map_or(Checked::Left { steps: StepCount(0), t_v: VirtualTime::ZERO }, |(steps, t_v, _)| {
                        Checked::Left { steps, t_v }
                    }));
            }
            let reached = keeper.run_to(&mut lockstep, row.t_v).map_err(crate::run::RunError::from)?;
            let is_there = reached == Reached::Boundary || lockstep.outcome().t_v == row.t_v;
            if !is_there || lockstep.digest() != Some(row.digest) {
                return Ok(Checked::Differs { step: row.step, t_v: row.t_v });
            }
            judge.push(row.t_v.as_nanos(), columns.numbers(lockstep.session()));
            if verdict_board.is_wanted() {
                verdict_board.leave(row.t_v, judge.clone(), TraceEnd::Cut);
            }
            last = Some((row.step, row.t_v, row.digest));
        }
    }
    let (steps, t_v, digest) = last.ok_or_else(none)?;
    let is_complete = t_v >= recorded.recording.header().provenance.until;
    verdict_board.leave(t_v, judge, if is_complete { TraceEnd::Complete } else { TraceEnd::Cut });
    Ok(Checked::Same { steps, t_v, digest })
}
