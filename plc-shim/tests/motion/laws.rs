//! What holds for any commands at any time.

use proptest::prelude::*;

use crate::bench::{Bench, State};

/// Limits of the axis in these tests.
const VELOCITY: f64 = 20.0;
const ACCELERATION: f64 = 50.0;

/// A command to X: the block, its values, and how many scans until the next.
#[derive(Debug, Clone)]
struct Order {
    block: &'static str,
    values: Vec<(&'static str, f64)>,
    scans: usize,
}

fn order() -> impl Strategy<Value = Order> {
    let block = prop::sample::select(vec![
        "Absolute",
        "Absolute2",
        "Relative",
        "Additive",
        "Velocity",
        "Halt",
        "Superimposed",
        "Absolute3",
        "Relative2",
    ]);
    let values = (-30.0..30.0_f64, 0.5..VELOCITY, 1.0..ACCELERATION, prop_oneof![Just(0.0), 10.0..800.0_f64], 0..6_i32);
    (block, values, 1..120_usize).prop_map(|(block, (way, velocity, acceleration, jerk, mode), scans)| {
        let dynamics = [("Acceleration", acceleration), ("Deceleration", acceleration), ("Jerk", jerk)];
        let mode = ("BufferMode", f64::from(mode));
        let mut values = dynamics.to_vec();
        match block {
            "Halt" => values = vec![dynamics[1], dynamics[2], mode],
            "Superimposed" => values.extend([("Distance", way / 10.0), ("VelocityDiff", velocity)]),
            "Velocity" => values.extend([("Velocity", velocity * way.signum()), mode]),
            "Relative" | "Relative2" | "Additive" => values.extend([("Distance", way), ("Velocity", velocity), mode]),
            _ => values.extend([("Position", way), ("Velocity", velocity), mode]),
        }
        Order { block, values, scans }
    })
}

/// Velocity and acceleration belong to the position; neither is beyond what a command and what is on top of it allow.
fn obeys(bench: &mut Bench, last: &mut (f64, f64)) {
    let (before, velocity) = *last;
    bench.scan();
    let dt = 0.01;
    let (position, speed) = (bench.position(), bench.velocity());
    assert!(position.is_finite() && speed.is_finite());
    // The way of a step is between those of its least and its greatest velocity, which accelerations bound.
    let most = 2.0 * ACCELERATION * dt;
    assert!((speed - velocity).abs() <= most + 1e-9, "{velocity} to {speed} u/s in a step");
    assert!(((position - before) / dt - f64::midpoint(speed, velocity)).abs() <= most + 1e-6, "{before} to {position}");
    assert!(speed.abs() <= 2.0 * VELOCITY + 1e-9, "{speed} u/s");
    *last = (position, speed);
}

fn carry_out(orders: &[Order]) -> (Bench, Vec<u8>) {
    let mut bench = Bench::new();
    bench.set_real("X.MaxVelocity", VELOCITY);
    bench.set_real("X.MaxAcceleration", ACCELERATION);
    bench.set_real("X.MaxDeceleration", ACCELERATION);
    let mut last = (0.0, 0.0);
    for order in orders {
        bench.set(&format!("{}.Execute", order.block), false);
        obeys(&mut bench, &mut last);
        bench.start(order.block, &order.values);
        for _ in 0..order.scans {
            obeys(&mut bench, &mut last);
        }
    }
    bench.start("Stop", &[("Deceleration", 10.0)]);
    for _ in 0..600 {
        obeys(&mut bench, &mut last);
    }
    let memory = bench.memory().to_vec();
    (bench, memory)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn limits_hold_whatever_is_commanded_and_a_stop_ends_it(orders in prop::collection::vec(order(), 1..10)) {
        let (bench, memory) = carry_out(&orders);
        prop_assert_eq!((bench.velocity(), bench.state(), bench.get("Stop.Done")), (0.0, State::Stopping, true));
        for order in &orders {
            let busy = format!("{}.Busy", order.block);
            prop_assert!(!bench.get(&busy), "{}", busy);
        }
        // Another run is this one, to the last bit.
        prop_assert_eq!(carry_out(&orders).1, memory);
    }

    #[test]
    fn a_move_from_rest_never_turns_and_arrives_exactly(
        distance in -50.0..50.0_f64,
        velocity in 0.5..VELOCITY,
        acceleration in 1.0..ACCELERATION,
        deceleration in 1.0..ACCELERATION,
        jerk in prop_oneof![Just(0.0), 5.0..500.0_f64],
    ) {
        let mut bench = Bench::new();
        bench.start("Absolute", &[
            ("Position", distance), ("Velocity", velocity), ("Acceleration", acceleration),
            ("Deceleration", deceleration), ("Jerk", jerk),
        ]);
        bench.scan();
        let mut last = (bench.position(), bench.acceleration());
        while !bench.get("Absolute.Done") {
            bench.scan();
            let forward = distance.signum();
            prop_assert!((bench.position() - last.0) * forward >= -1e-12, "turns at {}", last.0);
            prop_assert!(bench.velocity().abs() <= velocity * (1.0 + 1e-12));
            let a = bench.acceleration() * forward;
            prop_assert!(a <= acceleration * (1.0 + 1e-9) && a >= -deceleration * (1.0 + 1e-9), "{}", a);
            if jerk > 0.0 {
                prop_assert!((bench.acceleration() - last.1).abs() <= jerk * 0.01 * (1.0 + 1e-9) + 1e-9);
            }
            last = (bench.position(), bench.acceleration());
        }
        prop_assert_eq!((bench.position(), bench.velocity(), bench.acceleration()), (distance, 0.0, 0.0));
    }
}
