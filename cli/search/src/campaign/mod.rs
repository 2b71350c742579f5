//! `onescan campaign`: every fault of a campaign with every activation, and a verdict for each.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`journal`] | what has been done, kept in a folder |
//! | [`worker`] | one run, in a process of its own |
//! | [`probe`] | what is read out of it while it goes |
//! | `rejoin` | where it comes together with the run without faults |
//! | [`reading`] | what a process says of its run |
//! | [`table`] | the verdicts, by fault and activation |
//! | [`summary`] | for people and as JSON |
//! | [`reports`] | a page, and the format of `JUnit` |
//!
//! The run without faults comes first, and leaves a checkpoint wherever a case departs from it: what a run has in common
//! with that one is not run again.
//!
//! **Invariants.** What is said of a campaign depends on its runs alone, not on which was done first or how many went
//! at a time. A run is what `onescan run --case` does of the same name.

pub mod config;
mod error;
mod journal;
pub mod probe;
pub mod reading;
mod rejoin;
pub mod reports;
pub mod summary;
pub mod table;
pub mod worker;

use std::collections::BTreeMap;
use std::io::Write;
use std::process::Command;

use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::case::{Campaign, Catalogue};
use onescan_server::time::{TimeSpan, VirtualTime};
use serde::de::DeserializeOwned;

pub use config::CampaignConfig;
pub use error::CampaignError;

use crate::forest;
use config::{Begun, Chosen, MergeConfig, Reports};
use error::Ended;
use journal::{Done, Subject, Work};
use onescan_regress::regress::pool::{answer, this_program};
use onescan_runner::error::{ExitCode, Usage};
use onescan_runner::format::Format;
use reading::{BaseRuns, Reading, Way};
use table::{Row, Table};

/// Runs the campaigns that `config` asks for, and writes what came of them to `out`.
///
/// # Errors
/// The scenario or a campaign is wrong, or a run came to nothing.
pub fn run(config: &CampaignConfig, out: &mut dyn Write) -> Result<ExitCode, CampaignError> {
    let scenario = Scenario::load(&config.chosen.scenario)?;
    let catalogue = scenario.catalogue()?;
    let chosen = chosen(&config.chosen, &catalogue)?;
    // What is wrong with any of them is reported before anything runs.
    for campaign in &chosen {
        scenario.check_campaign(&catalogue, campaign)?;
    }
    let tried = chosen.into_iter().map(|campaign| Ok((campaign, tried(config, &scenario, campaign)?)));
    let tried: Vec<(&Campaign, Done)> = tried.collect::<Result<_, CampaignError>>()?;
    if let Some(part) = config.partition {
        let counts = tried.iter().map(|(campaign, done)| (campaign.name.as_str(), done.readings.len()));
        summary::write_part(config.reports.format, part, counts, out).map_err(OutputError)?;
        return Ok(ExitCode::Ok);
    }
    let table = |(campaign, done): (&Campaign, Done)| table_of(&config.chosen, &scenario, &catalogue, campaign, done);
    let tables = tried.into_iter().map(table).collect::<Result<Vec<_>, _>>()?;
    report(&config.reports, &tables, out)
}

/// Puts the parts of campaigns together that were done on several machines, and writes what came of them to `out`: the
/// same as if they had been done on one.
///
/// # Errors
/// A part is missing, or is of something else.
pub fn merge(config: &MergeConfig, out: &mut dyn Write) -> Result<ExitCode, CampaignError> {
    let scenario = Scenario::load(&config.chosen.scenario)?;
    let catalogue = scenario.catalogue()?;
    let mut tables = Vec::new();
    for campaign in chosen(&config.chosen, &catalogue)? {
        let subject = Subject::of(&scenario, campaign)?;
        let mut all = Done::default();
        for folder in &config.folders {
            let part = Work::read(folder, &subject)?;
            if part.healthy.is_some() && all.healthy.is_some() && part.healthy != all.healthy {
                let message = format!("{}: its run without faults is another one", folder.display());
                return Err(Usage::new(message, Some("do this part again".to_owned())).into());
            }
            all.healthy = all.healthy.or(part.healthy);
            all.readings.extend(part.readings);
        }
        tables.push(table_of(&config.chosen, &scenario, &catalogue, campaign, all)?);
    }
    report(&config.reports, &tables, out)
}

fn report(reports: &Reports, tables: &[Table], out: &mut dyn Write) -> Result<ExitCode, CampaignError> {
    match reports.format {
        Format::Human => summary::write_human(tables, out),
        Format::Json => summary::write_json(tables, out),
    }
    .map_err(OutputError)?;
    if let Some(path) = &reports.html {
        file::write_output(path, reports::page(tables).to_html().as_bytes())?;
    }
    if let Some(path) = &reports.junit {
        file::write_output(path, reports::junit(tables).as_bytes())?;
    }
    let is_passed = tables.iter().all(Table::is_passed);
    Ok(if is_passed { ExitCode::Ok } else { ExitCode::Unmet })
}

/// The campaigns that are asked for.
fn chosen<'c>(wanted: &Chosen, catalogue: &'c Catalogue) -> Result<Vec<&'c Campaign>, Usage> {
    let all = catalogue.campaigns();
    if all.is_empty() {
        let help = "write a `[[campaign]]` into its `cases.toml` (docs/campaigns.md)".to_owned();
        return Err(Usage::new("the scenario has no campaign", Some(help)));
    }
    let Some(name) = &wanted.campaign else { return Ok(all.iter().collect()) };
    let names = || all.iter().map(|campaign| campaign.name.as_str());
    let found = all.iter().find(|campaign| campaign.name == *name);
    found.map(|campaign| vec![campaign]).ok_or_else(|| {
        let help = onescan_server::signal::did_you_mean(name, names());
        let help = help.unwrap_or_else(|| format!("its campaigns are {}", names().collect::<Vec<_>>().join(", ")));
        Usage::new(format!("the scenario has no campaign `{name}`"), Some(help))
    })
}

/// All runs of a campaign that are to be done here, the one without faults first.
fn tried(config: &CampaignConfig, scenario: &Scenario, campaign: &Campaign) -> Result<Done, CampaignError> {
    let subject = Subject::of(scenario, campaign)?;
    let (work, mut done) = Work::open(config.keep.as_deref(), &subject)?;
    let base_runs = if let Some(base_runs) = done.healthy.take() {
        base_runs
    } else {
        let base_runs: BaseRuns = asked(&mut worker(&config.chosen, campaign, &work)?, config.timeout, &campaign.name)?;
        work.healthy(&base_runs)?;
        base_runs
    };
    for (number, (reading, (variant, _))) in base_runs.readings.iter().zip(&campaign.variants).enumerate() {
        // That another program fails is a finding; that the scenario's own does leaves nothing to compare with.
        let is_own = campaign.own_program_of(number) == number;
        if let Some(failure) = reading.failure.as_ref().filter(|_| is_own) {
            let text = format!("without any fault: {}", failure.text);
            return Err(
                Ended { name: format!("{}{variant}", campaign.name), text, code: ExitCode::Fault as i32 }.into()
            );
        }
    }
    let is_ours = |number: usize| config.partition.is_none_or(|part| part.has(number));
    let todo: Vec<(&str, Way)> = ways(campaign, &base_runs)
        .enumerate()
        .filter(|(number, (name, way))| is_ours(*number) && *way != Way::Never && !done.readings.contains_key(*name))
        .map(|(_, one)| one)
        .collect();
    let batches = forest::batches(config.jobs, &todo);
    let shown = (config.progress, "batches of runs");
    let read = forest::each(config.jobs, &batches, shown, |cases| batch(config, campaign, &work, cases))?;
    done.readings.extend(todo.iter().map(|(name, _)| (*name).to_owned()).zip(read.into_iter().flatten()));
    done.healthy = Some(base_runs);
    Ok(done)
}

/// Some runs with faults. If their process comes to nothing each is done by itself, so that one that crashes takes no
/// other with it.
fn batch(
    config: &CampaignConfig,
    campaign: &Campaign,
    work: &Work,
    cases: &[(&str, Way)],
) -> Result<Vec<Reading>, CampaignError> {
    let together = |cases: &[(&str, Way)]| {
        let mut command = worker(&config.chosen, campaign, work)?;
        command.arg("--journal").arg(work.journal());
        for (name, way) in cases {
            let at = if let Way::Fork(t_ns) = way { Some(VirtualTime::from_nanos(*t_ns)) } else { None };
            command.arg("--case").arg(Begun { case: (*name).to_owned(), at }.to_string());
        }
        let name = cases.first().map_or(campaign.name.as_str(), |(name, _)| name);
        let timeout = config.timeout.times(cases.len() as u64).unwrap_or(config.timeout);
        let readings: Vec<Reading> = asked(&mut command, timeout, name)?;
        if readings.len() == cases.len() {
            return Ok(readings);
        }
        let text = format!("{} runs were asked for, {} were reported", cases.len(), readings.len());
        Err(Ended { name: name.to_owned(), text, code: ExitCode::Fault as i32 }.into())
    };
    match together(cases) {
        Err(CampaignError::Ended(ended)) if cases.len() > 1 => {
            tracing::info!(%ended, "a process of {} runs came to nothing: each is done by itself", cases.len());
            cases.iter().map(|case| finished(case.0, together(std::slice::from_ref(case)))).collect()
        }
        done => match cases {
            [(name, _)] => finished(name, done).map(|one| vec![one]),
            _ => done,
        },
    }
}

/// The reading of the run `name`. Of one that came to nothing it is known only that it did: it is done again when the
/// campaign is gone on with, because it is not in the journal.
fn finished(name: &str, done: Result<Vec<Reading>, CampaignError>) -> Result<Reading, CampaignError> {
    match done {
        Ok(readings) => <[Reading; 1]>::try_from(readings).map(|[reading]| reading).map_err(|others| {
            let text = format!("1 run was asked for, {} were reported", others.len());
            Ended { name: name.to_owned(), text, code: ExitCode::Fault as i32 }.into()
        }),
        Err(CampaignError::Ended(ended)) if ended.code != ExitCode::WrongInput as i32 => {
            Ok(Reading { unfinished: Some(ended.text), ..Reading::default() })
        }
        Err(error) => Err(error),
    }
}

/// Where the run of each case begins.
fn ways<'a>(campaign: &'a Campaign, base_runs: &'a BaseRuns) -> impl Iterator<Item = (&'a str, Way)> {
    campaign.cases.iter().map(|case| case.name.as_str()).zip(base_runs.ways.iter().copied())
}

/// The verdicts of a campaign of which all is done.
fn table_of(
    chosen: &Chosen,
    scenario: &Scenario,
    catalogue: &Catalogue,
    campaign: &Campaign,
    Done { healthy, mut readings }: Done,
) -> Result<Table, CampaignError> {
    let missing = |what: String| {
        let help = "do the part that has it, and name its folder, too".to_owned();
        Usage::new(format!("campaign `{}` is not complete: {what} missing", campaign.name), Some(help))
    };
    let base_runs = healthy.ok_or_else(|| missing("the run without faults is".to_owned()))?;
    let ways: BTreeMap<&str, Way> = ways(campaign, &base_runs).collect();
    let is_done = |name: &str| readings.contains_key(name) || ways.get(name) == Some(&Way::Never);
    let open: Vec<&str> = campaign.cases.iter().map(|case| case.name.as_str()).filter(|name| !is_done(name)).collect();
    if let Some(first) = open.first() {
        let verb = if open.len() == 1 { "is" } else { "are" };
        let what = format!("{} of {} runs, `{first}` first, {verb}", open.len(), campaign.cases.len());
        return Err(missing(what).into());
    }
    let measures = scenario.campaign_measures(catalogue, campaign)?;
    let mut rows = Vec::with_capacity(campaign.cases.len());
    for (number, case) in campaign.cases.iter().enumerate() {
        let Some(healthy) = base_runs.readings.get(campaign.variant_of(number)) else {
            return Err(missing("a run without faults is".to_owned()).into());
        };
        let Some(injected) = scenario.clone().with_case(catalogue, case)?.injected() else {
            let text = "the case brings nothing into the run".to_owned();
            return Err(Ended { name: case.name.clone(), text, code: ExitCode::Fault as i32 }.into());
        };
        let reading = readings.remove(&case.name).unwrap_or_else(|| healthy.clone());
        let row = table::row(case, reading, healthy, &measures.readouts, &injected.signals);
        rows.push(Row { program: campaign.program_of(campaign.variant_of(number)).map(str::to_owned), ..row });
    }
    Ok(Table::new(&chosen.scenario, campaign, base_runs.readings, rows))
}

/// A process for runs.
fn worker(chosen: &Chosen, campaign: &Campaign, work: &Work) -> Result<Command, CampaignError> {
    let mut command = this_program("campaign-worker")?;
    command.arg("--scenario").arg(&chosen.scenario).arg("--campaign").arg(&campaign.name);
    command.arg("--forks").arg(work.forks());
    if chosen.no_merge {
        command.arg("--no-merge");
    }
    Ok(command)
}

/// What the process of the run `name` says.
fn asked<T: DeserializeOwned>(command: &mut Command, timeout: TimeSpan, name: &str) -> Result<T, CampaignError> {
    let answered = answer(command, timeout)?;
    Ok(answered.map_err(|(text, code)| Ended { name: name.to_owned(), text, code })?)
}
