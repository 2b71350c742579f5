//! A client written in Python from PROTOCOL.md alone (clients/python) takes part, and misbehaves.

use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use onescan_recording::Recording;
use onescan_recording::{Choice, Recorder};
use onescan_server::end::{Failure, FailureCause, SessionEnd, Violation};
use onescan_server::formation::Formation;
use onescan_server::lockstep::{Lockstep, Outcome};
use onescan_server::mailbox::Mailbox;
use onescan_server::plan::Coupling;
use onescan_server::state::ClientState;
use onescan_server::time::StepCount;
use onescan_server::transport::tcp::Lobby;
use onescan_tests::run::{PATIENCE, boxed, in_process, loopback, provenance, run};
use onescan_tests::toy::{ring, ring_plan};
use onescan_tests::{at_ms, client};

/// `beta` of the ring, in Python.
fn mixer(address: SocketAddr, more: &[&str]) -> Child {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/mixer.py");
    Command::new("python3")
        .env("PYTHONPATH", Path::new(env!("CARGO_MANIFEST_DIR")).join("../clients/python/src"))
        .arg("-B")
        .arg(script)
        .args(["--server", &address.to_string(), "--name", "beta", "--reads", "alpha,gamma", "--period-ns", "20000000"])
        .args(more)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("python3 is on the machine")
}

/// The ring with `alpha` and `gamma` in this process and `beta` in Python.
fn mixed(more: &[&str], reply_timeout: Duration) -> (Lockstep, Child) {
    let plan = ring_plan(&Coupling::Parallel);
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).expect("a free port");
    let python = mixer(lobby.address(), more);
    let mut formation = Formation::new(plan);
    for (index, client) in boxed(ring()).into_iter().enumerate() {
        if index != 1 {
            formation.join(client).expect("the plan has a place");
        }
    }
    formation.admit_from(&lobby, PATIENCE, reply_timeout, &mut |_| true).expect("Python comes");
    (formation.start().expect("all have joined"), python)
}

fn in_rust() -> Outcome {
    run(in_process(ring_plan(&Coupling::Parallel), boxed(ring())), at_ms(1_000))
}

#[test]
fn a_client_in_python_gives_the_same_digest() {
    let (lockstep, mut python) = mixed(&[], PATIENCE);
    assert_eq!(run(lockstep, at_ms(1_000)), in_rust());
    assert!(python.wait().expect("it ran").success());
}

#[test]
fn a_client_in_python_is_saved_and_restored() {
    let (mut first, mut python) = mixed(&[], PATIENCE);
    first.run_to(at_ms(330)).unwrap();
    let checkpoint = first.checkpoint().unwrap();
    assert_eq!(run(first, at_ms(1_000)), in_rust());
    python.wait().unwrap();
    let (mut second, mut python) = mixed(&[], PATIENCE);
    second.resume(&checkpoint).unwrap();
    assert_eq!(run(second, at_ms(1_000)), in_rust());
    assert!(python.wait().unwrap().success());
}

fn cause_of(outcome: &Outcome) -> FailureCause {
    match &outcome.end {
        SessionEnd::Failed(Failure { client: who, state: ClientState::Run, t_v, cause }) => {
            assert_eq!((who, *t_v), (&client("beta"), at_ms(100)));
            cause.clone()
        }
        other => panic!("the session should have failed, not {other}"),
    }
}

#[test]
fn whatever_a_client_does_wrong_ends_the_session_by_name() {
    let wrong_step = Violation::WrongStep { got: StepCount(11), expected: StepCount(10) };
    let wrong_size = Violation::WrongSize { got: 7, expected: 8 };
    let too_long = "a frame of 4294967295 bytes is over the limit of 67108864";
    let cases = [
        ("--fail-at", FailureCause::Disconnected),
        ("--fault-at", FailureCause::Fault(onescan_server::client::ClientFault::new("asked for"))),
        ("--wrong-sequence-at", FailureCause::Violation(wrong_step)),
        ("--short-at", FailureCause::Violation(wrong_size)),
        ("--garbage-at", FailureCause::Wire(too_long.to_owned())),
        ("--hang-at", FailureCause::TimedOut { after_ms: 1_000 }),
    ];
    for (option, cause) in cases {
        // Only the client that hangs is to be waited for in vain.
        let patience = if option == "--hang-at" { Duration::from_secs(1) } else { PATIENCE };
        let (lockstep, mut python) = mixed(&[option, "90000000"], patience);
        let outcome = run(lockstep, at_ms(1_000));
        assert_eq!(cause_of(&outcome), cause, "{option}");
        assert_eq!(outcome.steps, StepCount(9));
        assert_eq!(python.wait().unwrap().code(), Some(3), "{option}");
    }
}

#[test]
fn killed_at_any_step_the_session_ends_and_the_recording_is_whole() {
    for step in [0, 2, 8, 14, 40] {
        let folder = tempfile::tempdir().unwrap();
        let (mut lockstep, mut python) = mixed(&[], PATIENCE);
        lockstep.observe(Box::new(Recorder::new(folder.path(), provenance(), Choice::default())));
        lockstep.run_to(at_ms(10 * step)).unwrap();
        python.kill().unwrap();
        python.wait().unwrap();
        let outcome = run(lockstep, at_ms(1_000));
        // The next grant to the dead client is for the next multiple of its period.
        let asked = (10 * step / 20 + 1) * 20;
        let SessionEnd::Failed(failure) = &outcome.end else { panic!("it should have failed") };
        assert_eq!((&failure.client, failure.state, failure.t_v), (&client("beta"), ClientState::Run, at_ms(asked)));
        assert_eq!(failure.cause, FailureCause::Disconnected);
        let steps = Recording::open(folder.path()).unwrap().steps();
        assert_eq!(steps, Some(0..=asked / 10 - 1), "every step before the one that failed");
    }
}
