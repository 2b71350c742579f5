//! A recorded run once more, up to some time.

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::digest::Digest;
use onescan_server::operation::OperatorInput;
use onescan_server::signal::ClientName;
use onescan_server::time::{StepCount, VirtualTime};

use super::error::RunError;
use super::in_process::in_process;
use crate::error::Usage;

/// How far it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rerun {
    pub steps: StepCount,
    /// The digest up to it.
    pub digest: Option<Digest>,
}

/// Runs `scenario` in this process up to the first step at or after `until`, with the operator's
/// inputs.
///
/// # Errors
/// The scenario is wrong, or has clients that are programs of their own.
pub fn rerun(scenario: &Scenario, until: VirtualTime, inputs: Vec<OperatorInput>) -> Result<Rerun, RunError> {
    let elsewhere = |name: &ClientName, member: &Member| {
        let what = if matches!(member, Member::Gateway(_)) { "a real PLC" } else { "a program of its own" };
        Usage::new(format!("client `{name}` is {what} and cannot be run again"), None)
    };
    // What a case does is part of the scenario, not of what an operator did.
    let mut lockstep = in_process(scenario, until, [], elsewhere)?;
    lockstep.replay(inputs);
    let outcome = lockstep.run()?;
    Ok(Rerun { steps: outcome.steps, digest: outcome.digest })
}
