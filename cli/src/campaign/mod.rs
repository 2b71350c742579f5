//! `onescan campaign`: every fault of a campaign with every activation, and a verdict for each.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`worker`] | one run, in a process of its own |
//! | [`probe`] | what is read out of it while it goes |
//! | [`reading`] | what a process says of its run |
//! | [`table`] | the verdicts, by fault and activation |
//! | [`summary`] | for people and as JSON |
//! | [`reports`] | a page, and the format of `JUnit` |
//!
//! **Invariants.** What is said of a campaign depends on its runs alone, not on which was done first or how many went
//! at a time. A run is what `onescan run --case` does of the same name.

pub mod config;
mod error;
pub mod probe;
pub mod reading;
pub mod reports;
pub mod summary;
pub mod table;
pub mod worker;

use std::io::Write;
use std::time::Instant;

use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::case::{Campaign, Case, Catalogue};

pub use config::CampaignConfig;
pub use error::CampaignError;

use crate::error::{ExitCode, Usage};
use crate::format::Format;
use crate::regress::pool::{answer, bar, spread, this_program};
use reading::Reading;
use table::Table;

/// Runs the campaigns that `config` asks for, and writes what came of them to `out`.
///
/// # Errors
/// The scenario or a campaign is wrong, or a run came to nothing.
pub fn run(config: &CampaignConfig, out: &mut dyn Write) -> Result<ExitCode, CampaignError> {
    let started = Instant::now();
    let scenario = Scenario::load(&config.scenario)?;
    let catalogue = Catalogue::load(scenario.folder())?;
    let mut tables = Vec::new();
    let chosen = chosen(config, &catalogue)?;
    // What is wrong with any of them is reported before anything runs.
    for campaign in &chosen {
        scenario.check_campaign(&catalogue, campaign)?;
    }
    for campaign in chosen {
        tables.push(tried(config, &scenario, &catalogue, campaign)?);
    }
    match config.format {
        Format::Human => summary::write_human(&tables, out),
        Format::Json => summary::write_json(&tables, out),
    }
    .map_err(OutputError)?;
    let wall = started.elapsed();
    if let Some(path) = &config.html {
        file::write_whole(path, reports::page(&tables, wall).to_html().as_bytes())?;
    }
    if let Some(path) = &config.junit {
        file::write_whole(path, reports::junit(&tables, wall).as_bytes())?;
    }
    let is_passed = tables.iter().all(Table::is_passed);
    Ok(if is_passed { ExitCode::Ok } else { ExitCode::Unmet })
}

/// The campaigns that are asked for.
fn chosen<'c>(config: &CampaignConfig, catalogue: &'c Catalogue) -> Result<Vec<&'c Campaign>, Usage> {
    let all = catalogue.campaigns();
    if all.is_empty() {
        let help = "write a `[[campaign]]` into its `cases.toml` (docs/campaigns.md)".to_owned();
        return Err(Usage::new("the scenario has no campaign", Some(help)));
    }
    let Some(name) = &config.campaign else { return Ok(all.iter().collect()) };
    let names = || all.iter().map(|campaign| campaign.name.as_str());
    let found = all.iter().find(|campaign| campaign.name == *name);
    found.map(|campaign| vec![campaign]).ok_or_else(|| {
        let help = onescan_server::signal::did_you_mean(name, names());
        let help = help.unwrap_or_else(|| format!("its campaigns are {}", names().collect::<Vec<_>>().join(", ")));
        Usage::new(format!("the scenario has no campaign `{name}`"), Some(help))
    })
}

/// All runs of a campaign, the one without faults first.
fn tried(
    config: &CampaignConfig,
    scenario: &Scenario,
    catalogue: &Catalogue,
    campaign: &Campaign,
) -> Result<Table, CampaignError> {
    let cases: Vec<Option<&Case>> = std::iter::once(None).chain(campaign.cases.iter().map(Some)).collect();
    let bar = bar(config.progress, cases.len(), "runs");
    let read = spread(config.jobs, cases.len(), &bar, |index| one(config, campaign, cases[index]));
    let mut readings = Vec::with_capacity(read.len());
    for (case, read) in cases.iter().zip(read) {
        let name = case.map_or(campaign.name.as_str(), |case| case.name.as_str());
        readings.push(read?.map_err(|(text, code)| error::Ended { name: name.to_owned(), text, code })?);
    }
    let healthy = readings.remove(0);
    if let Some(failure) = &healthy.failure {
        let error = format!("without any fault: {}", failure.text);
        return Err(error::Ended { name: campaign.name.clone(), text: error, code: ExitCode::Fault as i32 }.into());
    }
    let measures = scenario.campaign_measures(catalogue, campaign)?;
    let mut rows = Vec::with_capacity(readings.len());
    for (case, reading) in campaign.cases.iter().zip(readings) {
        let injected = scenario.clone().with_case(catalogue, case)?.injected();
        let Some(injected) = injected else {
            let text = "the case brings nothing into the run".to_owned();
            return Err(error::Ended { name: case.name.clone(), text, code: ExitCode::Fault as i32 }.into());
        };
        rows.push(table::row(case, reading, &healthy, &measures.readouts, &injected.signals));
    }
    Ok(Table::new(config, campaign, healthy, rows))
}

/// One run, in a process of its own; one that crashes takes no other with it.
fn one(
    config: &CampaignConfig,
    campaign: &Campaign,
    case: Option<&Case>,
) -> Result<Result<Reading, (String, i32)>, CampaignError> {
    let mut command = this_program("campaign-worker")?;
    command.arg("--scenario").arg(&config.scenario).arg("--campaign").arg(&campaign.name);
    if let Some(case) = case {
        command.arg("--case").arg(&case.name);
    }
    Ok(answer(&mut command, config.timeout)?)
}
