//! One run of a campaign, in a process of its own.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use onescan_base::regular::{self, Limit};
use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::apply::departure::Departure;
use onescan_scenario::apply::measure::{CampaignMeasures, Over};
use onescan_scenario::case::{Campaign, Catalogue};
use onescan_scenario::expect::TraceEnd;
use onescan_scenario::file::ClientFile;
use onescan_scenario::report::Report;
use onescan_server::end::{Failure as EndedBy, FailureCause};
use onescan_server::observer::Observer;
use onescan_server::time::VirtualTime;

use super::CampaignError;
use super::config::{Begun, Part, WorkerConfig};
use super::journal;
use super::probe::{Probe, Track, Watch};
use super::reading::{BaseRuns, Failure, Reading, Way};
use super::rejoin::{self, Ahead, Images};
use onescan_regress::regress::limited::end_with_parent;
use onescan_runner::error::{Unreadable, Usage};
use onescan_runner::interrupt::Interrupt;
use onescan_runner::run::fork::Fork;
use onescan_runner::run::production::Metered;
use onescan_runner::run::{ForkRequest, Ran, RunConfig, RunStatus, one_run};

/// Does the run and writes what was read out of it to `out`.
///
/// # Errors
/// The input is wrong.
pub fn work(config: &WorkerConfig, out: &mut dyn Write) -> Result<(), CampaignError> {
    end_with_parent()?;
    let scenario = Scenario::load(&config.scenario)?;
    let catalogue = scenario.catalogue()?;
    let gone = |name: &str| Usage::new(format!("the scenario has no `{name}` any more"), None);
    let campaign = catalogue.campaigns().iter().find(|campaign| campaign.name == config.campaign);
    let campaign = campaign.ok_or_else(|| gone(&config.campaign))?;
    let measures = scenario.campaign_measures(&catalogue, campaign)?;
    let written = match &config.part {
        Part::Healthy => {
            let mut base_runs = BaseRuns { readings: Vec::new(), ways: vec![Way::Start; campaign.cases.len()] };
            for variant in 0..campaign.variants.len() {
                let (reading, ways) = healthy(config, (&scenario, &catalogue, campaign), &measures, variant)?;
                base_runs.readings.push(reading);
                let own = base_runs.ways.iter_mut().skip(variant).step_by(campaign.variants.len());
                own.zip(ways).for_each(|(way, found)| *way = found);
            }
            serde_json::to_writer(&mut *out, &base_runs)
        }
        Part::Cases { cases, journal } => {
            let mut readings = Vec::with_capacity(cases.len());
            let mut aheads: BTreeMap<usize, Option<Rc<Ahead>>> = BTreeMap::new();
            for begun in cases {
                let found = campaign.cases.iter().enumerate().find(|(_, case)| case.name == begun.case);
                let (number, case) = found.ok_or_else(|| gone(&begun.case))?;
                let scenario = scenario.clone().with_case(&catalogue, case)?;
                let variant = campaign.variant_of(number);
                let forks = journal::of_variant(&config.forks, variant);
                let ahead = match aheads.get(&variant) {
                    Some(ahead) => Option::clone(ahead),
                    None if config.no_merge => None,
                    None => {
                        let ahead = Ahead::of(&forks)?;
                        aheads.insert(variant, ahead.clone());
                        ahead
                    }
                };
                let reading = with_fault(config, &scenario, &measures, (begun, &forks, ahead))?;
                journal::note_done(journal, &begun.case, &reading)?;
                readings.push(reading);
            }
            serde_json::to_writer(&mut *out, &readings)
        }
    };
    written.map_err(|error| OutputError(error.into()))?;
    Ok(out.flush().map_err(OutputError)?)
}

/// The run of a case.
fn with_fault(
    config: &WorkerConfig,
    scenario: &Scenario,
    measures: &CampaignMeasures,
    (begun, forks, ahead): (&Begun, &Path, Option<Rc<Ahead>>),
) -> Result<Reading, CampaignError> {
    let mut run = RunConfig::headless(config.scenario.clone(), Some(begun.case.clone()));
    let ahead = ahead.filter(|ahead| ahead.is_of(scenario.plan()));
    let mut probing = Probing { ahead, ..Probing::new(scenario, measures) };
    if let Some(at) = begun.at {
        run.course.resume = Some(ForkRequest::fork_file(forks, at));
        probing = probing.forking(tracks_of(forks, at)?);
    }
    Ok(probing.run(run)?.reading)
}

/// The run without faults of a variant, with a checkpoint wherever a case departs from it: what was read out of it, and
/// where each of its cases begins.
fn healthy(
    config: &WorkerConfig,
    (scenario, catalogue, campaign): (&Scenario, &Catalogue, &Campaign),
    measures: &CampaignMeasures,
    variant: usize,
) -> Result<(Reading, Vec<Way>), CampaignError> {
    let Some((_, case)) = campaign.variants.get(variant) else { return Ok((Reading::default(), Vec::new())) };
    let healthy = scenario.clone().with_case(catalogue, case)?;
    let cases = campaign.cases.iter().skip(variant).step_by(campaign.variants.len());
    let departure = |case| Ok(scenario.clone().with_case(catalogue, case)?.departs_from(&healthy));
    let departures: Vec<Departure> = cases.map(departure).collect::<Result<_, CampaignError>>()?;
    let from_checkpoints = || departures.iter().filter(|departure| !departure.from_start);
    let mut times: Vec<VirtualTime> = from_checkpoints().filter_map(|departure| departure.at).collect();
    times.sort_unstable();
    times.dedup();
    let mut conditions = Vec::new();
    for condition in from_checkpoints().flat_map(|departure| &departure.conditions) {
        if !conditions.contains(condition) {
            conditions.push(condition.clone());
        }
    }
    let folder = journal::of_variant(&config.forks, variant);
    let (step, until) = (healthy.plan().step(), healthy.until());
    let states = if config.no_merge { Vec::new() } else { rejoin::boundaries(&departures, step, until) };
    let mut probing = Probing::new(&healthy, measures);
    if let Some(first) = states.first() {
        file::create_folder(&folder)?;
        probing.images = Some(Images::new(&folder, *first, until));
    }
    let mut run = RunConfig::headless(config.scenario.clone(), None);
    run.course.forks = Some(ForkRequest { folder: folder.clone(), times, states, conditions });
    let Probed { reading, ran, kept } = probing.run(run)?;
    if let Some(state) = ran.state.filter(|_| ran.unsaved.is_none()) {
        Ahead::leave(&folder, &ran.states, (step, ran.report.virtual_time, state))?;
    }
    if let Some(error) = &ran.unsaved {
        tracing::info!(%error, "no run forks from the one without faults: all begin at the start");
    }
    for (t_ns, tracks) in kept.into_iter().filter(|(t_ns, _)| ran.forks.iter().any(|fork| fork.t_v.as_nanos() == *t_ns))
    {
        let text = serde_json::to_vec(&tracks).map_err(|error| OutputError(error.into()))?;
        file::write_whole(&tracks_file(&folder, VirtualTime::from_nanos(t_ns)), &text)?;
    }
    let way = |departure| if ran.unsaved.is_some() { Way::Start } else { way(departure, &ran.forks) };
    Ok((reading, departures.iter().map(way).collect()))
}

/// Where a case forks that departs so: at the first of these checkpoints that it needs.
fn way(departure: &Departure, forks: &[Fork]) -> Way {
    if departure.from_start {
        return Way::Start;
    }
    let of_condition = |fork: &&Fork| fork.coming.iter().any(|when| departure.conditions.contains(when));
    let condition = forks.iter().find(of_condition).map(|fork| fork.t_v);
    match [departure.at, condition].into_iter().flatten().min() {
        Some(t_v) if forks.iter().any(|fork| fork.t_v == t_v) => Way::Fork(t_v.as_nanos()),
        Some(_) => Way::Start,
        None => Way::Never,
    }
}

fn tracks_file(folder: &Path, t_v: VirtualTime) -> PathBuf {
    ForkRequest::fork_file(folder, t_v).with_extension("json")
}

fn tracks_of(folder: &Path, t_v: VirtualTime) -> Result<Vec<Track>, CampaignError> {
    let path = tracks_file(folder, t_v);
    let bytes = regular::read(&path, Limit::DATA).map_err(Unreadable::at(&path))?;
    let damaged = |error: serde_json::Error| Usage::new(format!("{} is damaged: {error}", path.display()), None);
    Ok(serde_json::from_slice(&bytes).map_err(damaged)?)
}

/// A run that is about to be probed.
struct Probing<'a> {
    scenario: &'a Scenario,
    measures: &'a CampaignMeasures,
    metered: Metered,
    probe: Probe,
    /// Keeps its images for others.
    images: Option<Images>,
    /// The run without faults, with which it may come together.
    ahead: Option<Rc<Ahead>>,
}

/// A run that was probed.
struct Probed {
    reading: Reading,
    ran: Ran,
    /// Virtual time of each checkpoint in nanoseconds, and the trajectories up to there.
    kept: Vec<(u64, Vec<Track>)>,
}

impl<'a> Probing<'a> {
    fn new(scenario: &'a Scenario, measures: &'a CampaignMeasures) -> Self {
        let metered = Metered::new(scenario.measures());
        let probe = Probe::new(measures, scenario.injected()).metering(&metered, scenario.measures());
        Self { scenario, measures, metered, probe, images: None, ahead: None }
    }

    fn forking(self, tracks: Vec<Track>) -> Self {
        Self { probe: self.probe.forking(tracks), ..self }
    }

    /// Does the run to its end, with its state there as a hash; or to where it comes together with the run without faults,
    /// whose images it goes on with.
    fn run(self, mut run: RunConfig) -> Result<Probed, CampaignError> {
        run.course.state_at_end = true;
        if let Some(ahead) = &self.ahead {
            let over = self.scenario.injected().map_or(Over::Never, |injected| injected.over);
            run.course.join = ahead.states(over);
        }
        let probe = Rc::new(RefCell::new(self.probe));
        let mut observers: Vec<Box<dyn Observer>> = vec![Box::new(Watch(Rc::clone(&probe)))];
        observers.extend(self.images.map(|images| -> Box<dyn Observer> { Box::new(images) }));
        let ran = one_run(&run, self.scenario, 1, &Interrupt::new(), observers)?;
        let report = &ran.report;
        let mut reading = Reading {
            digest: report.digest.map(|digest| digest.to_string()),
            virtual_time_ns: report.virtual_time.as_nanos(),
            failure: report.failure.as_ref().map(|failure| failure_of(self.scenario, failure)),
            state: ran.state.map(|state| state.to_string()),
            ..Reading::default()
        };
        let mut probe = probe.borrow_mut();
        if let Some((joined, ahead)) = ran.joined.as_ref().zip(self.ahead) {
            probe.look_on(ahead.after(joined.t_v));
            let mut digest = joined.digest.clone();
            ahead.after(joined.t_v).for_each(|(_, image)| digest.step(image));
            reading.digest = Some(digest.value().to_string());
            reading.virtual_time_ns = ahead.end_ns();
            reading.state = Some(ahead.state().to_owned());
            reading.joined_ns = Some(joined.t_v.as_nanos());
        }
        let end = if report.status == RunStatus::Completed { TraceEnd::Complete } else { TraceEnd::Cut };
        let mut seen = probe.take_seen();
        let kept = std::mem::take(&mut seen.kept);
        // without `[report]` a scenario has no alarms
        reading.alarms = self.metered.report().as_ref().map(came).unwrap_or_default();
        Ok(Probed { reading: seen.reading(self.measures, end, reading), ran, kept })
    }
}

/// The alarms that came, and how often.
fn came(report: &Report) -> BTreeMap<String, u64> {
    let totals = report.alarms.iter().flat_map(|alarms| &alarms.totals);
    totals.filter(|alarm| alarm.count > 0).map(|alarm| (alarm.name.clone(), alarm.count)).collect()
}

fn failure_of(scenario: &Scenario, failure: &EndedBy) -> Failure {
    let client = scenario.file().clients.get(&failure.client).map(toml::Spanned::get_ref);
    let place = if let FailureCause::Fault(fault) = &failure.cause { fault.place.clone() } else { None };
    Failure { text: failure.to_string(), of_plc: matches!(client, Some(ClientFile::SoftPlc { .. })), place }
}
