//! What clients say when they cannot go on, and that all hear how it ends.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};

use onescan_base::foreign::CHARACTERS_MAX;
use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::end::{FailureCause, SessionEnd};
use onescan_server::formation::Formation;
use onescan_server::mailbox::Mailbox;
use onescan_server::plan::Coupling;
use onescan_server::signal::SignalType;
use onescan_server::time::VirtualTime;
use onescan_server::transport::tcp::Lobby;
use onescan_server::transport::tcp::participant::take_part;
use onescan_tests::run::{PATIENCE, boxed, in_process, loopback, over_tcp, run};
use onescan_tests::toy::{Mixer, ring, ring_plan};
use onescan_tests::{at_ms, plan, span_ms};

use crate::wire::{HELLO, frame};

/// A mixer that neither saves its state nor takes one back.
struct Forgetful(Mixer);

impl Client for Forgetful {
    fn join(&self) -> JoinRequest {
        self.0.join()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.0.setup(outputs)
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.0.turn(t_v, inputs, outputs)
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Err(StateError::Corrupt("it has forgotten\u{1b}[2J everything".to_owned()))
    }

    fn restore(&mut self, _: &[u8]) -> Result<(), StateError> {
        Err(StateError::Unsupported)
    }
}

/// The ring, whose last client is forgetful.
fn forgetful_ring() -> Vec<Box<dyn Client>> {
    let mut clients = ring();
    let last = clients.pop().expect("three");
    let mut clients = boxed(clients);
    clients.push(Box::new(Forgetful(last)));
    clients
}

#[test]
fn a_session_that_cannot_be_saved_goes_on() {
    let whole = run(in_process(ring_plan(&Coupling::Parallel), boxed(ring())), at_ms(200));
    let (mut lockstep, threads) = over_tcp(ring_plan(&Coupling::Parallel), forgetful_ring(), PATIENCE);
    lockstep.run_to(at_ms(50)).expect("nothing is recorded");
    for _ in 0..2 {
        let error = lockstep.checkpoint().expect_err("one cannot").to_string();
        let expected = r"client `gamma`: it does not: not a state of this client: it has forgotten\u{1b}[2J everything";
        assert_eq!(error, expected);
    }
    assert_eq!(run(lockstep, at_ms(200)), whole);
    for thread in threads {
        assert_eq!(thread.join().expect("no panic").expect("an end"), whole.end);
    }
}

#[test]
fn a_session_that_cannot_be_resumed_is_over_for_all() {
    let mut first = in_process(ring_plan(&Coupling::Parallel), boxed(ring()));
    first.run_to(at_ms(50)).expect("nothing is recorded");
    let checkpoint = first.checkpoint().expect("all can");
    let (mut second, mut threads) = over_tcp(ring_plan(&Coupling::Parallel), forgetful_ring(), PATIENCE);
    let error = second.resume(&checkpoint).expect_err("one cannot").to_string();
    assert_eq!(error, "client `gamma`: it does not: this client cannot save its state");
    drop(second);
    assert!(threads.pop().expect("three").join().expect("no panic").is_err(), "it knows its own fault");
    for thread in threads {
        match thread.join().expect("no panic").expect("an end") {
            SessionEnd::Failed(failure) => {
                assert_eq!(failure.client.as_str(), "gamma");
                assert!(matches!(failure.cause, FailureCause::State(_)), "{failure}");
            }
            end => panic!("{end}"),
        }
    }
}

#[test]
fn a_session_that_never_forms_is_over_for_those_who_wait_in_it() {
    let plan = ring_plan(&Coupling::Parallel);
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).expect("a free port");
    let address = lobby.address();
    let mut alpha = boxed(ring()).remove(0);
    let waiting = std::thread::spawn(move || take_part(alpha.as_mut(), address));
    let mut formation = Formation::new(plan);
    let called_off = formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |missing| missing.contains("alpha"));
    assert!(called_off.is_err());
    drop(formation);
    let end = waiting.join().expect("no panic").expect("an end");
    assert_eq!(end, SessionEnd::Stopped { t_v: VirtualTime::ZERO });
}

/// Joins as the only client of a session, and answers `setup` with this `fault`; what it hears then.
fn faults(address: SocketAddr, fault: &str) -> String {
    let join = r#"{"join":{"name":"only","period_ns":10000000,"writes":[{"name":"x","type":"BYTE"}]}}"#;
    let mut stream = TcpStream::connect(address).expect("it listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("a time-out");
    stream.write_all(&[frame(HELLO), frame(join)].concat()).expect("it takes them");
    let (mut come, mut piece) = (String::new(), [0; 4096]);
    while !come.contains("setup") {
        let count = stream.read(&mut piece).expect("an answer");
        assert!(count > 0, "closed after {come:?}");
        come += &String::from_utf8_lossy(&piece[..count]);
    }
    stream.write_all(&frame(fault)).expect("it takes it");
    stream.shutdown(std::net::Shutdown::Write).expect("it closes");
    let mut rest = Vec::new();
    stream.read_to_end(&mut rest).expect("its end");
    // Without the head of the frame.
    String::from_utf8_lossy(rest.get(5..).expect("a frame")).into_owned()
}

/// What a session says of a client that sends this `fault`, and what that client hears.
fn ended_by(fault: String) -> (String, String) {
    let plan = plan(span_ms(10), &Coupling::Parallel, &[("x", SignalType::BYTE, "only")], &["only"]);
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).expect("a free port");
    let address = lobby.address();
    let client = std::thread::spawn(move || faults(address, &fault));
    let mut formation = Formation::new(plan);
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).expect("it comes");
    let outcome = run(formation.start().expect("it has joined"), at_ms(100));
    (outcome.end.to_string(), client.join().expect("no panic"))
}

#[test]
fn what_a_client_says_steers_no_terminal() {
    let fault = r#"{"fault":{"message":"\u001b[31mRED\u001b]0;pwn\u0007\n\nerror: fake","place":{"file":"a\nb","line":1,"column":1}}}"#;
    let (said, heard) = ended_by(fault.to_owned());
    let message = r"\u{1b}[31mRED\u{1b}]0;pwn\u{7}\n\nerror: fake at a\nb:1:1";
    assert_eq!(said, format!("client `only` failed in state setup at t_v = 0.000 s: {message}"));
    assert!(!heard.contains('\u{1b}') && heard.contains("RED"), "{heard:?}");
}

#[test]
fn a_message_of_megabytes_is_cut_at_once() {
    let (said, heard) = ended_by(format!(r#"{{"fault":{{"message":"{}"}}}}"#, "x".repeat(5_000_000)));
    assert!(said.ends_with("xxx … (cut, 5000000 bytes)"), "{}", said.len());
    assert!(said.chars().count() < CHARACTERS_MAX + 100 && heard.len() < CHARACTERS_MAX + 500);
}
