//! A session of which all clients are in this process, as one that is run again or forked needs it.

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::Client;
use onescan_server::formation::Formation;
use onescan_server::lockstep::Lockstep;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::{Scheduled, Timeline};

use super::error::RunError;
use crate::error::Usage;

/// A session of `scenario` up to `until`, about to begin. Beside what the scenario does by itself it does `more`.
///
/// # Errors
/// The scenario is wrong, or what `elsewhere` says of a client that is not in this process.
pub(crate) fn in_process(
    scenario: &Scenario,
    until: VirtualTime,
    more: impl IntoIterator<Item = Scheduled>,
    elsewhere: impl Fn(&ClientName, &Member) -> Usage,
) -> Result<Lockstep, RunError> {
    with_clients(scenario, until, more, |_| None, elsewhere)
}

/// The same with clients that are here already, which `here` gives.
///
/// # Errors
/// As those of [`in_process`]; and a client that is here is refused.
pub(crate) fn with_clients(
    scenario: &Scenario,
    until: VirtualTime,
    more: impl IntoIterator<Item = Scheduled>,
    here: impl Fn(&ClientName) -> Option<Box<dyn Client>>,
    elsewhere: impl Fn(&ClientName, &Member) -> Usage,
) -> Result<Lockstep, RunError> {
    let mut formation = Formation::new(scenario.plan().clone());
    for name in scenario.plan().clients() {
        if let Some(client) = here(name) {
            let request = client.join();
            formation.join(client).map_err(|refusal| scenario.refused(&request, &refusal))?;
            continue;
        }
        match scenario.member(name)? {
            Member::Plant(client) | Member::Plc(client) => {
                let request = client.join();
                formation.join(client).map_err(|refusal| scenario.refused(&request, &refusal))?;
            }
            other => return Err(elsewhere(name, &other).into()),
        }
    }
    let mut lockstep = formation.start()?;
    lockstep.set_until(Some(until));
    let scheduled = scenario.timeline().iter().cloned().chain(more).collect();
    let timeline = Timeline::new(scheduled, lockstep.session()).map_err(RunError::Timeline)?;
    lockstep.set_timeline(timeline);
    Ok(lockstep)
}
