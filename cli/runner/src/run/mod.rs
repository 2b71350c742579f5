//! Runs of a scenario: one after the other, each reported, recorded and plotted.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | `alarms` | alarms noted for a page as they come and go |
//! | `check` | options that contradict each other |
//! | [`coverage`] | which statements and branches were executed |
//! | [`error`] | why nothing came of it |
//! | [`lockstep`] | one run in lockstep |
//! | [`processes`] | clients as processes of their own |
//! | [`guard`] | who ends these if this process cannot |
//! | `fork` | checkpoints from which other cases fork |
//! | `kept_case` | what operators did in a run, as a case |
//! | [`freewheel`] | one run without lockstep |
//! | [`progress`] | a bar on a terminal |
//! | `chosen` | signals chosen by name, as numbers |
//! | [`sampler`] | what a plot shows |
//! | [`maps`] | tables of values as they are at the end |
//! | `notices` | what the scenario leaves open, said once |
//! | `plc_files` | files of PLCs as they are at the end |
//! | [`recorded`] | a run's recording |
//! | `record_lock` | one records into a folder at a time |
//! | [`cut_short`] | recordings that do not hold all of their run |
//! | `in_process` | a session of which all clients are here |
//! | `at_start` | values of signals with which it begins |
//! | `judged` | the same, judged step by step |
//! | `search` | why a search through many runs came to nothing |
//! | [`rerun`] | a recorded run once more |
//! | [`forked`] | the past of a run, for its page |
//! | [`expectation`] | what a run had to show |
//! | [`production`] | what a run produced, by its scenario's `[report]` |
//! | [`watch`] | what watched variables were |
//! | [`page`] | all runs as a page |
//! | [`report`] | what came of a run, for people and machines |
//! | `seats` | clients that take part over OPC UA |
//! | `staying` | the page of a run that is over |
//! | [`session_log`] | which client a session waited for |

pub(crate) mod alarms;
mod at_start;
mod check;
pub mod chosen;
pub mod config;
pub mod coverage;
pub mod cut_short;
mod error;
pub mod expectation;
pub mod fork;
pub(crate) mod forked;
pub(crate) mod freewheel;
pub mod guard;
pub(crate) mod in_process;
pub mod judged;
mod kept_case;
mod lockstep;
pub mod maps;
pub(crate) mod notices;
pub mod page;
mod plc_files;
mod processes;
pub mod production;
mod progress;
mod record_lock;
pub mod recorded;
pub mod report;
pub mod rerun;
pub mod sampler;
mod search;
mod seats;
pub mod session_log;
mod staying;
pub mod watch;

use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;
use std::time::Instant;

use onescan_report::OutputError;
use onescan_report::file;
use onescan_report::plot::Plot;
use onescan_report::view::Side;
use onescan_scenario::expect::TraceEnd;
use onescan_scenario::{Mode, Scenario};
use onescan_server::checkpoint::StateHash;
use onescan_server::client::{ClientView, ValueTable};
use onescan_server::lockstep::Lockstep;
use onescan_server::observer::Observer;
use onescan_server::time::VirtualTime;

pub use at_start::values_at_start;
use config::{Drawing, WatchOn};
pub use config::{ForkRequest, RunConfig, Transport};
pub use error::RunError;
use fork::{Fork, Joined, Taken};
use lockstep::Driven;
pub use lockstep::operator_inputs;
pub use report::{RunReport, RunStatus, Verdict};
pub use search::SearchError;

use crate::interrupt::Interrupt;
use crate::scene_drawing;
use crate::web::VerdictBoard;
use expectation::{Copyist, Witness};
use page::{Drawings, Event};
use production::Metered;
use recorded::{Recorded, refuse_to_overwrite};
use sampler::{Sampler, Samples};
use session_log::SessionLog;
use staying::Staying;
use watch::WatchReport;

/// Runs a scenario as `config` asks, and writes a report of each run to `out`.
///
/// # Errors
/// See [`RunError`]. A failed client is not an error here but a verdict: what there is of the run is
/// recorded, plotted and reported.
pub fn execute(config: &RunConfig, interrupt: &Interrupt, out: &mut dyn Write) -> Result<Verdict, RunError> {
    let mut scenario = Scenario::load_case(&config.subject.scenario, config.subject.case.as_deref())?;
    // A page says what was executed where that is seen.
    if config.reports.coverage.is_some()
        || (config.reports.html.is_some() && config.reach.transport == Transport::Inproc)
    {
        scenario.cover();
    }
    for (client, url) in &config.reach.gateways {
        scenario.commission(client, url.clone())?;
    }
    for client in &config.reach.operated {
        scenario.operate(client)?;
    }
    if config.course.accept_code {
        scenario.accept_code();
    }
    if config.doors.ads.is_some() || config.reports.files.is_some() {
        scenario.show_memories();
    }
    config.check(&scenario)?;
    if let Some(request) = &config.reports.record {
        refuse_to_overwrite(request, config.runs)?;
    }
    if !config.watch.variables.is_empty() {
        scenario.watch(&config.watch.variables, config.watch.on == WatchOn::Change)?;
    }
    notices::warn(&scenario)?;
    notices::warn_of_length(&scenario, config.subject.end(&scenario));
    let mut reports: Vec<RunReport> = Vec::new();
    let (mut samples, mut unsaved, mut last) = (Vec::new(), None, ClientView::default());
    let mut staying = None;
    for number in 1..=config.runs {
        let ran = one_run(config, &scenario, number, interrupt, Vec::new())?;
        ran.report.write(config.reports.format, config.runs, reports.last(), out).map_err(OutputError)?;
        reports.push(ran.report);
        samples.push(ran.samples);
        last = ran.last;
        staying = ran.staying;
        unsaved = unsaved.or(ran.unsaved);
        if interrupt.is_raised() || reports.iter().any(RunReport::is_failed) {
            break;
        }
    }
    if let (Some(request), Some(sink)) = (&config.reports.coverage, scenario.coverage()) {
        request.write(sink)?;
    }
    if let Drawing::File(path) = &config.picture.drawing {
        let (svg, not_there) = sampler::picture(&scenario, config.mode, &config.picture, &samples, &reports);
        file::write_output(path, svg.as_bytes())?;
        unsaved = unsaved.or(not_there.map(Into::into));
    }
    if let Some(folder) = &config.reports.maps {
        maps::write(&scenario, &last.tables, folder)?;
        file::wrote(folder);
    }
    if let Some(folder) = &config.reports.files {
        plc_files::write(&scenario, &last.memories, folder)?;
        file::wrote(folder);
    }
    if let Some(path) = &config.reports.html {
        let plot = sampler::plot(&scenario, config.mode, &config.picture, &samples, &reports);
        file::write_output(path, page_of(&scenario, &reports, &plot, &last.tables).as_bytes())?;
    }
    if let Some(request) = &config.reports.record {
        file::wrote(&request.folder);
    }
    let verdict = Verdict::of(config.mode, &reports);
    verdict.write(config.reports.format, &reports, out).and_then(|()| out.flush()).map_err(OutputError)?;
    if let Some(staying) = staying {
        staying.last(interrupt);
    }
    unsaved.map_or(Ok(verdict), Err)
}

/// The page about all runs.
fn page_of(scenario: &Scenario, reports: &[RunReport], plot: &Plot, tables: &[ValueTable]) -> String {
    let events: Vec<Event> = scenario.case_events().into_iter().map(|(at_ns, text)| Event { at_ns, text }).collect();
    let coverage =
        scenario.coverage().map(|sink| sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone());
    let drawings = Drawings {
        plot,
        scenes: scene_drawing::of_scenario(scenario, Side::default()),
        maps: maps::svgs(scenario, tables),
    };
    // Without soft PLCs, or with clients in other processes, no coverage is gathered: the page then has no part about it.
    page::of_runs(reports, &events, drawings, &coverage.unwrap_or_default()).to_html()
}

/// One run that others watch, and its plot; without signals unless the run has a plot.
///
/// # Errors
/// See [`RunError`].
pub fn watched(
    config: &RunConfig,
    scenario: &Scenario,
    interrupt: &Interrupt,
    observers: Vec<Box<dyn Observer>>,
) -> Result<(RunReport, Plot), RunError> {
    let Ran { report, samples, unsaved, .. } = one_run(config, scenario, 1, interrupt, observers)?;
    let plot = sampler::plot(scenario, config.mode, &config.picture, &[samples], std::slice::from_ref(&report));
    unsaved.map_or(Ok((report, plot)), Err)
}

/// What came of a run.
pub struct Ran {
    pub report: RunReport,
    /// The samples of the signals that are drawn; empty if none are.
    pub(crate) samples: Samples,
    /// Why there is no checkpoint that was asked for.
    pub unsaved: Option<RunError>,
    /// Where others can fork from it.
    pub forks: Vec<Fork>,
    /// Its states at boundaries, if that was asked for.
    pub states: Vec<(VirtualTime, StateHash)>,
    /// Where it came together with another run, and ended.
    pub joined: Option<Joined>,
    /// Its state at the end, if that was asked for.
    pub state: Option<StateHash>,
    /// How far a plant that follows was behind the PLC at each communication, ns.
    pub(crate) errors_ns: Vec<i64>,
    /// What its clients showed at the end, if that is asked for.
    pub(crate) last: ClientView,
    /// Its page, if that is to stay.
    staying: Option<Staying>,
}

/// One run.
///
/// # Errors
/// See [`RunError`].
pub fn one_run(
    config: &RunConfig,
    scenario: &Scenario,
    number: u32,
    interrupt: &Interrupt,
    observers: Vec<Box<dyn Observer>>,
) -> Result<Ran, RunError> {
    expectation::check(scenario, config.subject.end(scenario))?;
    let started = Instant::now();
    let samples = Rc::new(RefCell::new(Samples::new(&config.picture.sampled(scenario))));
    let judge = Rc::new(RefCell::new(expectation::judge(scenario)));
    let (measures, metered) = (scenario.measures(), Metered::new(scenario.measures()));
    let recorded = config.reports.record.as_ref().map(|request| {
        Recorded::begin(request, &config.subject, (config.mode, &config.reach.operated), scenario, number)
    });
    let (recorded, recorder) = recorded.transpose()?.unzip();
    let published = RefCell::new(None);
    let verdict_board = VerdictBoard::default();
    let watch = |lockstep: &mut Lockstep| {
        // Where nobody looks at it, the last view is not made.
        if config.reports.want_the_end() {
            published.replace(Some(lockstep.published()));
        }
        for observer in observers {
            lockstep.observe(observer);
        }
        if config.is_drawn() {
            lockstep.observe(Box::new(Sampler::new(Rc::clone(&samples))));
        }
        let expected = scenario.expectations();
        if !expected.named.is_empty() {
            lockstep.observe(Box::new(Witness::new(Rc::clone(&judge), &expected.signals)));
            if config.doors.web.is_some() {
                lockstep.observe(Box::new(Copyist::new(Rc::clone(&judge), verdict_board.clone())));
            }
        }
        if let Some(metering) = metered.observer(measures) {
            lockstep.observe(metering);
        }
        if let Some(recorder) = recorder {
            lockstep.observe(Box::new(recorder));
        }
    };
    let log = SessionLog::default();
    let outcome = match config.mode {
        Mode::Lockstep => lockstep::run(config, scenario, number, interrupt, (&log, &verdict_board), watch),
        Mode::Freewheel | Mode::Halt | Mode::Follow => {
            freewheel::run(config, scenario, number, interrupt, watch).map(Driven::from)
        }
    };
    let Driven { outcome, unsaved, taken: Taken { forks, states }, joined, state, errors_ns, staying } = outcome
        .map_err(|error| match (&recorded, error) {
            (Some(recorded), RunError::Record(source)) => RunError::RecordCut { source, kept: recorded.kept() },
            (_, error) => error,
        })?;
    let mut report = RunReport::new(config, scenario, number, &outcome, started.elapsed());
    report.latency = log.latencies();
    let end = if report.status == RunStatus::Completed { TraceEnd::Complete } else { TraceEnd::Cut };
    report.expectations = expectation::reports(scenario, judge.replace(expectation::judge(scenario)), end);
    report.report = metered.report();
    report.watched = WatchReport::take(&config.watch, scenario);
    if let Some(recorded) = recorded {
        recorded.end(&report)?;
    }
    let last = published.take().map(|published| published.latest());
    // Where nobody asked for it, nothing is made of it.
    let last = last.map(|view| view.clients.clone()).unwrap_or_default();
    Ok(Ran {
        report,
        samples: samples.replace(Samples::default()),
        unsaved,
        forks,
        states,
        joined,
        state,
        errors_ns,
        last,
        staying,
    })
}
