//! A session is a value: it can be saved at any step, in any process, and goes on to the bit.

use onescan_server::checkpoint::{Checkpoint, CheckpointError};
use onescan_server::lockstep::Reached;
use onescan_server::operation::Operation;
use onescan_server::plan::Coupling;
use onescan_server::timeline::{Scheduled, Timeline, When};
use onescan_tests::run::{PATIENCE, boxed, in_process, over_tcp, run};
use onescan_tests::toy::{Mixer, RING, ring, ring_plan};
use onescan_tests::{at_ms, client, plan, span_ms};

const END_MS: u64 = 200;

fn couplings() -> [Coupling<onescan_server::signal::ClientName>; 2] {
    [Coupling::Parallel, Coupling::Sequential { order: ["gamma", "beta", "alpha"].map(client).to_vec() }]
}

#[test]
fn saved_at_any_step_it_ends_with_the_same_digest() {
    for coupling in couplings() {
        let whole = run(in_process(ring_plan(&coupling), boxed(ring())), at_ms(END_MS));
        for ms in (0..END_MS).step_by(10) {
            let mut first = in_process(ring_plan(&coupling), boxed(ring()));
            assert_eq!(first.run_to(at_ms(ms)).unwrap(), Reached::Boundary);
            let bytes = first.checkpoint().unwrap().to_bytes().unwrap();
            let mut second = in_process(ring_plan(&coupling), boxed(ring()));
            second.resume(&Checkpoint::from_bytes(&bytes).unwrap()).unwrap();
            assert_eq!(run(second, at_ms(END_MS)), whole, "saved at {ms} ms");
            assert_eq!(run(first, at_ms(END_MS)), whole, "saving at {ms} ms changes nothing");
        }
    }
}

#[test]
fn saved_over_tcp_it_goes_on_in_process_and_back() {
    let coupling = Coupling::Parallel;
    let whole = run(in_process(ring_plan(&coupling), boxed(ring())), at_ms(END_MS));
    let (mut first, _threads) = over_tcp(ring_plan(&coupling), boxed(ring()), PATIENCE);
    first.run_to(at_ms(50)).unwrap();
    let checkpoint = first.checkpoint().unwrap();
    let mut second = in_process(ring_plan(&coupling), boxed(ring()));
    second.resume(&checkpoint).unwrap();
    second.run_to(at_ms(120)).unwrap();
    let checkpoint = second.checkpoint().unwrap();
    let (mut third, threads) = over_tcp(ring_plan(&coupling), boxed(ring()), PATIENCE);
    third.resume(&checkpoint).unwrap();
    assert_eq!(run(third, at_ms(END_MS)), whole);
    for thread in threads {
        assert_eq!(thread.join().unwrap().unwrap(), whole.end);
    }
}

#[test]
fn a_damaged_or_foreign_checkpoint_is_refused() {
    let mut lockstep = in_process(ring_plan(&Coupling::Parallel), boxed(ring()));
    assert_eq!(lockstep.checkpoint().unwrap_err(), CheckpointError::NotNow);
    lockstep.run_to(at_ms(50)).unwrap();
    let checkpoint = lockstep.checkpoint().unwrap();
    let bytes = checkpoint.to_bytes().unwrap();
    for cut in 0..bytes.len() {
        assert!(Checkpoint::from_bytes(&bytes[..cut]).is_err(), "cut at {cut}");
    }
    for place in 0..bytes.len() {
        let mut bytes = bytes.clone();
        bytes[place] ^= 0x40;
        assert!(Checkpoint::from_bytes(&bytes).is_err(), "changed at {place}");
    }
    assert_eq!(Checkpoint::from_bytes(b"PNG").unwrap_err(), CheckpointError::Foreign);

    let ulint = onescan_server::signal::SignalType::ULINT;
    let other = plan(span_ms(10), &Coupling::Parallel, &[("alpha.out", ulint, "alpha")], &["alpha"]);
    let mut other = in_process(other, boxed([Mixer::new(RING[0].0, span_ms(10), &[])]));
    assert_eq!(
        other.resume(&checkpoint).unwrap_err().to_string(),
        "the checkpoint belongs to another session: it has a client `beta`, which this session does not have"
    );
}

/// Two ways to one state: the digest is over the way, the hash of the state over what is left of it.
#[test]
fn runs_that_come_together_have_one_state_and_two_digests() {
    let session = |scheduled: Vec<Scheduled>| {
        let ulint = onescan_server::signal::SignalType::ULINT;
        let plan = plan(span_ms(10), &Coupling::Parallel, &[("alpha.out", ulint, "alpha")], &["alpha"]);
        let mut lockstep = in_process(plan, boxed([Mixer::new("alpha", span_ms(10), &[])]));
        let timeline = Timeline::new(scheduled, lockstep.session()).unwrap();
        lockstep.set_timeline(timeline);
        lockstep
    };
    let signal = onescan_server::signal::SignalName::new("alpha.out").unwrap();
    let write = Operation::Write { signal, value: "7".to_owned() };
    let mut plain = session(Vec::new());
    let mut disturbed = session(vec![Scheduled { when: When::At(at_ms(30)), operation: write }]);
    let mut at = |ms: u64| {
        [&mut plain, &mut disturbed].map(|lockstep| {
            lockstep.run_to(at_ms(ms)).unwrap();
            let checkpoint = lockstep.checkpoint().unwrap();
            (checkpoint.digest(), checkpoint.state_hash().unwrap())
        })
    };
    let [before, same] = at(20);
    assert!(before.0 == same.0 && before.1 != same.1, "the write is still to come");
    let [one, other] = at(30);
    assert!(one.0 != other.0 && one.1 != other.1, "the value that was written is seen");
    let [one, other] = at(40);
    assert!(one.0 != other.0 && one.1 == other.1, "its writer has written it again, and nobody has read it");
}
