//! Steps in which nobody is due are gone over at once, and nobody can notice: not by the digest, not by what
//! operations do.

use std::cell::RefCell;
use std::num::NonZeroU32;
use std::rc::Rc;

use onescan_server::digest::{Digest, TrajectoryDigest};
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Author, Operation, OperatorInput};
use onescan_server::pacing::Pace;
use onescan_server::plan::Coupling;
use onescan_server::session::Session;
use onescan_server::signal::SignalName;
use onescan_server::time::StepCount;
use onescan_server::timeline::{Condition, Relation, Scheduled, Timeline, When};
use onescan_tests::bench::two_sleepers;
use onescan_tests::run::{PATIENCE, boxed, in_process, over_tcp, run};
use onescan_tests::{at_ms, client};
use proptest::prelude::*;

/// Counts the steps that it sees, and wants to see all or not.
struct Counter {
    all: bool,
    seen: Rc<RefCell<Vec<u64>>>,
}

impl Observer for Counter {
    fn begin(&mut self, _: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        Ok(())
    }

    fn step(&mut self, session: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        self.seen.borrow_mut().push(session.cycle().steps().0);
        Ok(())
    }

    fn wants_idle_steps(&self) -> bool {
        self.all
    }

    fn end(&mut self, _: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}

/// How a session is run: nothing of it may be seen in the digest.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// Resting.
    Freely,
    /// In every state of every step: at a pace that holds nothing back.
    StepByStep,
    /// Watched by somebody who wants every step.
    Observed,
}

/// Operations at 40 ms and 70 ms, and, if `judged`, one 5 ms after the plant has taken three turns.
fn planned(judged: bool) -> Vec<Scheduled> {
    let plc = SignalName::new("plc").expect("a name");
    let force = Operation::Force { signal: plc.clone(), value: "99".into() };
    let release = Operation::Release { signal: plc };
    let at = |ms, operation| Scheduled { when: When::At(at_ms(ms)), operation };
    let mut all = vec![at(40, force), at(70, release)];
    if judged {
        let plant = SignalName::new("plant").expect("a name");
        let condition = Condition::Compare { signal: plant.clone(), relation: Relation::AtLeast, value: "3".into() };
        let when = When::Once { condition, from: at_ms(0), nth: NonZeroU32::MIN, delay: None };
        all.push(Scheduled { when, operation: Operation::Write { signal: plant, value: "7".into() } });
    }
    all
}

fn digest(coupling: &Coupling<onescan_server::signal::ClientName>, sleeps: [u64; 2], judged: bool, way: Way) -> Digest {
    let (plan, sleepers) = two_sleepers(coupling, sleeps);
    let mut lockstep = in_process(plan, boxed(sleepers));
    let timeline = Timeline::new(planned(judged), lockstep.session()).expect("the signals are there");
    lockstep.set_timeline(timeline);
    lockstep.replay(vec![OperatorInput {
        resets: 0,
        step: StepCount(113),
        t_v: at_ms(113),
        author: Author::Operator,
        operation: Operation::Write { signal: SignalName::new("plant").expect("a name"), value: "1".into() },
    }]);
    match way {
        Way::Freely => {}
        Way::StepByStep => lockstep.set_pace(Pace::Factor(1e9)),
        Way::Observed => lockstep.observe(Box::new(Counter { all: true, seen: Rc::default() })),
    }
    run(lockstep, at_ms(1_000)).digest.expect("it ran")
}

#[test]
fn who_need_not_see_every_step_sees_the_last_of_a_rest() {
    let counted = |all| {
        let (plan, sleepers) = two_sleepers(&Coupling::Parallel, [100, 1_000_000]);
        let mut lockstep = in_process(plan, boxed(sleepers));
        let seen = Rc::new(RefCell::new(Vec::new()));
        lockstep.observe(Box::new(Counter { all, seen: Rc::clone(&seen) }));
        let outcome = run(lockstep, at_ms(250));
        (outcome, seen.take())
    };
    let (free, seen) = counted(false);
    assert_eq!(seen, [1, 100, 101, 200, 201, 250], "turns in steps 1, 101 and 201");
    let (observed, seen) = counted(true);
    assert_eq!(seen, (1..=250).collect::<Vec<_>>());
    assert_eq!(free, observed);
}

#[test]
fn a_rest_ends_at_the_boundary_that_is_asked_for() {
    let (plan, sleepers) = two_sleepers(&Coupling::Parallel, [1_000, 1_000]);
    let mut lockstep = in_process(plan, boxed(sleepers));
    for goal in [3, 4, 500, 10_007] {
        lockstep.run_to(at_ms(goal)).expect("nothing is recorded");
        assert_eq!(lockstep.session().t_v(), at_ms(goal));
    }
}

#[test]
fn transport_does_not_change_the_digest_of_a_rest() {
    let (plan, sleepers) = two_sleepers(&Coupling::Parallel, [37, 50]);
    let (lockstep, threads) = over_tcp(plan, boxed(sleepers), PATIENCE);
    let remote = run(lockstep, at_ms(2_000));
    for thread in threads {
        thread.join().expect("no panic").expect("a good end");
    }
    let (plan, sleepers) = two_sleepers(&Coupling::Parallel, [37, 50]);
    assert_eq!(run(in_process(plan, boxed(sleepers)), at_ms(2_000)), remote);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn rest_leaves_no_trace(one in 1..300_u64, other in 1..300_u64, judged: bool, sequential: bool) {
        let coupling = if sequential { Coupling::Sequential { order: ["plc", "plant"].map(client).to_vec() } } else { Coupling::Parallel };
        let digests = [Way::Freely, Way::StepByStep, Way::Observed].map(|way| digest(&coupling, [one, other], judged, way));
        prop_assert_eq!(digests[0], digests[1]);
        prop_assert_eq!(digests[0], digests[2]);
    }
}
