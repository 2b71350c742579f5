//! One client fails: the session ends for all, with a reason that names client, state and `t_v`.

use onescan_recording::Recording;
use onescan_recording::{Choice, EventKind, Recorder};
use onescan_server::client::ClientFault;
use onescan_server::end::{Failure, FailureCause, SessionEnd};
use onescan_server::plan::Coupling;
use onescan_server::state::ClientState;
use onescan_server::time::StepCount;
use onescan_server::transport::tcp::participant::ParticipantError;
use onescan_tests::run::{PATIENCE, boxed, in_process, over_tcp, provenance, run};
use onescan_tests::toy::{ring, ring_plan};
use onescan_tests::{at_ms, client};

fn expected(ms: u64) -> SessionEnd {
    SessionEnd::Failed(Failure {
        client: client("beta"),
        state: ClientState::Run,
        t_v: at_ms(ms),
        cause: FailureCause::Fault(ClientFault::new("asked to fail")),
    })
}

#[test]
fn a_fault_ends_the_session_in_every_client_over_both_transports() {
    for ms in (20..=120).step_by(20) {
        let failing = || {
            let mut clients = ring();
            clients[1].fails_at = Some(at_ms(ms));
            boxed(clients)
        };
        let local = run(in_process(ring_plan(&Coupling::Parallel), failing()), at_ms(500));
        assert_eq!(local.end, expected(ms));
        assert_eq!(local.steps, StepCount(ms / 10 - 1), "the step of the fault is not committed");

        let (lockstep, threads) = over_tcp(ring_plan(&Coupling::Parallel), failing(), PATIENCE);
        assert_eq!(run(lockstep, at_ms(500)), local);
        let fates: Vec<_> = threads.into_iter().map(|thread| thread.join().expect("no panic")).collect();
        assert!(matches!(fates[1], Err(ParticipantError::Fault { .. })), "beta knows its own fault");
        for other in [0, 2] {
            assert_eq!(fates[other].as_ref().expect("an end"), &expected(ms));
        }
    }
}

#[test]
fn a_failure_reads_as_one_line() {
    let message = expected(40).to_string();
    assert_eq!(message, "client `beta` failed in state run at t_v = 0.040 s: asked to fail");
}

#[test]
fn the_recording_is_whole_up_to_the_failure() {
    let folder = tempfile::tempdir().unwrap();
    let mut clients = ring();
    clients[1].fails_at = Some(at_ms(60));
    let mut lockstep = in_process(ring_plan(&Coupling::Parallel), boxed(clients));
    let choice = Choice { csv: true, ..Choice::default() };
    lockstep.observe(Box::new(Recorder::new(folder.path(), provenance(), choice)));
    let outcome = run(lockstep, at_ms(500));
    let text = std::fs::read_to_string(folder.path().join("trajectory.csv")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "t_v_ns,alpha.out,beta.out,gamma.out");
    assert_eq!(lines.len() as u64, 1 + 1 + outcome.steps.0, "header, initial values, a row a step");
    assert!(lines.last().unwrap().starts_with("50000000,"));
    let recording = Recording::open(folder.path()).unwrap();
    assert_eq!(recording.steps(), Some(0..=outcome.steps.0));
    assert_eq!(recording.digest(outcome.steps.0).ok(), outcome.digest);
    let events = recording.events().unwrap();
    let ended = EventKind::Ended { status: "failed".to_owned() };
    assert!(
        matches!(&events[..], [began, failed, last]
            if began.what == EventKind::Began
                && matches!(failed.what, EventKind::Failed { .. })
                && (last.step, &last.what) == (outcome.steps, &ended)),
        "{events:?}"
    );
}

#[test]
fn a_recording_that_cannot_be_written_ends_the_session_for_all() {
    let (mut lockstep, threads) = over_tcp(ring_plan(&Coupling::Parallel), boxed(ring()), PATIENCE);
    lockstep.observe(Box::new(Recorder::new(std::path::Path::new("/no/such/folder"), provenance(), Choice::default())));
    let error = lockstep.run().expect_err("it cannot record");
    assert!(error.to_string().starts_with("cannot write /no/such/folder/events.jsonl: "), "{error}");
    for thread in threads {
        assert!(matches!(thread.join().expect("no panic"), Ok(SessionEnd::Stopped { .. })));
    }
}
