//! Sessions whose clients write the time of their turns, and what of a session matters to its behaviour.

use std::io::Write;

use onescan_server::client::JoinRequest;
use onescan_server::end::SessionEnd;
use onescan_server::plan::Coupling;
use onescan_server::session::Session;
use onescan_server::signal::{ClientName, SignalType};
use onescan_server::state::{ClientState, ServerState};
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_tests::{client, plan, port};

pub(crate) const STEP: TimeSpan = TimeSpan::from_nanos(1).expect("not zero");
/// `tdelay : 0..5` of the appendix.
pub(crate) const DELAYS: std::ops::RangeInclusive<u64> = 0..=5;

/// A session of `clients` clients that have joined. Each writes its turn's time to two signals, which
/// every other reads.
pub(crate) fn formed(clients: usize, coupling: &Coupling<ClientName>) -> Session {
    let names: Vec<String> = (0..clients).map(|i| format!("c{i}")).collect();
    let stamps: Vec<String> = names.iter().flat_map(|name| [format!("{name}.a"), format!("{name}.b")]).collect();
    let signals: Vec<_> =
        stamps.iter().enumerate().map(|(i, stamp)| (stamp.as_str(), SignalType::LINT, names[i / 2].as_str())).collect();
    let clients: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut session = Session::new(plan(STEP, coupling, &signals, &clients));
    for (i, name) in names.iter().enumerate() {
        let ports = |range: &[String]| range.iter().map(|stamp| port(stamp, SignalType::LINT)).collect();
        let writes = ports(&stamps[2 * i..2 * i + 2]);
        let request = JoinRequest { name: client(name), period: STEP, reads: ports(&stamps), writes };
        session.join(&request).expect("the plan has a place");
    }
    session
}

/// The two stamps of each client in `bytes`.
pub(crate) fn stamps(bytes: &[u8]) -> Vec<(u64, u64)> {
    let word = |chunk: &[u8]| u64::from_le_bytes(chunk.try_into().expect("eight bytes"));
    bytes.chunks_exact(16).map(|pair| (word(&pair[..8]), word(&pair[8..]))).collect()
}

pub(crate) fn stamp_bytes(t_v: VirtualTime) -> [u8; 16] {
    let mut bytes = [0; 16];
    bytes[..8].copy_from_slice(&t_v.as_nanos().to_le_bytes());
    bytes[8..].copy_from_slice(&t_v.as_nanos().to_le_bytes());
    bytes
}

/// A time seen from `t_v`.
pub(crate) fn relative(time: u64, t_v: VirtualTime) -> i64 {
    time as i64 - t_v.as_nanos() as i64
}

/// What distinguishes two sessions that would behave differently.
pub(crate) type SessionView =
    (ServerState, usize, Vec<(ClientState, bool, bool, i64)>, Option<(ClientName, ClientState)>);

pub(crate) fn view(session: &Session) -> SessionView {
    let (cycle, t_v) = (session.cycle(), session.t_v());
    let clients = session
        .clients()
        .map(|id| {
            // A wake-up that is past means the same however long ago it was: due now.
            let wake = relative(cycle.wake(id).as_nanos(), t_v).max(0);
            (cycle.client(id), cycle.is_awaited(id), cycle.is_due(id), wake)
        })
        .collect();
    let failed = match session.end() {
        Some(SessionEnd::Failed(failure)) => Some((failure.client.clone(), failure.state)),
        _ => None,
    };
    (cycle.server(), cycle.pass(), clients, failed)
}

/// Prints a line also where the harness keeps what a passing test prints.
pub(crate) fn report(line: std::fmt::Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}").expect("somebody reads the tests' output");
}
