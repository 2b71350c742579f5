//! Free-wheeling clients for some time, and what came of it.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use onescan_base::threads;
use onescan_operator::replay::Replay;
use onescan_scenario::file::FreewheelFile;
use onescan_server::client::{Client, ClientFault, JoinRequest, Pose};
use onescan_server::end::{Failure, FailureCause, SessionEnd};
use onescan_server::formation::{Formation, FormationError};
use onescan_server::lockstep::Lockstep;
use onescan_server::plan::SessionPlan;
use onescan_server::signal::{PortLayout, SignalName};
use onescan_server::state::ClientState;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::Scheduled;

use super::item::Items;
use super::link::{OpcLink, Route};
use super::model::{self, Clocks, Halted};
use super::timeline::OwnTimeline;
use super::wheel::{Halt, Wheel};

pub use super::wheel::Clock;

/// A client and the clock it keeps.
pub struct Freewheeler {
    client: Box<dyn Client>,
    /// How it keeps its cycle.
    clock: Clock,
    /// Whether it is noted where its bodies are.
    is_seen: bool,
}

impl Freewheeler {
    /// A client that runs by `clock` alone.
    pub fn new(client: Box<dyn Client>, clock: Clock) -> Self {
        Self { client, clock, is_seen: false }
    }

    /// The same, of which it is noted after each cycle where its bodies are, for pictures.
    #[must_use]
    pub fn seen(self) -> Self {
        Self { is_seen: true, ..self }
    }
}

/// What free-wheeling left: a session that replays it, cycle by cycle, so that it is digested,
/// recorded and plotted just as one in lockstep.
pub struct Trace {
    /// Each client's k-th cycle is the k-th turn of the replay.
    pub replay: Lockstep,
    /// How far all clients came, each by its own clock.
    pub reached: VirtualTime,
    /// The end of the run if a client failed.
    pub failed: Option<SessionEnd>,
    /// How far a plant that follows was behind the PLC at each communication, ns.
    pub errors_ns: Vec<i64>,
}

/// Runs `clients` free-wheeling until each one's own clock has come to `until`, or until `stop`: in real time, or in computed
/// time with `clocks`.
///
/// # Errors
/// The clients do not fit the plan.
pub fn run(
    plan: &SessionPlan,
    clients: Vec<Freewheeler>,
    (link, timeline): (&FreewheelFile, &[Scheduled]),
    (until, clocks): (VirtualTime, Option<Clocks>),
    stop: &AtomicBool,
) -> Result<Trace, FormationError> {
    let requests: Vec<JoinRequest> = clients.iter().map(|client| client.client.join()).collect();
    replayed(plan, requests.iter().map(|request| (request.clone(), Vec::new(), Vec::new())))?;
    let (mut wheels, links) = connect(clients, &requests, link, timeline);
    let mut failed = None;
    for (wheel, request) in wheels.iter_mut().zip(&requests) {
        if let Err(fault) = wheel.set_up() {
            failed.get_or_insert_with(|| end_of(request, ClientState::Setup, VirtualTime::ZERO, fault));
        }
    }
    if failed.is_none() {
        failed = match clocks {
            None => spin(&mut wheels, &links, &requests, until, stop),
            Some(clocks) => computed(&mut wheels, &links, &requests, (until, clocks), stop),
        };
    }
    let reached = wheels.iter().map(|wheel| wheel.reached).min().unwrap_or_default();
    let errors_ns = wheels.iter_mut().flat_map(|wheel| std::mem::take(&mut wheel.errors_ns)).collect();
    let recorded = requests.into_iter().zip(wheels).map(|(request, wheel)| (request, wheel.recorded, wheel.seen));
    Ok(Trace { replay: replayed(plan, recorded)?, reached, failed, errors_ns })
}

/// Lets all clients and links run in computed time.
fn computed(
    wheels: &mut [Wheel],
    links: &[OpcLink],
    requests: &[JoinRequest],
    times: (VirtualTime, Clocks),
    stop: &AtomicBool,
) -> Option<SessionEnd> {
    let Halted { client, halt } = model::spin(wheels, links, requests, times, stop)?;
    requests.get(client).map(|request| end_of(request, ClientState::Run, halt.t, halt.fault))
}

/// Lets all clients and links run beside each other, each in a thread of its own.
fn spin(
    wheels: &mut [Wheel],
    links: &[OpcLink],
    requests: &[JoinRequest],
    until: VirtualTime,
    stop: &AtomicBool,
) -> Option<SessionEnd> {
    let (links_stop, halted) = (AtomicBool::new(false), AtomicBool::new(false));
    let halted = &halted;
    std::thread::scope(|scope| {
        let mut failed = None;
        let mut refused = |request: &JoinRequest, error: &std::io::Error| {
            halted.store(true, Ordering::Relaxed);
            let fault = ClientFault::new(error.to_string());
            failed.get_or_insert_with(|| end_of(request, ClientState::Setup, VirtualTime::ZERO, fault));
        };
        for (link, request) in links.iter().zip(requests) {
            if let Err(error) = threads::start_in(scope, "link", || link.run([stop, &links_stop])) {
                refused(request, &error);
            }
        }
        let mut running = Vec::new();
        for (wheel, request) in wheels.iter_mut().zip(requests) {
            let turning = threads::start_in(scope, "client", move || {
                let result = wheel.run(until, [stop, halted]);
                if result.is_err() {
                    halted.store(true, Ordering::Relaxed);
                }
                result
            });
            match turning {
                Ok(thread) => running.push((thread, request)),
                Err(error) => refused(request, &error),
            }
        }
        for (thread, request) in running {
            let halt = match thread.join() {
                Ok(Ok(())) => continue,
                Ok(Err(halt)) => halt,
                Err(_) => Halt { t: until, fault: ClientFault::new("the client's thread panicked") },
            };
            failed.get_or_insert_with(|| end_of(request, ClientState::Run, halt.t, halt.fault));
        }
        links_stop.store(true, Ordering::Relaxed);
        failed
    })
}

fn end_of(request: &JoinRequest, state: ClientState, t_v: VirtualTime, fault: ClientFault) -> SessionEnd {
    SessionEnd::Failed(Failure { client: request.name.clone(), state, t_v, cause: FailureCause::Fault(fault) })
}

/// Gives every client its process images, and a link from its outputs to whoever reads them.
fn connect(
    clients: Vec<Freewheeler>,
    requests: &[JoinRequest],
    link: &FreewheelFile,
    timeline: &[Scheduled],
) -> (Vec<Wheel>, Vec<OpcLink>) {
    let plc_clock = Arc::new(AtomicU64::new(0));
    let wheels: Vec<Wheel> = clients
        .into_iter()
        .zip(requests)
        .map(|(client, request)| Wheel {
            client: client.client,
            timeline: OwnTimeline::new(timeline, request),
            period: request.period,
            clock: client.clock,
            inputs: Arc::new(Items::new(&PortLayout::new(request.reads.clone()))),
            outputs: Arc::new(Items::new(&PortLayout::new(request.writes.clone()))),
            own: Vec::new(),
            recorded: Vec::new(),
            is_seen: client.is_seen,
            seen: Vec::new(),
            reached: VirtualTime::ZERO,
            errors_ns: Vec::new(),
            plc_clock: Arc::clone(&plc_clock),
        })
        .collect();
    let mut readers: BTreeMap<&SignalName, Vec<(Arc<Items>, usize)>> = BTreeMap::new();
    for (wheel, request) in wheels.iter().zip(requests) {
        for (index, port) in request.reads.iter().enumerate() {
            readers.entry(&port.name).or_default().push((Arc::clone(&wheel.inputs), index));
        }
    }
    let links = wheels
        .iter()
        .zip(requests)
        .map(|(wheel, request)| OpcLink {
            source: Arc::clone(&wheel.outputs),
            routes: routes(request, &readers),
            update_rate: Duration::from_nanos(link.update_rate.as_nanos()),
            item_transfer: Duration::from_nanos(link.item_transfer.as_nanos()),
        })
        .collect();
    (wheels, links)
}

/// A route for every output that somebody reads, in the order in which the client names them.
fn routes(request: &JoinRequest, readers: &BTreeMap<&SignalName, Vec<(Arc<Items>, usize)>>) -> Vec<Route> {
    let read = |(source, port): (usize, &onescan_server::signal::Port)| {
        readers.get(&port.name).map(|targets| Route { source, targets: targets.clone() })
    };
    request.writes.iter().enumerate().filter_map(read).collect()
}

fn replayed(
    plan: &SessionPlan,
    clients: impl Iterator<Item = (JoinRequest, Vec<Vec<u8>>, Vec<Vec<Pose>>)>,
) -> Result<Lockstep, FormationError> {
    let mut formation = Formation::new(plan.clone());
    for (request, recorded, seen) in clients {
        formation.join(Box::new(Replay::new(request, recorded).showing(seen)))?;
    }
    formation.start()
}
