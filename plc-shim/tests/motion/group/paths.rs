//! Lines and arcs against closed forms, at several cycle times.

use super::bench::{BUFFERED, GroupState, apart, axis_state, line, norm, place, six, standby, state, trace, velocity};
use crate::bench::State;

const MS: u64 = 1_000_000;

/// Position along a move at rest at both ends, with a trapezoid of velocities.
fn trapezoid(way: f64, velocity: f64, acceleration: f64, t: f64) -> f64 {
    let ramp = velocity / acceleration;
    let whole = way / velocity + ramp;
    let t = t.clamp(0.0, whole);
    if t < ramp {
        acceleration * t * t / 2.0
    } else if t < whole - ramp {
        velocity * (t - ramp / 2.0)
    } else {
        way - acceleration * (whole - t).powi(2) / 2.0
    }
}

#[test]
fn a_line_is_straight_and_in_time_at_any_cycle() {
    let goal = [0.6, -0.8, 2.4];
    let way = norm(goal);
    for step_ms in [1, 4, 10, 37] {
        let mut bench = standby(3);
        bench.step_ns = step_ms * MS;
        let begin = bench.now_s() + bench.step_ns as f64 * 1e-9;
        line(&mut bench, "Linear", &goal, &[("Velocity", 0.5), ("Acceleration", 2.0), ("Deceleration", 2.0)]);
        bench.scan();
        assert_eq!((state(&bench), axis_state(&bench, 2)), (GroupState::Moving, State::SynchronizedMotion));
        while !bench.get("Linear.Done") {
            let s = trapezoid(way, 0.5, 2.0, bench.now_s() - begin);
            let expected = goal.map(|each| each * s / way);
            assert!(apart(place(&bench), expected) < 1e-9, "{step_ms} ms: {:?}, not {expected:?}", place(&bench));
            bench.scan();
        }
        let late = bench.now_s() - begin - (way / 0.5 + 0.25);
        assert!((0.0..=step_ms as f64 * 1e-3 + 1e-9).contains(&late), "{late} s late");
        assert_eq!(place(&bench), goal);
        assert_eq!((state(&bench), axis_state(&bench, 2)), (GroupState::Standby, State::Standstill));
    }
}

/// Three ways to say the same quarter of a circle about [1, 0, 0.5], from its right to its top.
#[test]
fn an_arc_is_round_by_border_center_and_radius() {
    let half = 0.5_f64.sqrt();
    for (mode, aux, choice) in
        [(0.0, [1.0 + half, half, 0.5], 0.0), (1.0, [1.0, 0.0, 0.5], 1.0), (2.0, [0.0, 0.0, 1.0], 1.0)]
    {
        for step_ms in [1, 10] {
            let mut bench = standby(3);
            bench.step_ns = step_ms * MS;
            line(&mut bench, "Linear", &[2.0, 0.0, 0.5], &[("Velocity", 2.0)]);
            trace(&mut bench, "Linear.Done");
            six(&mut bench, "Circular.AuxPoint", &aux);
            six(&mut bench, "Circular.EndPoint", &[1.0, 1.0, 0.5]);
            bench.start(
                "Circular",
                &[
                    ("CircMode", mode),
                    ("PathChoice", choice),
                    ("Velocity", 0.25),
                    ("Acceleration", 1.0),
                    ("Jerk", 10.0),
                ],
            );
            let places = trace(&mut bench, "Circular.Done");
            let radii = places.iter().map(|at| (at[0] - 1.0).hypot(at[1]));
            let off = radii.map(|radius| (radius - 1.0).abs()).fold(0.0, f64::max);
            assert!(off <= 1e-6, "mode {mode}: {off} m off the circle");
            assert!(off <= 1e-12, "set values are to the last digits: {off}");
            assert!(places.iter().all(|at| (at[2] - 0.5).abs() < 1e-12 && at[0] >= 1.0 - 1e-9 && at[1] >= -1e-9));
            assert!(apart(place(&bench), [1.0, 1.0, 0.5]) < 1e-12, "{:?}", place(&bench));
            let way: f64 = places.windows(2).map(|pair| apart(pair[0], pair[1])).sum();
            assert!((way - std::f64::consts::FRAC_PI_2).abs() < 1e-5, "{way}");
        }
    }
}

#[test]
fn the_long_way_round_and_a_whole_circle() {
    for (end, choice, expected) in [([0.0, 1.0], 0.0, 1.5), ([0.0, 1.0], 1.0, 0.5), ([1.0, 0.0], 1.0, 2.0)] {
        let mut bench = standby(2);
        line(&mut bench, "Linear", &[1.0, 0.0], &[("Velocity", 2.0)]);
        trace(&mut bench, "Linear.Done");
        six(&mut bench, "Circular.EndPoint", &end);
        bench.start("Circular", &[("CircMode", 1.0), ("PathChoice", choice), ("Velocity", 1.0)]);
        let places = trace(&mut bench, "Circular.Done");
        let way: f64 = places.windows(2).map(|pair| apart(pair[0], pair[1])).sum();
        assert!((way - expected * std::f64::consts::PI).abs() < 1e-4, "{way} instead of {expected} pi");
    }
}

/// In a plane that lies anywhere, with points relative to the start in the product's coordinates.
#[test]
fn an_arc_in_a_turned_and_shifted_plane() {
    let mut bench = standby(3);
    bench.start(
        "Cartesian",
        &[
            ("TransX", 0.3),
            ("TransY", -0.2),
            ("TransZ", 0.1),
            ("RotAngle1", 0.4),
            ("RotAngle2", -0.3),
            ("RotAngle3", 1.1),
        ],
    );
    bench.scan();
    line(&mut bench, "Linear", &[0.5, 0.0, 0.0], &[("Velocity", 1.0), ("CoordSystem", 2.0)]);
    trace(&mut bench, "Linear.Done");
    six(&mut bench, "CircularRelative.AuxPoint", &[-0.5, 0.5]);
    six(&mut bench, "CircularRelative.EndPoint", &[-1.0, 0.0]);
    bench.start("CircularRelative", &[("Velocity", 0.5), ("CoordSystem", 2.0)]);
    bench.set_int("ReadPosition.CoordSystem", 2);
    bench.scan();
    while !bench.get("CircularRelative.Done") {
        bench.scan();
        let [x, y, z] = [1, 2, 3].map(|k| bench.real(&format!("ReadPosition.Position[{k}]")));
        assert!((x.hypot(y) - 0.5).abs() < 1e-12 && z.abs() < 1e-12 && y > -1e-12, "{x} {y} {z}");
        assert!((apart(place(&bench), [0.3, -0.2, 0.1]) - 0.5).abs() < 1e-12);
    }
    let x = bench.real("ReadPosition.Position[1]");
    assert!((x + 0.5).abs() < 1e-12, "{x}");
}

#[test]
fn axes_of_a_direct_move_begin_and_end_together_and_one_is_at_its_limits() {
    let mut bench = standby(3);
    bench.set_real("A[2].MaxVelocity", 0.5);
    line(&mut bench, "Direct", &[1.0, 1.0, -0.5], &[]);
    bench.scan();
    let begin = bench.now_s();
    let mut fastest = [0.0_f64; 3];
    while !bench.get("Direct.Done") {
        let at = place(&bench);
        assert!((at[0] - at[1]).abs() < 1e-12 && (at[2] + at[0] / 2.0).abs() < 1e-12, "{at:?}");
        let rates = velocity(&bench);
        (0..3).for_each(|k| fastest[k] = fastest[k].max(rates[k].abs()));
        bench.scan();
    }
    assert!((fastest[1] - 0.5).abs() < 1e-9 && (fastest[0] - 0.5).abs() < 1e-9, "{fastest:?}");
    // 1 m at 0.5 m/s, and one ramp of 20 m/s2.
    assert!((bench.now_s() - begin - 2.025).abs() < 0.011);
    line(&mut bench, "DirectRelative", &[0.0, -0.25, 0.0], &[]);
    trace(&mut bench, "DirectRelative.Done");
    assert_eq!(place(&bench), [1.0, 0.75, -0.5]);
}

#[test]
fn a_relative_line_begins_where_the_one_before_ends() {
    let mut bench = standby(3);
    line(&mut bench, "Linear", &[0.5, 0.1, 0.0], &[("Velocity", 1.0)]);
    bench.scan();
    line(&mut bench, "Relative", &[0.0, 0.3, 0.2], &[("Velocity", 1.0), ("BufferMode", BUFFERED)]);
    bench.scan();
    assert!(bench.get("Linear.Active") && bench.get("Relative.Busy") && !bench.get("Relative.Active"));
    trace(&mut bench, "Linear.Done");
    assert!(bench.get("Relative.Active") && apart(place(&bench), [0.5, 0.1, 0.0]) < 0.01);
    trace(&mut bench, "Relative.Done");
    assert!(apart(place(&bench), [0.5, 0.4, 0.2]) < 1e-12);
}

/// With limits of jerk: what is read of the velocity belongs to the positions.
#[test]
fn velocities_are_those_of_the_positions() {
    let mut bench = standby(3);
    bench.step_ns = MS;
    six(&mut bench, "Circular.AuxPoint", &[0.5, 0.5, 0.2]);
    six(&mut bench, "Circular.EndPoint", &[1.0, 0.0, 0.0]);
    bench.start("Circular", &[("Velocity", 0.8), ("Acceleration", 3.0), ("Deceleration", 2.0), ("Jerk", 20.0)]);
    let mut last = (place(&bench), velocity(&bench));
    while !bench.get("Circular.Done") {
        bench.scan();
        let now = (place(&bench), velocity(&bench));
        for k in 0..3 {
            let mean = (now.0[k] - last.0[k]) / 1e-3;
            assert!((mean - f64::midpoint(now.1[k], last.1[k])).abs() < 1e-5, "{mean}, {now:?}");
        }
        let speed = norm(now.1);
        let read = bench.real("G.PathVelocity");
        let actual = bench.real("ReadVelocity.PathVelocity");
        let parts = [1, 2, 3].map(|k| bench.real(&format!("ReadVelocity.Velocity[{k}]")));
        assert!((actual - speed).abs() < 1e-9 && apart(parts, now.1) < 1e-9, "{actual}, {parts:?}");
        assert!((speed - read).abs() < 1e-6 && speed <= 0.8 + 1e-6, "{speed} {read}");
        last = now;
    }
}
