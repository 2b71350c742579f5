//! A digest depends on what the session computes and on nothing else.

use onescan_server::digest::Digest;
use onescan_server::pacing::Pace;
use onescan_server::plan::Coupling;
use onescan_tests::run::{PATIENCE, boxed, in_process, over_tcp, run};
use onescan_tests::toy::{ring, ring_plan};
use onescan_tests::{at_ms, client};

fn digest(coupling: &Coupling<onescan_server::signal::ClientName>) -> Option<Digest> {
    run(in_process(ring_plan(coupling), boxed(ring())), at_ms(1_000)).digest
}

fn backwards() -> Coupling<onescan_server::signal::ClientName> {
    Coupling::Sequential { order: ["gamma", "beta", "alpha"].map(client).to_vec() }
}

/// The digest itself is part of the contract: it may only change with a reason in the changelog.
#[test]
fn the_digest_of_a_session_is_this() {
    let parallel = digest(&Coupling::Parallel).expect("it ran");
    insta::assert_snapshot!(parallel, @"d2:aea11102c53d06a8df2058702c014d4ce0207f855b481d88ed4a5054b7b4d5a8");
}

#[test]
fn transport_does_not_change_the_digest() {
    for coupling in [Coupling::Parallel, backwards()] {
        let (lockstep, threads) = over_tcp(ring_plan(&coupling), boxed(ring()), PATIENCE);
        let outcome = run(lockstep, at_ms(1_000));
        assert_eq!(outcome.digest, digest(&coupling));
        for thread in threads {
            assert_eq!(thread.join().expect("no panic").expect("a good end"), outcome.end);
        }
    }
}

#[test]
fn order_of_joining_does_not_change_the_digest() {
    let mut clients = ring();
    clients.reverse();
    let outcome = run(in_process(ring_plan(&Coupling::Parallel), boxed(clients)), at_ms(1_000));
    assert_eq!(outcome.digest, digest(&Coupling::Parallel));
}

#[test]
fn pacing_does_not_change_the_digest() {
    let mut lockstep = in_process(ring_plan(&Coupling::Parallel), boxed(ring()));
    lockstep.set_pace(Pace::Factor(5.0));
    assert_eq!(run(lockstep, at_ms(1_000)).digest, digest(&Coupling::Parallel));
}

#[test]
fn couplings_differ_and_order_matters_in_sequence() {
    let forwards = Coupling::Sequential { order: ["alpha", "beta", "gamma"].map(client).to_vec() };
    let digests = [Coupling::Parallel, forwards, backwards()].map(|coupling| digest(&coupling));
    assert_ne!(digests[0], digests[1]);
    assert_ne!(digests[1], digests[2]);
    assert_ne!(digests[0], digests[2]);
}
