//! A recorded run once more, up to some time.

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::digest::Digest;
use onescan_server::lockstep::Reached;
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
    rerun_while(scenario, until, inputs, || true)
}

/// The same as long as somebody wants it, who is asked before each step.
///
/// # Errors
/// As those of [`rerun`].
pub fn rerun_while(
    scenario: &Scenario,
    until: VirtualTime,
    inputs: Vec<OperatorInput>,
    is_wanted: impl Fn() -> bool,
) -> Result<Rerun, RunError> {
    let elsewhere = |name: &ClientName, member: &Member| {
        let what = if matches!(member, Member::Gateway(_)) { "a real PLC" } else { "a program of its own" };
        Usage::new(format!("client `{name}` is {what} and cannot be run again"), None)
    };
    // What a case does is part of the scenario, not of what an operator did.
    let mut lockstep = in_process(scenario, until, [], elsewhere)?;
    lockstep.replay(inputs);
    while is_wanted() {
        let next = lockstep.session().t_v() + lockstep.session().step();
        if lockstep.run_to(next)? == Reached::End {
            break;
        }
    }
    let outcome = lockstep.outcome();
    Ok(Rerun { steps: outcome.steps, digest: outcome.digest })
}
