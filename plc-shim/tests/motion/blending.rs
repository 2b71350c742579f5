//! Buffer modes (2.4.2): what becomes of the velocity between two moves.

use crate::bench::{Bench, State};

const ABORTING: f64 = 0.0;
const BUFFERED: f64 = 1.0;
const LOW: f64 = 2.0;
const PREVIOUS: f64 = 3.0;
const NEXT: f64 = 4.0;
const HIGH: f64 = 5.0;

/// How X passes the end of its first move.
struct Passed {
    /// Velocity where the first move ends.
    velocity: f64,
    /// When the first is done, and the second, s.
    done_s: [f64; 2],
    position: f64,
}

/// To 10 with `first` u/s, to `target` with `second` u/s, accelerating with 10 u/s2.
fn pass(mode: f64, first: f64, second: f64, target: f64) -> Passed {
    let mut bench = Bench::new();
    bench.step_ns = 1_000_000;
    let values = |position, velocity, mode| {
        [
            ("Position", position),
            ("Velocity", velocity),
            ("Acceleration", 10.0),
            ("Deceleration", 10.0),
            ("BufferMode", mode),
        ]
    };
    bench.start("Absolute", &values(10.0, first, ABORTING));
    bench.scan();
    let begun = bench.now_s();
    bench.start("Absolute2", &values(target, second, mode));
    bench.scan();
    assert!(bench.get("Absolute2.Busy") && !bench.get("Absolute2.Active"));
    let mut last = bench.velocity();
    while !bench.get("Absolute.Done") {
        last = bench.velocity();
        bench.scan();
    }
    assert!(bench.get("Absolute2.Active") && bench.state() == State::DiscreteMotion);
    let done = bench.now_s() - begun;
    let velocity = if mode == BUFFERED { 0.0 } else { last };
    bench.until("Absolute2.Done");
    Passed { velocity, done_s: [done, bench.now_s() - begun], position: bench.position() }
}

fn assert_near(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found} is not {wanted}");
}

#[test]
fn each_mode_has_its_velocity() {
    for (mode, velocity) in [(BUFFERED, 0.0), (LOW, 2.0), (PREVIOUS, 4.0), (NEXT, 2.0), (HIGH, 4.0)] {
        let passed = pass(mode, 4.0, 2.0, 20.0);
        assert_near(passed.velocity, velocity, 0.011);
        assert_eq!(passed.position, 20.0, "mode {mode}");
    }
    for (mode, velocity) in [(LOW, 2.0), (PREVIOUS, 2.0), (NEXT, 4.0), (HIGH, 4.0)] {
        let passed = pass(mode, 2.0, 4.0, 20.0);
        assert_near(passed.velocity, velocity, 0.011);
        assert_eq!(passed.position, 20.0, "mode {mode}");
    }
}

#[test]
fn durations_are_their_closed_forms() {
    // From rest to 4 u/s and to rest takes 0.8 s more than the way at 4 u/s takes less 0.4 s.
    let whole = |distance: f64, velocity: f64| distance / velocity + velocity / 10.0;
    let buffered = pass(BUFFERED, 4.0, 2.0, 20.0);
    assert_near(buffered.done_s[0], whole(10.0, 4.0), 0.0011);
    assert_near(buffered.done_s[1], whole(10.0, 4.0) + whole(10.0, 2.0), 0.0011);
    // It is slowed down to 2 u/s before the end of the first: 0.2 s at 3 u/s on average, 0.6 u.
    let low = pass(LOW, 4.0, 2.0, 20.0);
    let first = 0.4 + (10.0 - 0.8 - 0.6) / 4.0 + 0.2;
    assert_near(low.done_s[0], first, 0.0011);
    // 0.2 s and 0.2 u to come to rest.
    assert_near(low.done_s[1], first + (10.0 - 0.2) / 2.0 + 0.2, 0.0011);
    // It is slowed down behind the end of the first.
    let previous = pass(PREVIOUS, 4.0, 2.0, 20.0);
    let first = 0.4 + (10.0 - 0.8) / 4.0;
    assert_near(previous.done_s[0], first, 0.0011);
    assert_near(previous.done_s[1], first + 0.2 + (10.0 - 0.6 - 0.2) / 2.0 + 0.2, 0.0011);
    // It is accelerated before the end of the first.
    let next = pass(NEXT, 2.0, 4.0, 20.0);
    let first = 0.2 + (10.0 - 0.2 - 0.6) / 2.0 + 0.2;
    assert_near(next.done_s[0], first, 0.0011);
    assert_near(next.done_s[1], first + (10.0 - 0.8) / 4.0 + 0.4, 0.0011);
}

#[test]
fn there_is_no_blending_with_a_move_back() {
    for mode in [LOW, PREVIOUS, NEXT, HIGH] {
        let passed = pass(mode, 4.0, 4.0, 5.0);
        assert_near(passed.velocity, 0.0, 0.011);
        assert_eq!(passed.position, 5.0);
    }
}

/// The second move is too short to come to rest from the first's velocity: 0.05 u at 10 u/s2 allow 1 u/s.
#[test]
fn a_short_second_move_is_not_overrun() {
    let passed = pass(PREVIOUS, 4.0, 4.0, 10.05);
    assert_near(passed.velocity, 1.0, 0.011);
    assert_eq!(passed.position, 10.05);
}

#[test]
fn a_path_of_blended_moves_goes_through_all_of_them() {
    let mut bench = Bench::new();
    let blocks = ["Absolute", "Absolute2", "Absolute3"];
    for (at, block) in blocks.into_iter().enumerate() {
        let mode = if at == 0 { ABORTING } else { HIGH };
        bench.start(
            block,
            &[
                ("Position", (at + 1) as f64),
                ("Velocity", 2.0),
                ("Acceleration", 5.0),
                ("Jerk", 50.0),
                ("BufferMode", mode),
            ],
        );
    }
    bench.scan();
    let mut highest = 0.0_f64;
    let mut slowest = f64::MAX;
    while !bench.get("Absolute3.Done") {
        bench.scan();
        highest = highest.max(bench.velocity());
        if bench.position() > 0.9 && bench.position() < 2.1 {
            slowest = slowest.min(bench.velocity());
        }
    }
    assert_eq!(bench.position(), 3.0);
    assert!(highest <= 2.0 + 1e-9 && slowest > 1.9, "{highest} {slowest}");
}

#[test]
fn a_fifth_buffered_command_has_no_room() {
    let mut bench = Bench::new();
    let far = [("Velocity", 1.0), ("BufferMode", BUFFERED)];
    for (block, position) in [("Absolute", 1.0), ("Absolute2", 2.0), ("Absolute3", 3.0)] {
        bench.start(block, &[("Position", position), far[0], far[1]]);
    }
    bench.start("Relative", &[("Distance", 1.0), far[0], far[1]]);
    bench.start("Relative2", &[("Distance", 1.0), far[0], far[1]]);
    bench.scan();
    assert!(bench.get("Absolute.Active") && bench.get("Relative2.Busy"));
    bench.start("Additive", &[("Distance", 1.0), far[0], far[1]]);
    bench.scan();
    assert_eq!((bench.get("Additive.Error"), bench.int("Additive.ErrorID")), (true, 0x14));
    bench.until("Relative2.Done");
    assert_eq!(bench.position(), 5.0);
}

/// A move that is buffered behind a velocity waits until that is reached.
#[test]
fn behind_a_velocity_it_begins_when_that_is_reached() {
    let mut bench = Bench::new();
    bench.start("Velocity", &[("Velocity", 10.0), ("Acceleration", 10.0)]);
    bench.scan();
    bench
        .start("Relative", &[("Distance", 50.0), ("Velocity", 10.0), ("Acceleration", 10.0), ("BufferMode", BUFFERED)]);
    bench.until("Relative.Active");
    assert!((bench.now_s() - 1.02).abs() < 0.011 && bench.get("Velocity.CommandAborted"), "{}", bench.now_s());
    bench.until("Relative.Done");
    assert!((bench.position() - 55.0).abs() < 1e-9, "{}", bench.position());
}

#[test]
fn inputs_are_followed_with_continuous_update_only() {
    for (followed, position) in [(true, 7.0), (false, 5.0)] {
        let mut bench = Bench::new();
        bench.set("Absolute.ContinuousUpdate", followed);
        bench.start("Absolute", &[("Position", 5.0), ("Velocity", 2.0), ("Acceleration", 5.0)]);
        bench.scans(20);
        bench.set_real("Absolute.Position", 7.0);
        bench.until("Absolute.Done");
        assert_eq!(bench.position(), position);
    }
    // A distance counts from where the move began.
    let mut bench = Bench::new();
    bench.start("Absolute", &[("Position", 1.0), ("Velocity", 2.0)]);
    bench.until("Absolute.Done");
    bench.set("Relative.ContinuousUpdate", true);
    bench.start("Relative", &[("Distance", 5.0), ("Velocity", 2.0), ("Acceleration", 5.0)]);
    bench.scans(20);
    bench.set_real("Relative.Distance", 3.0);
    bench.until("Relative.Done");
    assert_eq!(bench.position(), 4.0);
}

#[test]
fn an_additive_move_counts_from_the_last_target() {
    let mut bench = Bench::new();
    bench.start("Absolute", &[("Position", 10.0), ("Velocity", 2.0), ("Acceleration", 5.0)]);
    bench.scans(50);
    bench.start("Additive", &[("Distance", 5.0), ("Velocity", 2.0), ("Acceleration", 5.0)]);
    bench.until("Additive.Done");
    assert_eq!(bench.position(), 15.0);
    bench.start("Velocity", &[("Velocity", 2.0), ("Acceleration", 5.0)]);
    bench.scans(50);
    let here = bench.position();
    bench.set("Additive.Execute", false);
    bench.scan();
    let here = here + 0.02;
    bench.start("Additive", &[("Distance", 5.0), ("Velocity", 2.0), ("Acceleration", 5.0)]);
    bench.scan();
    bench.until("Additive.Done");
    // In ContinuousMotion from the set position at the start.
    assert!((bench.position() - here - 0.02 - 5.0).abs() < 1e-9, "{}", bench.position() - here);
}
