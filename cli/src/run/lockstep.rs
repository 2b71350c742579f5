//! One run in lockstep.

use std::net::{Ipv4Addr, SocketAddr};

use onescan_base::regular::{self, Limit};
use onescan_recording::{Recording, event};
use onescan_report::file;
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::checkpoint::Checkpoint;
use onescan_server::formation::{Formation, FormationError};
use onescan_server::lockstep::{Lockstep, Outcome, Reached};
use onescan_server::operation::OperatorInput;
use onescan_server::signal::ClientName;
use onescan_server::timeline::Timeline;
use onescan_server::transport::tcp::Lobby;

use super::config::{Doors, Reach, RunConfig, SaveRequest, Transport};
use super::error::RunError;
use super::processes::Processes;
use super::progress::Progress;
use super::seats::{Desk, Seats};
use super::session_log::SessionLog;
use crate::error::{ListenError, Unreadable};
use crate::interrupt::Interrupt;

/// What is said here is for the user, also without `--verbose`.
const NOTICE: &str = "onescan::notice";

/// Runs the scenario once; `watch` adds observers before it begins.
pub(super) fn run(
    config: &RunConfig,
    scenario: &Scenario,
    number: u32,
    interrupt: &Interrupt,
    log: &SessionLog,
    watch: impl FnOnce(&mut Lockstep),
) -> Result<Outcome, RunError> {
    let mut processes = Processes::default();
    let Formed { mut lockstep, lobby: _lobby, desk } = form(config, scenario, interrupt, log, &mut processes)?;
    lockstep.set_until(Some(config.subject.end(scenario)));
    lockstep.set_pace(config.course.pace);
    lockstep.set_mailbox(interrupt.mailbox());
    lockstep.set_makeup(scenario.makeup());
    let timeline = Timeline::new(scenario.timeline().to_vec(), lockstep.session()).map_err(RunError::Timeline)?;
    lockstep.set_timeline(timeline);
    watch(&mut lockstep);
    if let Some(desk) = &desk {
        lockstep.set_published(desk.published());
        lockstep.observe(desk.observer());
    }
    if config.reports.progress {
        let label = if config.runs == 1 { scenario.name().to_owned() } else { format!("run {number}/{}", config.runs) };
        lockstep.observe(Box::new(Progress::new(config.subject.end(scenario), label).with_log(log.clone())));
    }
    if let Some(path) = &config.course.replay_operator {
        lockstep.replay(operator_inputs(path)?);
    }
    if let Some(path) = &config.course.resume {
        resume(&mut lockstep, path)?;
    }
    if let Some(request) = &config.course.save {
        save(&mut lockstep, request)?;
    }
    Ok(lockstep.run()?)
}

/// A session that is about to begin, and what stays open for operators.
struct Formed {
    lockstep: Lockstep,
    lobby: Option<Lobby>,
    desk: Option<Desk>,
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
            (Member::Seated { request, command }, _) => seats.add(request, command),
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
            (Member::External(command), _) => remote.push((name, Some(command))),
        }
    }
    interrupt.heed();
    let desk = seats.open(&config.doors, scenario.plan(), interrupt)?;
    if let Some(desk) = &desk {
        for client in desk.clients(config.reach.reply_timeout) {
            let request = client.join();
            let client = if config.reach.is_watched() { log.watch(client) } else { client };
            formation.join(client).map_err(|refusal| scenario.refused(&request, &refusal))?;
        }
        desk.start(scenario.folder(), processes)?;
    }
    let lobby = admit_remote(config, scenario, &mut formation, &remote, interrupt, processes)?;
    if let Some(desk) = &desk {
        desk.wait(config.reach.join_timeout, interrupt, processes)?;
    }
    Ok(Formed { lockstep: formation.start()?, lobby, desk })
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
    let lobby = open_lobby(&config.doors, scenario, interrupt)?;
    for (name, command) in remote {
        match command {
            None => processes.start_client(name, &config.subject, lobby.address())?,
            Some(words) => processes.start_command(name, words, scenario.folder(), &lobby.address().to_string())?,
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

fn open_lobby(doors: &Doors, scenario: &Scenario, interrupt: &Interrupt) -> Result<Lobby, RunError> {
    let address = doors.listen.unwrap_or(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
    let lobby = Lobby::open(address, scenario.plan(), interrupt.mailbox()).map_err(ListenError::on(address))?;
    Ok(lobby)
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
fn operator_inputs(path: &std::path::Path) -> Result<Vec<OperatorInput>, RunError> {
    if path.is_dir() {
        return Ok(Recording::open(path)?.operator_inputs()?);
    }
    let events = event::read(path).map_err(Unreadable::at(path))?;
    Ok(event::operator_inputs(&events))
}

fn resume(lockstep: &mut Lockstep, path: &std::path::Path) -> Result<(), RunError> {
    let bytes = regular::read(path, Limit::DATA).map_err(Unreadable::at(path))?;
    let wrong = |source| RunError::Resume { path: path.to_owned(), source };
    lockstep.resume(&Checkpoint::from_bytes(&bytes).map_err(wrong)?).map_err(wrong)
}

fn save(lockstep: &mut Lockstep, request: &SaveRequest) -> Result<(), RunError> {
    if lockstep.run_to(request.at)? == Reached::End {
        return Err(RunError::SaveTooLate(lockstep.session().t_v()));
    }
    let bytes = lockstep.checkpoint().and_then(|checkpoint| checkpoint.to_bytes()).map_err(RunError::Save)?;
    Ok(file::write_whole(&request.path, &bytes)?)
}
