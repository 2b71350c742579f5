//! The lobby while a session is formed and while it runs: whoever comes is answered, and keeps nobody else out.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};

use onescan_server::formation::Formation;
use onescan_server::mailbox::Mailbox;
use onescan_server::operation::{Control, Operation};
use onescan_server::plan::Coupling;
use onescan_server::signal::{ClientName, Port, SignalName, SignalType};
use onescan_server::state::ServerState;
use onescan_server::time::VirtualTime;
use onescan_server::transport::tcp::Lobby;
use onescan_server::transport::tcp::operator::operate;
use onescan_server::transport::tcp::participant::{ParticipantError, take_part};
use onescan_tests::run::{PATIENCE, boxed, loopback, run};
use onescan_tests::toy::{ring, ring_plan};
use onescan_tests::{at_ms, plan, span_ms};

use crate::wire::{HELLO, frame, send};

/// What a client of the ring asks for.
const ALPHA: &str =
    r#"{"join":{"name":"alpha","period_ns":10000000,"reads":[],"writes":[{"name":"alpha.out","type":"ULINT"}]}}"#;
const STRANGER: &str = r#"{"join":{"name":"omega","period_ns":10000000,"reads":[],"writes":[]}}"#;

fn open() -> (Lobby, Formation, Mailbox) {
    let (plan, mailbox) = (ring_plan(&Coupling::Parallel), Mailbox::new());
    let lobby = Lobby::open(loopback(), &plan, mailbox.clone()).expect("a free port");
    let mut formation = Formation::new(plan);
    formation.set_mailbox(mailbox.clone());
    (lobby, formation, mailbox)
}

/// A connection on which `bytes` have been sent, and `answer` has come.
fn until(address: SocketAddr, bytes: &[u8], answer: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).expect("the lobby listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("a time-out");
    stream.write_all(bytes).expect("it takes them");
    let (mut come, mut piece) = (String::new(), [0; 4096]);
    while !come.contains(answer) {
        let count = stream.read(&mut piece).expect("an answer");
        assert!(count > 0, "closed after {come:?}");
        come += &String::from_utf8_lossy(&piece[..count]);
    }
    stream
}

/// The ring takes part, each client in a thread of its own; one whose place is taken by somebody who has gone tries again.
fn ring_takes_part(address: SocketAddr) -> Vec<std::thread::JoinHandle<()>> {
    let take_part = |mut client: Box<dyn Client>| {
        std::thread::spawn(move || {
            while let Err(error) = take_part(client.as_mut(), address) {
                let is_taken = matches!(&error, ParticipantError::Refused(why) if why.contains("has already joined"));
                assert!(is_taken, "{error}");
            }
        })
    };
    boxed(ring()).into_iter().map(take_part).collect()
}

fn all_have_taken_part(threads: Vec<std::thread::JoinHandle<()>>) {
    for thread in threads {
        thread.join().expect("it has taken part");
    }
}

/// A session in which all have joined runs to its end, with all of them.
fn completes(formation: Formation, threads: Vec<std::thread::JoinHandle<()>>) {
    run(formation.start().expect("all have joined"), at_ms(100));
    all_have_taken_part(threads);
}

#[test]
fn one_who_comes_when_the_session_has_begun_is_refused() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let threads = ring_takes_part(address);
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("all come");
    for _ in 0..200 {
        let said = send(address, &[frame(HELLO), frame(ALPHA)].concat());
        assert!(said.contains("the session has begun: nobody can join any more"), "{said}");
    }
    completes(formation, threads);
}

#[test]
fn strangers_who_knock_again_and_again_do_not_hold_the_wait_open() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let is_over = Arc::new(AtomicBool::new(false));
    let knocking = Arc::clone(&is_over);
    let stranger = std::thread::spawn(move || {
        while !knocking.load(Ordering::Relaxed) {
            send(address, &[frame(HELLO), frame(STRANGER)].concat());
        }
    });
    let waited = formation.admit_from(&lobby, Duration::from_millis(500), PATIENCE, &mut |_| true);
    is_over.store(true, Ordering::Relaxed);
    let error = waited.expect_err("nobody of the ring has come").to_string();
    assert!(error.contains("did not join within 0.5 s; somebody tried and was refused: `omega` from"), "{error}");
    stranger.join().expect("it has knocked");
}

/// Each farewell takes up to a second; behind one another they would take longer than the wait does.
#[test]
fn those_who_are_refused_and_stay_hold_nobody_up() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let strangers: Vec<_> = (0..20)
        .map(|_| {
            let mut stream = TcpStream::connect(address).expect("the lobby listens");
            stream.write_all(&[frame(HELLO), frame(STRANGER)].concat()).expect("it takes them");
            stream
        })
        .collect();
    let threads = ring_takes_part(address);
    formation.admit_from(&lobby, Duration::from_secs(10), PATIENCE, &mut |_| true).expect("all come in time");
    completes(formation, threads);
    drop(strangers);
}

#[test]
fn silent_operators_take_nobodys_place() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let hello = HELLO.replace("\"client\"", "\"operator\"");
    let silent: Vec<_> = (0..16).map(|_| until(address, &frame(&hello), "welcome")).collect();
    // Who has asked nothing gives way to an operator of the same address.
    for _ in 0..64 {
        drop(until(address, &frame(&hello), "welcome"));
    }
    let threads = ring_takes_part(address);
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("all come");
    completes(formation, threads);
    drop(silent);
}

#[test]
fn one_who_has_joined_and_gone_leaves_the_place_free() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let joiner = std::thread::spawn(move || {
        drop(until(address, &[frame(HELLO), frame(ALPHA)].concat(), "joined"));
        all_have_taken_part(ring_takes_part(address));
    });
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("all come");
    run(formation.start().expect("all have joined"), at_ms(100));
    joiner.join().expect("they have taken part");
}

#[test]
fn one_who_has_gone_is_named_if_nobody_comes() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let joiner = std::thread::spawn(move || drop(until(address, &[frame(HELLO), frame(ALPHA)].concat(), "joined")));
    let mut has_gone = false;
    let waited = formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |missing| {
        // Missing at first, then there, then missing again.
        has_gone |= !missing.contains("alpha");
        !has_gone || !missing.contains("alpha")
    });
    let error = waited.expect_err("called off").to_string();
    assert_eq!(error, "stopped while waiting for client `alpha`, `beta`, `gamma` to join");
    joiner.join().expect("it has come and gone");
}

#[test]
fn who_would_leave_a_signal_unwritten_is_refused() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let nothing = r#"{"join":{"name":"alpha","period_ns":10000000,"reads":[],"writes":[]}}"#;
    let joiner = std::thread::spawn(move || {
        let said = send(address, &[frame(HELLO), frame(nothing)].concat());
        assert!(said.contains("client `alpha` does not write signal `alpha.out`"), "{said}");
        all_have_taken_part(ring_takes_part(address));
    });
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("all come");
    run(formation.start().expect("all have joined"), at_ms(100));
    joiner.join().expect("they have taken part");
}

#[test]
fn operators_are_answered_while_clients_are_waited_for() {
    let (lobby, mut formation, _) = open();
    let address = lobby.address();
    let operator = std::thread::spawn(move || {
        let status = operate(address, None, PATIENCE).expect("a status");
        assert_eq!((status.state, status.t_v), (ServerState::Start, VirtualTime::ZERO));
        operate(address, Some(Operation::from(Control::Stop)), PATIENCE).expect("it is stopped");
    });
    let waited = formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true);
    let error = waited.expect_err("called off").to_string();
    assert!(error.starts_with("stopped while waiting for client `alpha`"), "{error}");
    operator.join().expect("it was answered");
}

/// Writes many signals, and each turn counts in the first of them.
struct Many(JoinRequest);

impl Client for Many {
    fn join(&self) -> JoinRequest {
        self.0.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        outputs.fill(0);
        Ok(())
    }

    fn turn(&mut self, _: VirtualTime, _: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        outputs[0] += 1;
        Ok(Wake::NextPeriod)
    }
}

#[test]
fn a_session_may_have_a_hundred_thousand_signals() {
    let names: Vec<String> = (0..100_000).map(|number| format!("signal_{number:06}")).collect();
    let signals: Vec<_> = names.iter().map(|name| (name.as_str(), SignalType::BYTE, "many")).collect();
    let plan = plan(span_ms(10), &Coupling::Parallel, &signals, &["many"]);
    let port = |name: &String| Port { name: SignalName::new(name.clone()).expect("a name"), ty: SignalType::BYTE };
    let name = ClientName::new("many").expect("a name");
    let request = JoinRequest { name, period: span_ms(10), reads: vec![], writes: names.iter().map(port).collect() };
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).expect("a free port");
    let address = lobby.address();
    let client = std::thread::spawn(move || take_part(&mut Many(request), address));
    let mut formation = Formation::new(plan);
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("it comes");
    let outcome = run(formation.start().expect("it has joined"), at_ms(30));
    assert_eq!(client.join().expect("no panic").expect("it has taken part"), outcome.end);
}
