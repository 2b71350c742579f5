//! One run in lockstep.

use std::collections::BTreeSet;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;

use onescan_base::foreign::one_line;
use onescan_base::regular::{self, Limit};
use onescan_links::inspection::{Inspected, Inspection};
use onescan_recording::{Recording, event};
use onescan_report::file;
use onescan_scenario::compose::Member;
use onescan_scenario::{Scenario, permission, start};
use onescan_server::checkpoint::{Checkpoint, StateHash};
use onescan_server::formation::{Formation, FormationError};
use onescan_server::layout::ImageLayout;
use onescan_server::lockstep::start::{Attendance, StartLogic};
use onescan_server::lockstep::{Lockstep, Outcome, Reached};
use onescan_server::operation::OperatorInput;
use onescan_server::pacing::Pace;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::Timeline;
use onescan_server::transport::tcp::Lobby;

use super::alarms;
use super::chosen::Chosen;
use super::config::{Reach, RunConfig, SaveRequest, Transport};
use super::cut_short;
use super::error::RunError;
use super::fork::{self, Joined, Taken};
use super::forked::{self, ForkSettings, PAGE_AT};
use super::kept_case;
use super::processes::{Passed, Processes};
use super::progress::Progress;
use super::seats::{OpcUaSeats, Seats};
use super::session_log::SessionLog;
use super::staying::Staying;
use crate::access::admission::{GuardedListener, Shown, from_here};
use crate::error::{ListenError, Unreadable, Usage};
use crate::interrupt::Interrupt;
use crate::past::{Keeper, Kept, Rewinder};
use crate::web::{self, KeepCase, Page, VerdictBoard, WebError};
use onescan_base::notice::NOTICE;

/// What came of a session that was driven to its end.
pub(super) struct Driven {
    pub(super) outcome: Outcome,
    /// Why there is no checkpoint that was asked for: a run that could not be saved has been run all the same.
    pub(super) unsaved: Option<RunError>,
    /// Where others can fork from it, and come together with it.
    pub(super) taken: Taken,
    /// Where it came together with another, and ended.
    pub(super) joined: Option<Joined>,
    /// Its state at the end, if that was asked for and it came so far.
    pub(super) state: Option<StateHash>,
    /// How far a plant that follows was behind the PLC at each communication, ns.
    pub(super) errors_ns: Vec<i64>,
    /// Its page, if that is to stay.
    pub(super) staying: Option<Staying>,
}

impl From<(Outcome, Vec<i64>)> for Driven {
    fn from((outcome, errors_ns): (Outcome, Vec<i64>)) -> Self {
        Self { outcome, unsaved: None, taken: Taken::default(), joined: None, state: None, errors_ns, staying: None }
    }
}

/// Runs the scenario once; `watch` adds observers before it begins.
pub(super) fn run(
    config: &RunConfig,
    scenario: &Scenario,
    number: u32,
    interrupt: &Interrupt,
    (log, verdict_board): (&SessionLog, &VerdictBoard),
    watch: impl FnOnce(&mut Lockstep),
) -> Result<Driven, RunError> {
    let mut processes = Processes::default();
    let Formed { mut lockstep, lobby: _lobby, opcua_seats } = form(config, scenario, interrupt, log, &mut processes)?;
    lockstep.set_until(Some(config.subject.end(scenario)));
    lockstep.set_pace(config.course.pace);
    lockstep.set_mailbox(interrupt.mailbox());
    lockstep.set_settings(scenario.session_settings());
    lockstep.set_timeline(timeline(config, scenario, &lockstep)?);
    if let Some(logic) = start_logic(config, scenario, &lockstep) {
        lockstep.set_start_logic(logic);
    }
    watch(&mut lockstep);
    if let Some(opcua_seats) = &opcua_seats {
        lockstep.set_published(opcua_seats.published());
        lockstep.observe(opcua_seats.observer());
    }
    // Read before the page is there: whoever reads its address may remove the file.
    let checkpoint = config.course.resume.as_deref().map(|path| Ok::<_, RunError>((path, read(path)?))).transpose()?;
    let mut keeper = None;
    let page = match config.doors.web {
        Some(address) => {
            let past = past_of(config, scenario, &mut lockstep, &mut keeper)?;
            Some(serve_page(address, config, scenario, &mut lockstep, interrupt, (past, verdict_board.clone()))?)
        }
        None => None,
    };
    let _inspection = match config.doors.ads {
        Some(address) => Some(inspected(address, scenario, &lockstep)?),
        None => None,
    };
    if config.reports.progress {
        let label = if config.runs == 1 { scenario.name().to_owned() } else { format!("run {number}/{}", config.runs) };
        lockstep.observe(Box::new(Progress::new(config.subject.end(scenario), label).with_log(log.clone())));
    }
    if let Some(path) = &config.course.replay_operator {
        lockstep.replay(operator_inputs(path)?);
    }
    if let Some(checkpoint) = checkpoint {
        // Viewers see at once where the session goes on.
        lockstep.published().ask();
        resume(&mut lockstep, checkpoint, scenario, config.course.accept_code)?;
    }
    if let (Some(page), true) = (&page, config.doors.awaits_viewer) {
        tracing::info!(target: NOTICE, "it begins when the page is opened");
        page.await_viewer(|| interrupt.is_raised());
    }
    let saved = match &config.course.save {
        Some(request) => save(&mut lockstep, request, &mut keeper),
        None => Ok(()),
    };
    if let Err(error) = &saved {
        // The run is what was asked for first: it goes on to its end.
        tracing::error!("{error}; the session goes on");
    }
    let mut unsaved = saved.err();
    let mut taken = Taken::default();
    if let Some(request) = &config.course.forks {
        match fork::take(&mut lockstep, request, config.subject.end(scenario)) {
            Ok(all) => taken = all,
            Err(error) => unsaved = Some(error),
        }
    }
    let joined = fork::join(&mut lockstep, &config.course.join)?;
    if let Some(keeper) = &mut keeper {
        keeper.run_to(&mut lockstep, VirtualTime::MAX)?;
    }
    let wants_state = config.course.state_at_end && joined.is_none();
    let state = if wants_state && lockstep.run_to(config.subject.end(scenario))? == Reached::Boundary {
        let hash = lockstep.checkpoint().and_then(|checkpoint| checkpoint.state_hash());
        hash.inspect_err(|error| tracing::debug!(%error, "the state at the end is not known")).ok()
    } else {
        None
    };
    let outcome = lockstep.run()?;
    if let Some(logic) = scenario.start.as_ref().filter(|_| !lockstep.could_start()) {
        return Err(not_started(logic).into());
    }
    let staying = Staying::of(page, config, interrupt);
    Ok(Driven { outcome, unsaved, taken, joined, state, errors_ns: Vec::new(), staying })
}

/// What the scenario does by itself, and what is looked out for on behalf of others.
fn timeline(config: &RunConfig, scenario: &Scenario, lockstep: &Lockstep) -> Result<Timeline, RunError> {
    let session = lockstep.session();
    let own = Timeline::new(scenario.timeline().to_vec(), session).map_err(RunError::Timeline)?;
    let Some(forks) = &config.course.forks else { return Ok(own) };
    own.with_lookouts(forks.conditions.clone(), session).map_err(RunError::Timeline)
}

/// What the scenario wants to hold before the first step.
fn start_logic(config: &RunConfig, scenario: &Scenario, lockstep: &Lockstep) -> Option<StartLogic> {
    let logic = scenario.start.as_ref()?;
    let mut chosen = Chosen::new(&logic.signals);
    chosen.find(lockstep.session());
    let (what, present) = (logic.formula.clone(), logic.present.clone());
    let holds = move |layout: &ImageLayout, image: &[u8]| {
        present.holds(&chosen.numbers_in(layout, image).collect::<Vec<f64>>())
    };
    let doors = &config.doors;
    let is_open = doors.web.is_some() || doors.listen.is_some() || doors.opcua.is_some();
    let attendance = if is_open { Attendance::Attended } else { Attendance::Unattended };
    Some(StartLogic { what, holds: Box::new(holds), attendance })
}

fn not_started(logic: &start::StartLogic) -> Usage {
    let message = format!("the session does not start: `{}` does not hold, and nobody can operate it", logic.formula);
    let help = "let somebody in (`--web`, `--listen`, `--opcua`), repeat what somebody did (`--replay-operator`), or give a \
                case an input at 0 s";
    Usage::new(message, Some(help.to_owned()))
}

/// Lets the session leave its past; gives who shows it and who makes a case of it, or why nobody can.
fn past_of(
    config: &RunConfig,
    scenario: &Scenario,
    lockstep: &mut Lockstep,
    keeper: &mut Option<Keeper>,
) -> Result<Result<(Rewinder, KeepCase), String>, RunError> {
    if config.doors.past.bytes == 0 {
        return Ok(Err("`--past-memory 0` keeps none".to_owned()));
    }
    if let Some(why) = forked::fork_blocker(scenario, Some(config)) {
        return Ok(Err(why));
    }
    let kept = Kept::within(config.doors.past.bytes);
    let keep_case = kept_case::keeper(config, kept.clone());
    let started = Keeper::new(kept.clone())
        .and_then(|keeper| Ok((keeper, Rewinder::new(kept, forked::former(scenario))?)))
        .map_err(WebError::Thread)?;
    lockstep.observe(started.0.observer());
    *keeper = Some(started.0);
    Ok(Ok((started.1, keep_case)))
}

/// Serves variables of the soft PLCs over ADS, for as long as it is kept.
fn inspected(address: SocketAddr, scenario: &Scenario, lockstep: &Lockstep) -> Result<Inspection, RunError> {
    if !address.ip().is_loopback() {
        let help = "ADS knows no users: serve it at an address of this machine, as 127.0.0.1:48898, and let others come through a tunnel";
        return Err(
            Usage::new(format!("--ads {address} can be reached from other machines"), Some(help.to_owned())).into()
        );
    }
    let mut plcs = Vec::new();
    for plc in scenario.plcs() {
        if let Some(compiled) = scenario.compiled_plc(plc.name)? {
            let find = move |path: &str| compiled.application.variable(path).ok();
            plcs.push(Inspected { client: plc.name.clone(), find: Box::new(find) });
        }
    }
    let inspection = Inspection::serve(address, lockstep.published(), plcs).map_err(ListenError::on(address))?;
    tracing::info!(target: NOTICE, "serving ads://{}", inspection.address());
    Ok(inspection)
}

/// Serves the session as a page, for as long as it is kept.
fn serve_page(
    address: SocketAddr,
    config: &RunConfig,
    scenario: &Scenario,
    lockstep: &mut Lockstep,
    interrupt: &Interrupt,
    (past, verdict_board): (Result<(Rewinder, KeepCase), String>, VerdictBoard),
) -> Result<Page, RunError> {
    let pace = match config.course.pace {
        Pace::Max => "max".to_owned(),
        Pace::Factor(factor) => factor.to_string(),
    };
    let failing = web::Failing::default();
    lockstep.observe(failing.observer());
    let alarm_log = web::AlarmLog::default();
    alarms::note(&alarm_log, scenario, lockstep);
    let (published, mailbox) = (lockstep.published(), interrupt.mailbox());
    let launch = forked::launcher(ForkSettings::of(config));
    let (past, keep_case) = match past {
        Ok((past, keep_case)) => (Ok(past), Ok(keep_case)),
        Err(why) => (Err(why.clone()), Err(why)),
    };
    let source = web::Source {
        failing,
        past,
        launch,
        keep_case,
        verdict_board,
        alarm_log,
        ..web::Source::new(scenario, published, mailbox, pace)
    };
    let page = Page::serve(address, &config.doors.admission, source)?;
    // Sessions that go on from this one wait for this line, whether the program has its page or not.
    tracing::info!(target: NOTICE, "{}{}", PAGE_AT, page.url());
    if let Some(how) = Page::is_absent() {
        tracing::warn!(target: NOTICE, "there is no page there: {how}");
    }
    Ok(page)
}

/// A session that is about to begin, and what stays open for operators.
struct Formed {
    lockstep: Lockstep,
    lobby: Option<Lobby>,
    opcua_seats: Option<OpcUaSeats>,
}

/// Brings all clients together.
fn form(
    config: &RunConfig,
    scenario: &Scenario,
    interrupt: &Interrupt,
    log: &SessionLog,
    processes: &mut Processes,
) -> Result<Formed, RunError> {
    let mut formation = Formation::new(scenario.plan().clone());
    formation.set_mailbox(interrupt.mailbox());
    let (mut remote, mut seats) = (Vec::new(), Seats::default());
    for name in scenario.plan().clients() {
        // Also a client that will run in its own process is made here: its faults are found at once.
        match (scenario.member(name)?, config.reach.transport) {
            (Member::Seated { request, command }, _) => seats.add(request, permitted(name, command)?),
            (Member::Gateway(client) | Member::Plant(client) | Member::Plc(client), _)
                if config.reach.opcua_clients.contains(name) =>
            {
                seats.add(client.join(), Vec::new());
            }
            (Member::Gateway(client), _) | (Member::Plant(client) | Member::Plc(client), Transport::Inproc) => {
                let request = client.join();
                let client = if config.reach.is_watched() { log.watch(client) } else { client };
                formation.join(client).map_err(|refusal| scenario.refused(&request, &refusal))?;
            }
            (Member::Plant(_) | Member::Plc(_), Transport::Tcp) => remote.push((name, None)),
            (Member::External(command), _) => remote.push((name, Some(permitted(name, command)?))),
        }
    }
    interrupt.watch();
    let opcua_seats = seats.open(&config.doors, scenario.plan(), interrupt)?;
    if let Some(opcua_seats) = &opcua_seats {
        for client in opcua_seats.clients(config.reach.reply_timeout) {
            let request = client.join();
            let client = if config.reach.is_watched() { log.watch(client) } else { client };
            formation.join(client).map_err(|refusal| scenario.refused(&request, &refusal))?;
        }
        opcua_seats.start(scenario.folder(), &scenario.file().pass_env, processes)?;
    }
    let lobby = admit_remote(config, scenario, &mut formation, &remote, interrupt, processes)?;
    if let Some(opcua_seats) = &opcua_seats {
        opcua_seats.wait(config.reach.join_timeout, interrupt, processes)?;
    }
    Ok(Formed { lockstep: formation.start()?, lobby, opcua_seats })
}

/// The command of a client, if scenarios may start programs. Whoever runs it is notified that it does.
fn permitted(name: &ClientName, command: Vec<String>) -> Result<Vec<String>, RunError> {
    if command.is_empty() {
        return Ok(command);
    }
    let words = command.join(" ");
    let shown = one_line(&words);
    if permission::granted().no_commands {
        let help = "start it yourself and take `command` out of the scenario, or allow it: leave `--no-commands` away";
        let message =
            format!("the scenario starts a program for client `{name}`, which `--no-commands` forbids: {shown}");
        return Err(Usage::new(message, Some(help.to_owned())).into());
    }
    tracing::info!(target: NOTICE, "starting the scenario's program for client `{name}`: {shown}");
    Ok(command)
}

/// Lets in those that come over TCP, if there are any or `--listen` asks for it. The lobby stays open for operators.
fn admit_remote(
    config: &RunConfig,
    scenario: &Scenario,
    formation: &mut Formation,
    remote: &[(&ClientName, Option<Vec<String>>)],
    interrupt: &Interrupt,
    processes: &mut Processes,
) -> Result<Option<Lobby>, RunError> {
    if remote.is_empty() && config.doors.listen.is_none() {
        return Ok(None);
    }
    let address = config.doors.listen.unwrap_or(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
    let mut listener = GuardedListener::open(&config.doors.admission, address)?;
    let mut shown = Vec::new();
    for (name, command) in remote {
        // Nobody waits for a program that somebody else starts with a token of his own.
        let is_ours = command.as_ref().is_none_or(|words| !words.is_empty());
        shown.push(if is_ours { listener.shown_by(name)? } else { Shown::new() });
    }
    let lobby = Lobby::open_house(address, scenario.plan(), interrupt.mailbox(), listener.into_house())
        .map_err(ListenError::on(address))?;
    let server = from_here(lobby.address());
    for ((name, command), shown) in remote.iter().zip(shown) {
        match command {
            None => processes.start_client(name, &config.subject, server, shown)?,
            Some(words) => {
                let named = &scenario.file().pass_env;
                let pass = Passed { named, shown };
                processes.start_command(name, words, scenario.folder(), &server.to_string(), pass)?;
            }
        }
    }
    if config.doors.listen.is_some() {
        tracing::info!(target: NOTICE, "listening at {} for operators", lobby.address());
    }
    for (name, _) in remote.iter().filter(|(_, command)| command.as_ref().is_some_and(Vec::is_empty)) {
        tracing::info!(target: NOTICE, "waiting at {} for client `{name}`", lobby.address());
    }
    wait_for_clients(&config.reach, formation, &lobby, interrupt, processes)?;
    Ok(Some(lobby))
}

fn wait_for_clients(
    reach: &Reach,
    formation: &mut Formation,
    lobby: &Lobby,
    interrupt: &Interrupt,
    processes: &mut Processes,
) -> Result<(), RunError> {
    let mut ended = None;
    let admitted = formation.admit_from(lobby, reach.join_timeout, reach.reply_timeout, &mut |_| {
        ended = processes.first_ended();
        ended.is_none() && !interrupt.is_raised()
    });
    match (admitted, ended) {
        (Err(FormationError::Interrupted { .. }), Some(ended)) => Err(ended),
        (admitted, _) => Ok(admitted?),
    }
}

/// What operators did in a recording, or by a file of events.
///
/// # Errors
/// The recording or the file cannot be read.
pub fn operator_inputs(path: &std::path::Path) -> Result<Vec<OperatorInput>, RunError> {
    if path.is_dir() {
        let recording = Recording::open(path)?;
        cut_short::report(&recording);
        return Ok(recording.operator_inputs()?);
    }
    let events = event::read(path).map_err(Unreadable::at(path))?;
    Ok(event::operator_inputs(&events))
}

/// The bytes of a checkpoint's file.
fn read(path: &Path) -> Result<Vec<u8>, RunError> {
    Ok(regular::read(path, Limit::DATA).map_err(Unreadable::at(path))?)
}

/// Goes on from a checkpoint; from one of other PLC code if the case has its own, or if `accepts_code`.
fn resume(
    lockstep: &mut Lockstep,
    (path, bytes): (&Path, Vec<u8>),
    scenario: &Scenario,
    accepts_code: bool,
) -> Result<(), RunError> {
    let wrong = |source| RunError::Resume { path: path.to_owned(), source };
    let checkpoint = Checkpoint::from_bytes(&bytes).map_err(wrong)?;
    // Programs and constants are code; what else a case sets is a state of the past, which it cannot change.
    let mut code = BTreeSet::new();
    for path in scenario.session_settings().differing(checkpoint.settings()) {
        let is_program = scenario.is_program(path) && (accepts_code || scenario.has_code_of_case());
        if is_program || (accepts_code && scenario.is_constant(path)?) {
            code.insert(path.clone());
        }
    }
    lockstep.accept_settings(code);
    lockstep.resume(&checkpoint).map_err(wrong)
}

fn save(lockstep: &mut Lockstep, request: &SaveRequest, keeper: &mut Option<Keeper>) -> Result<(), RunError> {
    let reached = match keeper {
        Some(keeper) => keeper.run_to(lockstep, request.at)?,
        None => lockstep.run_to(request.at)?,
    };
    if reached == Reached::End {
        return Err(RunError::SaveTooLate(lockstep.session().t_v()));
    }
    let bytes = lockstep.checkpoint().and_then(|checkpoint| checkpoint.to_bytes()).map_err(RunError::Save)?;
    Ok(file::write_output(&request.path, &bytes)?)
}
