//! A recorded run once more, up to some time.

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::digest::Digest;
use onescan_server::formation::Formation;
use onescan_server::operation::OperatorInput;
use onescan_server::time::{StepCount, VirtualTime};
use onescan_server::timeline::Timeline;

use super::error::RunError;
use crate::error::Usage;

/// How far it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rerun {
    /// The last step.
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
    let mut formation = Formation::new(scenario.plan().clone());
    for name in scenario.plan().clients() {
        match scenario.member(name)? {
            Member::Plant(client) | Member::Plc(client) => {
                let refused =
                    |refusal: onescan_server::join::JoinRefusal| scenario.wrong_client(name, refusal.to_string(), None);
                formation.join(client).map_err(refused)?;
            }
            Member::Gateway(_) => {
                let message = format!("client `{name}` is a real PLC and cannot be run again");
                return Err(Usage::new(message, None).into());
            }
            Member::External(_) | Member::Seated { .. } => {
                let message = format!("client `{name}` is a program of its own and cannot be run again");
                return Err(Usage::new(message, None).into());
            }
        }
    }
    let mut lockstep = formation.start()?;
    lockstep.set_until(Some(until));
    // What a case does is part of the scenario, not of what an operator did.
    let timeline = Timeline::new(scenario.timeline().to_vec(), lockstep.session()).map_err(RunError::Timeline)?;
    lockstep.set_timeline(timeline);
    lockstep.replay(inputs);
    let outcome = lockstep.run()?;
    Ok(Rerun { steps: outcome.steps, digest: outcome.digest })
}
