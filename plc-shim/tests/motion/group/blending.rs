//! Around corners: where a curve begins, how far it is from the corner, how fast it is.

use super::bench::{
    BLENDING_LOW, BLENDING_PREVIOUS, CONSTANT_VELOCITY, CORNER_DEVIATION, CORNER_DISTANCE, START_VELOCITY, apart, line,
    norm, off_line, place, six, standby, velocity,
};
use crate::bench::Bench;

const MS: u64 = 1_000_000;
const DYNAMICS: [(&str, f64); 4] = [("Velocity", 0.5), ("Acceleration", 2.0), ("Deceleration", 2.0), ("Jerk", 40.0)];

/// Two lines with a corner at [1, 0, 0], the second with this transition; places and speeds of all scans.
fn corner(goal: [f64; 3], mode: f64, transition: f64, parameter: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
    let mut bench = standby(3);
    bench.step_ns = MS;
    six(&mut bench, "Linear2.TransitionParameter", &[parameter]);
    line(&mut bench, "Linear", &[1.0, 0.0, 0.0], &DYNAMICS);
    bench.scan();
    let blended = [&DYNAMICS[..], &[("BufferMode", mode), ("TransitionMode", transition)]].concat();
    line(&mut bench, "Linear2", &goal, &blended);
    run(&mut bench, "Linear2.Done")
}

fn run(bench: &mut Bench, output: &str) -> (Vec<[f64; 3]>, Vec<f64>) {
    let (mut places, mut speeds) = (Vec::new(), Vec::new());
    for _ in 0..30_000 {
        bench.scan();
        places.push(place(bench));
        speeds.push(norm(velocity(bench)));
        if bench.get(output) {
            return (places, speeds);
        }
    }
    panic!("{output} stays FALSE");
}

const CORNER: [f64; 3] = [1.0, 0.0, 0.0];

/// The distance at which the path leaves the first line, and the least distance from the corner.
fn shape(places: &[[f64; 3]]) -> (f64, f64) {
    let left = places.iter().find(|at| off_line(**at, [0.0; 3], CORNER) > 1e-9).expect("a corner");
    let nearest = places.iter().map(|at| apart(*at, CORNER)).fold(f64::MAX, f64::min);
    (apart(*left, CORNER), nearest)
}

#[test]
fn a_curve_begins_and_ends_at_the_distance_given_and_keeps_its_shape() {
    for goal in [[1.0, 1.0, 0.0], [1.7, 0.7, 0.3], [0.4, 0.5, 0.0]] {
        let (places, _) = corner(goal, BLENDING_PREVIOUS, CORNER_DISTANCE, 0.2);
        let (left, nearest) = shape(&places);
        // It begins at 0.2 m; a step is 0.5 mm, and it leaves the line slowly.
        assert!((0.18..0.2).contains(&left), "{left}");
        let back = places.iter().rev().find(|at| off_line(**at, CORNER, goal) > 1e-9).expect("a corner");
        assert!((0.18..0.2).contains(&apart(*back, CORNER)), "{back:?}");
        let way = [goal[0] - 1.0, goal[1], goal[2]];
        let second = way.map(|each| each / norm(way));
        let expected = 3.0 / 16.0 * 0.2 * apart(second, [1.0, 0.0, 0.0]);
        assert!((nearest - expected).abs() < 1e-5, "{nearest}, not {expected}");
        // Outside of the curve it is on the lines.
        let far = places.iter().filter(|at| apart(**at, CORNER) > 0.2 + 1e-9);
        assert!(far.clone().count() > 100);
        for at in far {
            assert!(off_line(*at, [0.0; 3], CORNER).min(off_line(*at, CORNER, goal)) < 1e-12, "{at:?}");
        }
    }
}

#[test]
fn the_deviation_from_the_corner_is_the_one_given() {
    for deviation in [0.002, 0.02, 0.05] {
        let (places, _) = corner([1.5, 0.8, 0.1], BLENDING_LOW, CORNER_DEVIATION, deviation);
        let (_, nearest) = shape(&places);
        assert!(nearest <= deviation + 1e-5 && nearest > deviation - 2e-5, "{nearest} m, not {deviation}");
    }
}

#[test]
fn the_velocity_along_the_path_is_constant_through_a_curve() {
    let (places, speeds) = corner([1.0, 1.0, 0.0], BLENDING_PREVIOUS, CORNER_DISTANCE, 0.2);
    let inside = places.iter().zip(&speeds).filter(|(at, _)| apart(**at, CORNER) < 0.2 - 1e-3);
    assert!(inside.clone().count() > 300, "{}", inside.count());
    for (at, speed) in inside {
        assert!((speed - 0.5).abs() < 1e-6, "{speed} m/s at {at:?}");
    }
    // Ways of steps say the same as velocities.
    for pair in places.windows(2).filter(|pair| apart(pair[0], CORNER) < 0.19 && apart(pair[1], CORNER) < 0.19) {
        assert!((apart(pair[0], pair[1]) * 1e3 - 0.5).abs() < 1e-4);
    }
}

#[test]
fn buffer_modes_choose_the_velocity_of_a_curve() {
    for (mode, expected) in [(2.0, 0.3), (3.0, 0.3), (4.0, 0.6), (5.0, 0.6)] {
        let mut bench = standby(3);
        bench.step_ns = MS;
        six(&mut bench, "Linear2.TransitionParameter", &[0.3]);
        line(&mut bench, "Linear", &CORNER, &[("Velocity", 0.3), ("Acceleration", 4.0)]);
        bench.scan();
        let second =
            [("Velocity", 0.6), ("Acceleration", 4.0), ("BufferMode", mode), ("TransitionMode", CORNER_DISTANCE)];
        line(&mut bench, "Linear2", &[1.0, 1.5, 0.0], &second);
        let (places, speeds) = run(&mut bench, "Linear2.Done");
        let middle = (0..places.len()).min_by(|a, b| apart(places[*a], CORNER).total_cmp(&apart(places[*b], CORNER)));
        let speed = speeds[middle.expect("some")];
        assert!((speed - expected).abs() < 1e-6, "mode {mode}: {speed} m/s");
    }
}

#[test]
fn velocities_of_a_transition_make_its_size() {
    // The bend in the middle of a right angle is 3 sqrt(2) / (2 d).
    let (places, speeds) = corner([1.0, 1.0, 0.0], BLENDING_PREVIOUS, CONSTANT_VELOCITY, 0.25);
    let d = 3.0 * 2.0_f64.sqrt() / 2.0 * 0.25 * 0.25 / 2.0;
    let (left, nearest) = shape(&places);
    assert!((left - d).abs() < 0.01 && (nearest - 3.0 / 16.0 * d * 2.0_f64.sqrt()).abs() < 1e-4, "{left} {nearest}");
    let slowest = places.iter().zip(&speeds).filter(|(at, _)| apart(**at, CORNER) < d * 0.9).map(|(_, speed)| *speed);
    assert!(slowest.clone().all(|speed| (speed - 0.25).abs() < 1e-6), "{:?}", slowest.collect::<Vec<_>>());
    // From 0.25 m/s to rest with 2 m/s2 and 40 m/s3: 0.125 s and 0.05 s more, half as fast on the mean.
    let (places, _) = corner([1.0, 1.0, 0.0], BLENDING_PREVIOUS, START_VELOCITY, 0.25);
    let (left, _) = shape(&places);
    let d = 0.125 * (0.125 + 0.05);
    assert!((left - d).abs() < 0.002, "{left}, not {d}");
}

/// Without a curve only what goes straight on is passed with velocity.
#[test]
fn without_a_transition_a_corner_is_reached_exactly_and_a_tangent_is_not_stopped_at() {
    let (places, speeds) = corner([1.0, 1.0, 0.0], BLENDING_PREVIOUS, 0.0, 0.0);
    let (_, nearest) = shape(&places);
    assert!(nearest < 1e-5, "{nearest}");
    assert!(speeds[10..speeds.len() - 10].iter().any(|speed| *speed < 0.02), "it stops");
    let (places, speeds) = corner([1.8, 0.0, 0.0], BLENDING_PREVIOUS, 0.0, 0.0);
    let around = places.iter().zip(&speeds).filter(|(at, _)| apart(**at, CORNER) < 0.3);
    assert!(around.clone().all(|(_, speed)| (speed - 0.5).abs() < 1e-9), "{:?}", around.collect::<Vec<_>>());
}

/// A line, its tangent arc, and a line again.
#[test]
fn arcs_are_joined_with_lines_by_tangents_and_by_curves() {
    for (transition, parameter) in [(0.0, 0.0), (CORNER_DISTANCE, 0.1)] {
        let mut bench = standby(3);
        bench.step_ns = MS;
        line(&mut bench, "Linear", &CORNER, &DYNAMICS);
        bench.scan();
        six(&mut bench, "Circular.AuxPoint", &[1.5, 0.5]);
        six(&mut bench, "Circular.EndPoint", &[1.0, 1.0]);
        bench.start("Circular", &[&DYNAMICS[..], &[("BufferMode", BLENDING_PREVIOUS)]].concat());
        bench.scan();
        six(&mut bench, "Linear2.TransitionParameter", &[parameter]);
        let goal = if transition == 0.0 { [0.2, 1.0, 0.0] } else { [1.0, 0.2, 0.4] };
        let last = [&DYNAMICS[..], &[("BufferMode", BLENDING_PREVIOUS), ("TransitionMode", transition)]].concat();
        line(&mut bench, "Linear2", &goal, &last);
        let (places, speeds) = run(&mut bench, "Linear2.Done");
        let round = places.iter().filter(|at| at[0] > 1.0 + 1e-9 && apart(**at, [1.0, 1.0, 0.0]) > 0.1);
        for at in round {
            assert!(((at[0] - 1.0).hypot(at[1] - 0.5) - 0.5).abs() < 1e-9, "{at:?}");
        }
        let cruising = speeds.iter().filter(|speed| (**speed - 0.5).abs() < 1e-6).count();
        let slow = speeds[400..speeds.len() - 400].iter().fold(1.0, |least: f64, speed| least.min(*speed));
        assert!(cruising > 3000 && slow > 0.5 - 1e-6, "{cruising} scans, down to {slow} m/s");
        assert!(apart(place(&bench), goal) < 1e-12);
    }
}

/// A move that is given too late to slow down for its curve, or for its end, is not blended: the axes keep to their limits.
#[test]
fn a_move_that_comes_too_late_is_not_blended() {
    for scans in 30..48 {
        let mut bench = standby(3);
        let dynamics = |velocity, acceleration| {
            [("Velocity", velocity), ("Acceleration", acceleration), ("Deceleration", acceleration)]
        };
        line(&mut bench, "Linear", &[0.66, 0.0, 0.74], &dynamics(2.3, 8.8));
        bench.scans(scans);
        six(&mut bench, "Linear2.TransitionParameter", &[0.18]);
        let blended = [("BufferMode", BLENDING_LOW), ("TransitionMode", CORNER_DISTANCE)];
        line(&mut bench, "Linear2", &[0.91, 0.0, 0.94], &[&dynamics(0.1, 0.5)[..], &blended].concat());
        let mut last = velocity(&bench);
        while !bench.get("Linear2.Done") {
            bench.scan();
            let now = velocity(&bench);
            let change = apart(now, last);
            assert!(change < 0.1, "{change} m/s in a scan after {scans}");
            last = now;
        }
    }
}
