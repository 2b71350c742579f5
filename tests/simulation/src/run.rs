//! Running toy sessions: in this process, or with every client behind TCP in a thread of its own.

use std::net::{Ipv4Addr, SocketAddr};
use std::thread::JoinHandle;
use std::time::Duration;

use onescan_recording::Provenance;
use onescan_server::client::Client;
use onescan_server::end::SessionEnd;
use onescan_server::formation::Formation;
use onescan_server::lockstep::{Lockstep, Outcome};
use onescan_server::mailbox::Mailbox;
use onescan_server::plan::SessionPlan;
use onescan_server::time::VirtualTime;
use onescan_server::transport::tcp::Lobby;
use onescan_server::transport::tcp::participant::{ParticipantError, take_part};

/// Long enough for any loaded machine; only a test that hangs would wait for it.
pub const PATIENCE: Duration = Duration::from_mins(1);

/// A port that the operating system chooses, on this machine only.
pub fn loopback() -> SocketAddr {
    SocketAddr::from((Ipv4Addr::LOCALHOST, 0))
}

/// A session of clients in this process, ready to run.
pub fn in_process(plan: SessionPlan, clients: impl IntoIterator<Item = Box<dyn Client>>) -> Lockstep {
    let mut formation = Formation::new(plan);
    for client in clients {
        formation.join(client).expect("the plan has a place");
    }
    formation.start().expect("all have joined")
}

/// Runs a session to `until`.
pub fn run(mut lockstep: Lockstep, until: VirtualTime) -> Outcome {
    lockstep.set_until(Some(until));
    lockstep.run().expect("nothing is recorded")
}

/// What a recording of a toy session says of it.
pub fn provenance() -> Provenance {
    Provenance {
        onescan: "0".to_owned(),
        scenario: "toy".to_owned(),
        folder: String::new(),
        file: None,
        case: None,
        operated: Vec::new(),
        mode: "lockstep".to_owned(),
        until: VirtualTime::ZERO,
        seed: 0,
        files: Vec::new(),
    }
}

/// Boxes clients.
pub fn boxed<C: Client + 'static>(clients: impl IntoIterator<Item = C>) -> Vec<Box<dyn Client>> {
    clients.into_iter().map(|client| Box::new(client) as Box<dyn Client>).collect()
}

/// What became of a client behind TCP.
pub type Fate = Result<SessionEnd, ParticipantError>;

/// A session of `clients` behind TCP, ready to run, with the threads in which they take part.
pub fn over_tcp(
    plan: SessionPlan,
    clients: Vec<Box<dyn Client>>,
    reply_timeout: Duration,
) -> (Lockstep, Vec<JoinHandle<Fate>>) {
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).expect("a free port");
    let address = lobby.address();
    let threads =
        clients.into_iter().map(|mut client| std::thread::spawn(move || take_part(client.as_mut(), address))).collect();
    let mut formation = Formation::new(plan);
    formation.admit_from(&lobby, PATIENCE, reply_timeout, &mut |_| true).expect("all come");
    (formation.start().expect("all have joined"), threads)
}
