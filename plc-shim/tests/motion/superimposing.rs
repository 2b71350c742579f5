//! `MC_MoveSuperimposed` (3.8).

use crate::bench::{Bench, State};

#[test]
fn the_distance_is_added_to_that_of_the_move() {
    let mut bench = Bench::new();
    bench.start("Absolute", &[("Position", 20.0), ("Velocity", 5.0), ("Acceleration", 10.0), ("Deceleration", 10.0)]);
    bench.scans(50);
    bench.start(
        "Superimposed",
        &[("Distance", 3.0), ("VelocityDiff", 2.0), ("Acceleration", 10.0), ("Deceleration", 10.0)],
    );
    bench.scans(30);
    assert!((bench.velocity() - 7.0).abs() < 1e-9, "{}", bench.velocity());
    assert_eq!((bench.get("Superimposed.Active"), bench.get("Absolute.Active")), (true, true));
    bench.until("Superimposed.Done");
    assert!((bench.real("Superimposed.CoveredDistance") - 3.0).abs() < 1e-9);
    assert!(bench.get("Absolute.Active"));
    bench.until("Absolute.Done");
    assert_eq!((bench.position(), bench.state()), (23.0, State::Standstill));
}

#[test]
fn one_that_lasts_longer_than_the_move_goes_on_alone() {
    let mut bench = Bench::new();
    bench.start("Absolute", &[("Position", 2.0), ("Velocity", 5.0), ("Acceleration", 10.0), ("Deceleration", 10.0)]);
    bench.scan();
    bench.start("Superimposed", &[("Distance", 10.0), ("VelocityDiff", 1.0), ("Acceleration", 10.0)]);
    bench.until("Absolute.Done");
    assert_eq!((bench.state(), bench.get("Superimposed.Active")), (State::DiscreteMotion, true));
    bench.until("Superimposed.Done");
    assert_eq!((bench.position(), bench.state()), (12.0, State::Standstill));
    // The next absolute move does not know of it.
    bench.start("Absolute2", &[("Position", 1.0), ("Velocity", 5.0)]);
    bench.until("Absolute2.Done");
    assert_eq!(bench.position(), 1.0);
}

#[test]
fn an_aborting_command_ends_both_and_a_buffered_one_only_waits() {
    let mut bench = Bench::new();
    bench.start("Velocity", &[("Velocity", 5.0), ("Acceleration", 10.0)]);
    bench.until("Velocity.InVelocity");
    bench.start("Superimposed", &[("Distance", 10.0), ("VelocityDiff", 2.0), ("Acceleration", 10.0)]);
    bench.scans(50);
    let (before, speed) = (bench.position(), bench.velocity());
    bench.start("Halt", &[("Deceleration", 10.0)]);
    bench.scan();
    // What was superimposed is part of what comes to rest: no jump.
    assert!((bench.velocity() - speed).abs() < 0.11 && (bench.position() - before - 0.07).abs() < 0.002);
    bench.scan();
    assert!(bench.get("Velocity.CommandAborted") && bench.get("Superimposed.CommandAborted"));
    bench.until("Halt.Done");
    assert_eq!(bench.velocity(), 0.0);
}

#[test]
fn a_second_one_takes_over() {
    let mut bench = Bench::new();
    bench.start("Superimposed", &[("Distance", 10.0), ("VelocityDiff", 2.0), ("Acceleration", 10.0)]);
    bench.scans(100);
    bench.set("Superimposed.Execute", false);
    bench.scan();
    bench.start(
        "Superimposed",
        &[("Distance", 1.0), ("VelocityDiff", 2.0), ("Acceleration", 10.0), ("Deceleration", 10.0)],
    );
    bench.scan();
    let here = bench.position();
    bench.until("Superimposed.Done");
    assert!((bench.position() - here - 1.0).abs() < 1e-9, "{}", bench.position() - here);
}
