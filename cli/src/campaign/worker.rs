//! One run of a campaign, in a process of its own.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Write;
use std::rc::Rc;

use onescan_report::OutputError;
use onescan_scenario::Scenario;
use onescan_scenario::case::Catalogue;
use onescan_scenario::expect::TraceEnd;
use onescan_scenario::file::ClientFile;
use onescan_scenario::report::Report;
use onescan_server::end::{Failure as EndedBy, FailureCause};

use super::CampaignError;
use super::config::WorkerConfig;
use super::probe::{Probe, Seen};
use super::reading::{Failure, Reading};
use crate::error::Usage;
use crate::interrupt::Interrupt;
use crate::regress::limited::end_with_parent;
use crate::run::{RunConfig, RunStatus, one_run};

/// Does the run and writes what was read out of it to `out`.
///
/// # Errors
/// The input is wrong.
pub fn work(config: &WorkerConfig, out: &mut dyn Write) -> Result<(), CampaignError> {
    end_with_parent();
    let reading = read(config)?;
    serde_json::to_writer(&mut *out, &reading).map_err(|error| OutputError(error.into()))?;
    Ok(out.flush().map_err(OutputError)?)
}

fn read(config: &WorkerConfig) -> Result<Reading, CampaignError> {
    let scenario = Scenario::load(&config.scenario)?;
    let catalogue = Catalogue::load(scenario.folder())?;
    let gone = |name: &str| Usage::new(format!("the scenario has no `{name}` any more"), None);
    let campaign = catalogue.campaigns().iter().find(|campaign| campaign.name == config.campaign);
    let campaign = campaign.ok_or_else(|| gone(&config.campaign))?;
    let case = match &config.case {
        None => &campaign.healthy,
        Some(name) => campaign.cases.iter().find(|case| case.name == *name).ok_or_else(|| gone(name))?,
    };
    let measures = scenario.campaign_measures(&catalogue, campaign)?;
    let scenario = scenario.with_case(&catalogue, case)?;
    let seen = Rc::new(RefCell::new(Seen::nothing(&measures)));
    let probe = Probe::new(&measures, scenario.injected(), Rc::clone(&seen));
    let run = RunConfig::headless(config.scenario.clone(), config.case.clone());
    let report = one_run(&run, &scenario, 1, &Interrupt::new(), vec![Box::new(probe)])?.report;
    let end = if report.status == RunStatus::Completed { TraceEnd::Complete } else { TraceEnd::Cut };
    let seen = seen.replace(Seen::nothing(&measures));
    Ok(Reading {
        digest: report.digest.map(|digest| digest.to_string()),
        virtual_time_ns: report.virtual_time.as_nanos(),
        // without `[report]` a scenario has no alarms
        alarms: report.report.as_ref().map(came).unwrap_or_default(),
        failure: report.failure.as_ref().map(|failure| told(&scenario, failure)),
        ..seen.reading(&measures, end)
    })
}

/// The alarms that came, and how often.
fn came(report: &Report) -> BTreeMap<String, u64> {
    let totals = report.alarms.iter().flat_map(|alarms| &alarms.totals);
    totals.filter(|alarm| alarm.count > 0).map(|alarm| (alarm.name.clone(), alarm.count)).collect()
}

fn told(scenario: &Scenario, failure: &EndedBy) -> Failure {
    let client = scenario.file().clients.get(&failure.client).map(toml::Spanned::get_ref);
    let place = if let FailureCause::Fault(fault) = &failure.cause { fault.place.clone() } else { None };
    Failure { text: failure.to_string(), of_plc: matches!(client, Some(ClientFile::SoftPlc { .. })), place }
}
