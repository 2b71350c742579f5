//! The values of a scenario's signals at the start: those of the image with which its session begins.

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::layout::ImageLayout;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::error::RunError;
use super::in_process::in_process;
use crate::error::Usage;

/// The values by signal, in the order of the plan; NaN for what is not a number.
///
/// # Errors
/// A client is not in this process, or its files are wrong.
pub fn values_at_start(scenario: &Scenario) -> Result<Vec<f64>, RunError> {
    let until = VirtualTime::ZERO + scenario.plan().step();
    let mut lockstep = in_process(scenario, until, [], elsewhere)?;
    lockstep.run_to(VirtualTime::ZERO)?;
    let (layout, image) = (ImageLayout::new(scenario.plan().signals()), lockstep.session().image());
    let value = |signal| layout.ty(signal).as_f64(layout.bytes(signal, image)).unwrap_or(f64::NAN);
    Ok(layout.signals().map(value).collect())
}

fn elsewhere(name: &ClientName, _: &Member) -> Usage {
    Usage::new(format!("client `{name}` is not in this process"), None)
}
