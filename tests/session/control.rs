//! Stop, pause, single step and reset: at step boundaries, for all at once, without a trace in the digest.

use std::time::Duration;

use onescan_server::client::{Client, ClientFault, JoinRequest, OperationRefused, Wake};
use onescan_server::end::SessionEnd;
use onescan_server::lockstep::Outcome;
use onescan_server::mailbox::Mailbox;
use onescan_server::operation::{Control, Operation};
use onescan_server::plan::Coupling;
use onescan_server::time::{StepCount, VirtualTime};
use onescan_server::transport::tcp::Lobby;
use onescan_server::transport::tcp::operator::operate;
use onescan_tests::at_ms;
use onescan_tests::run::{PATIENCE, boxed, in_process, loopback, run};
use onescan_tests::toy::{Mixer, ring, ring_plan};

fn undisturbed() -> Outcome {
    run(in_process(ring_plan(&Coupling::Parallel), boxed(ring())), at_ms(500))
}

/// Runs the ring to 500 ms in a thread, held from the start, while `operator` uses the mailbox's address.
fn operated(operator: impl FnOnce(&dyn Fn(Option<Control>) -> onescan_server::wire::message::Status)) -> Outcome {
    operated_behind(&[], operator)
}

/// The same, with wishes that wait in the mailbox before the session looks into it.
fn operated_behind(
    first: &[Control],
    operator: impl FnOnce(&dyn Fn(Option<Control>) -> onescan_server::wire::message::Status),
) -> Outcome {
    let mailbox = Mailbox::new();
    let lobby = Lobby::open(loopback(), &ring_plan(&Coupling::Parallel), mailbox.clone()).expect("a free port");
    let address = lobby.address();
    mailbox.control(Control::Pause);
    for control in first {
        mailbox.control(*control);
    }
    let session = std::thread::spawn(move || {
        let mut lockstep = in_process(ring_plan(&Coupling::Parallel), boxed(ring()));
        lockstep.set_mailbox(mailbox);
        let outcome = run(lockstep, at_ms(500));
        // As a run that is over does, at once.
        drop(lobby);
        outcome
    });
    operator(&|control| operate(address, control.map(Into::into), PATIENCE).expect("the session answers"));
    session.join().expect("no panic")
}

#[test]
fn pause_and_single_steps_leave_no_trace() {
    let outcome = operated(|ask| {
        let status = ask(None);
        assert!(status.held && status.steps == StepCount(0));
        for step in 1..=3 {
            ask(Some(Control::Step));
            let status = ask(None);
            assert!(status.held);
            assert_eq!(status.steps, StepCount(step), "exactly one step each");
            assert_eq!(status.t_v, at_ms(10 * step));
        }
        ask(Some(Control::Resume));
    });
    assert_eq!(outcome, undisturbed());
}

#[test]
fn steps_that_wait_together_are_one_each() {
    let outcome = operated_behind(&[Control::Step; 7], |ask| {
        let status = ask(None);
        assert_eq!((status.steps, status.held), (StepCount(7), true));
        ask(Some(Control::Resume));
    });
    assert_eq!(outcome, undisturbed());
    let outcome = operated_behind(&[Control::Step, Control::Step, Control::Reset, Control::Step], |ask| {
        assert_eq!(ask(None).steps, StepCount(1));
        ask(Some(Control::Resume));
    });
    assert_eq!(outcome, undisturbed());
}

#[test]
fn after_a_reset_the_session_is_a_new_one() {
    let outcome = operated(|ask| {
        for _ in 0..7 {
            ask(Some(Control::Step));
        }
        assert_eq!(ask(None).steps, StepCount(7));
        ask(Some(Control::Reset));
        let status = ask(None);
        assert_eq!((status.steps, status.held), (StepCount(0), true));
        ask(Some(Control::Resume));
    });
    assert_eq!(outcome, undisturbed());
}

/// A client whose program nobody can start again.
struct GoesOn(Mixer);

impl Client for GoesOn {
    fn join(&self) -> JoinRequest {
        self.0.join()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.0.setup(outputs)
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.0.turn(t_v, inputs, outputs)
    }

    fn can_reset(&self) -> Result<(), OperationRefused> {
        Err(OperationRefused::Because("its program goes on".to_owned()))
    }
}

/// The session is not reset then, and goes on as if nobody had asked.
#[test]
fn a_session_is_reset_with_all_of_its_clients_or_not_at_all() {
    let mailbox = Mailbox::new();
    mailbox.control(Control::Pause);
    let lobby = Lobby::open(loopback(), &ring_plan(&Coupling::Parallel), mailbox.clone()).expect("a free port");
    let address = lobby.address();
    let session = std::thread::spawn(move || {
        let mut clients = boxed(ring());
        let last = ring().pop().expect("three");
        clients.pop();
        clients.push(Box::new(GoesOn(last)));
        let mut lockstep = in_process(ring_plan(&Coupling::Parallel), clients);
        lockstep.set_mailbox(mailbox);
        let outcome = run(lockstep, at_ms(500));
        drop(lobby);
        outcome
    });
    let ask = |control: Control| operate(address, Some(Operation::from(control)), PATIENCE);
    for _ in 0..3 {
        ask(Control::Step).expect("a step");
    }
    let refused = ask(Control::Reset).expect_err("one goes on").to_string();
    let said = "the session is not reset, because of client `gamma`: its program goes on";
    assert!(refused.contains(said), "{refused}");
    assert_eq!(ask(Control::Pause).expect("a status").steps, StepCount(3));
    ask(Control::Resume).expect("it goes on");
    assert_eq!(session.join().expect("no panic"), undisturbed());
}

#[test]
fn a_stop_ends_the_session_at_the_boundary() {
    let outcome = operated(|ask| {
        ask(Some(Control::Step));
        ask(Some(Control::Step));
        assert_eq!(ask(None).steps, StepCount(2));
        ask(Some(Control::Stop));
    });
    assert_eq!(outcome.end, SessionEnd::Stopped { t_v: at_ms(20) });
    assert_eq!(outcome.digest, run(in_process(ring_plan(&Coupling::Parallel), boxed(ring())), at_ms(20)).digest);
}

/// The session and its lobby end while the answer is on its way.
#[test]
fn whoever_stops_a_session_hears_that_it_is_stopped() {
    for _ in 0..50 {
        let outcome = operated(|ask| assert_eq!(ask(Some(Control::Stop)).steps, StepCount(0)));
        assert_eq!(outcome.end, SessionEnd::Stopped { t_v: at_ms(0) });
    }
}

#[test]
fn an_operator_with_nobody_to_ask_is_notified() {
    let address = {
        let lobby = Lobby::open(loopback(), &ring_plan(&Coupling::Parallel), Mailbox::new()).expect("a free port");
        lobby.address()
    };
    let error = operate(address, None, Duration::from_secs(5)).expect_err("nobody listens");
    assert!(error.to_string().starts_with("cannot connect to the server at 127.0.0.1:"), "{error}");
}
