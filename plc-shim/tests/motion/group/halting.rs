//! To rest on the path, and on again; what an override does.

use super::bench::{
    BLENDING_LOW, BLENDING_PREVIOUS, BUFFERED, CORNER_DISTANCE, GroupState, START_VELOCITY, apart, application,
    axis_state, line, norm, off_line, place, six, standby, state, trace, velocity,
};
use crate::bench::{Bench, State};

const MS: u64 = 1_000_000;
const DYNAMICS: [(&str, f64); 4] = [("Velocity", 0.5), ("Acceleration", 2.0), ("Deceleration", 2.0), ("Jerk", 20.0)];

/// A line, a curve, an arc, a corner without a curve, a line.
fn begin(bench: &mut Bench) {
    line(bench, "Linear", &[0.6, 0.0, 0.0], &DYNAMICS);
    bench.scan();
    six(bench, "Linear2.TransitionParameter", &[0.2]);
    let blended = [&DYNAMICS[..], &[("BufferMode", BLENDING_PREVIOUS), ("TransitionMode", CORNER_DISTANCE)]].concat();
    line(bench, "Linear2", &[0.6, 0.6, 0.0], &blended);
    bench.scan();
    six(bench, "Circular.AuxPoint", &[0.3, 0.9, 0.0]);
    six(bench, "Circular.EndPoint", &[0.0, 0.6, 0.0]);
    bench.start("Circular", &[&DYNAMICS[..], &[("BufferMode", BLENDING_PREVIOUS)]].concat());
    bench.scan();
    line(bench, "Linear3", &[0.0, 0.6, 0.5], &[&DYNAMICS[..], &[("BufferMode", BUFFERED)]].concat());
    bench.scan();
}

/// The whole path, close together.
fn path() -> &'static [[f64; 3]] {
    static PATH: std::sync::OnceLock<Vec<[f64; 3]>> = std::sync::OnceLock::new();
    PATH.get_or_init(|| {
        let mut bench = standby(3);
        bench.step_ns = MS;
        begin(&mut bench);
        let mut places = vec![[0.0; 3]];
        places.extend(trace(&mut bench, "Linear3.Done"));
        places
    })
}

fn off_path(at: [f64; 3]) -> f64 {
    path().windows(2).map(|pair| off_line(at, pair[0], pair[1])).fold(f64::MAX, f64::min)
}

/// Moments that lie on a line, in a curve, on the arc, before the corner, behind it.
const MOMENTS: [usize; 8] = [30, 100, 130, 160, 300, 420, 452, 520];

#[test]
fn stops_halts_and_interruptions_stay_on_the_path() {
    for block in ["Stop", "Halt", "Interrupt"] {
        for moment in MOMENTS {
            for (deceleration, jerk) in [(5.0, 0.0), (1.0, 10.0), (0.1, 0.0)] {
                let mut bench = standby(3);
                begin(&mut bench);
                bench.scans(moment);
                if bench.get("Linear3.Done") {
                    continue;
                }
                bench.start(block, &[("Deceleration", deceleration), ("Jerk", jerk)]);
                let mut speed = f64::MAX;
                while !bench.get(&format!("{block}.Done")) {
                    assert!(off_path(place(&bench)) < 1e-6, "{block} at {moment}: {:?}", place(&bench));
                    bench.scan();
                    speed = norm(velocity(&bench));
                }
                assert!(speed < 1e-9 && off_path(place(&bench)) < 1e-6);
                let stopped = place(&bench);
                bench.scans(5);
                assert_eq!(place(&bench), stopped);
                if block == "Interrupt" {
                    assert!(!bench.get("Linear3.CommandAborted") && bench.get("Linear3.Busy"), "{moment}");
                } else {
                    assert!(bench.get("Linear3.CommandAborted"), "{block} at {moment}");
                }
            }
        }
    }
}

/// From velocity v with deceleration d it takes v / d, and v v / 2 d of the path.
#[test]
fn a_stop_takes_the_deceleration_given() {
    let mut bench = standby(3);
    bench.step_ns = MS;
    line(&mut bench, "Linear", &[1.5, 2.0, 0.0], &[("Velocity", 0.5), ("Acceleration", 5.0), ("Deceleration", 5.0)]);
    bench.scans(1000);
    let (at, begin) = (place(&bench), bench.now_s());
    bench.start("Stop", &[("Deceleration", 1.0)]);
    trace(&mut bench, "Stop.Done");
    // The scan in which it is pressed goes on as planned.
    assert!((bench.now_s() - begin - 0.501).abs() < 1.5e-3);
    assert!((apart(place(&bench), at) - 0.125 - 0.5e-3).abs() < 1e-9, "{}", apart(place(&bench), at));
}

/// A stop may be harder than the move that it stops, as hard as the axes allow.
#[test]
fn a_stop_may_be_harder_than_the_move() {
    for (deceleration, expected) in [(8.0, 8.0), (0.0, 25.0), (100.0, 25.0)] {
        let mut bench = standby(3);
        bench.step_ns = MS;
        line(
            &mut bench,
            "Linear",
            &[1.5, 2.0, 0.0],
            &[("Velocity", 0.5), ("Acceleration", 1.0), ("Deceleration", 0.2)],
        );
        bench.scans(1000);
        let at = place(&bench);
        bench.start("Stop", &[("Deceleration", deceleration)]);
        trace(&mut bench, "Stop.Done");
        // 20 m/s2 of the axis that goes 0.8 of the way are 25 m/s2.
        let way = 0.5e-3 + 0.25 / (2.0 * expected);
        assert!((apart(place(&bench), at) - way).abs() < 1e-9, "{}, not {way}", apart(place(&bench), at));
    }
}

/// A slow curve behind the place where the axes can rest does not make a halt softer, nor does the group go on to it.
#[test]
fn a_curve_that_is_not_reached_does_not_soften_a_halt() {
    let mut bench = standby(3);
    let fast = [("Velocity", 2.0), ("Acceleration", 20.0), ("Deceleration", 20.0)];
    line(&mut bench, "Linear", &[0.0, 1.7, 0.0], &fast);
    bench.scan();
    six(&mut bench, "Linear2.TransitionParameter", &[0.01]);
    let slow = [("Velocity", 0.1), ("Acceleration", 0.5), ("Deceleration", 0.5)];
    let blended = [("BufferMode", BLENDING_LOW), ("TransitionMode", START_VELOCITY)];
    line(&mut bench, "Linear2", &[0.0, 0.0, -0.7], &[&slow[..], &blended].concat());
    while place(&bench)[1] < 1.5 {
        bench.scan();
    }
    let (at, begin) = (place(&bench), bench.now_s());
    // 2 m to rest would be beyond the curve; the axes can do it in 0.1 m, in 0.1 s.
    bench.start("Halt", &[("Deceleration", 1.0)]);
    trace(&mut bench, "Halt.Done");
    assert!((apart(place(&bench), at) - 0.12).abs() < 1e-6, "{:?} from {at:?}", place(&bench));
    assert!(bench.now_s() - begin < 0.125, "{} s", bench.now_s() - begin);
}

#[test]
fn what_was_interrupted_goes_on_to_the_same_end() {
    for moment in MOMENTS {
        let mut bench = standby(3);
        begin(&mut bench);
        bench.scans(moment);
        bench.start("Interrupt", &[("Deceleration", 3.0)]);
        trace(&mut bench, "Interrupt.Done");
        bench.set("Interrupt.Execute", false);
        bench.scans(3);
        assert_eq!((state(&bench), axis_state(&bench, 1)), (GroupState::Standby, State::Standstill));
        assert!(!bench.get("Status.InPosition"));
        bench.set("GoOn.Execute", true);
        bench.scan();
        assert!(bench.get("GoOn.Done") && state(&bench) == GroupState::Moving, "{moment}");
        for at in trace(&mut bench, "Linear3.Done") {
            assert!(off_path(at) < 1e-6, "{moment}: {at:?}");
        }
        assert_eq!(place(&bench), [0.0, 0.6, 0.5]);
    }
}

#[test]
fn nothing_goes_on_from_another_place() {
    let mut bench = standby(3);
    begin(&mut bench);
    bench.scans(100);
    bench.start("Interrupt", &[]);
    trace(&mut bench, "Interrupt.Done");
    bench.start("Single", &[("Position", 0.3), ("Velocity", 0.5)]);
    trace(&mut bench, "Single.Done");
    bench.set("GoOn.Execute", true);
    bench.scan();
    assert_eq!((bench.get("GoOn.Error"), bench.int("GoOn.ErrorID")), (true, 0x2c));
}

/// An aborting move begins where the group has come to rest on the path that it was on.
#[test]
fn an_aborting_move_begins_at_rest_on_the_path() {
    for moment in MOMENTS {
        let mut bench = standby(3);
        begin(&mut bench);
        bench.scans(moment);
        if bench.get("Linear3.Done") {
            continue;
        }
        line(&mut bench, "Relative", &[0.0, 0.0, -0.3], &DYNAMICS);
        let mut rest = None;
        while !bench.get("Relative.Done") {
            bench.scan();
            if bench.get("Relative.Active") {
                rest.get_or_insert_with(|| place(&bench));
            } else if rest.is_none() {
                assert!(off_path(place(&bench)) < 1e-6, "{moment}");
            }
        }
        let rest = rest.expect("it moves");
        let end = place(&bench);
        assert!((end[0] - rest[0]).abs() < 1e-9 && (end[1] - rest[1]).abs() < 1e-9, "{moment}: {rest:?}, {end:?}");
        assert!(off_path([end[0], end[1], end[2] + 0.3]) < 1e-6);
        assert!(bench.get("Linear3.CommandAborted"));
    }
}

#[test]
fn an_override_slows_down_holds_and_lets_go_on_the_path() {
    let mut bench = standby(3);
    bench.set("Override.Enable", true);
    begin(&mut bench);
    bench.scans(60);
    for (factor, scans) in [(0.5, 60), (0.0, 60), (0.2, 100), (1.0, 60), (0.1, 40), (0.0, 50), (1.0, 0)] {
        bench.set_real("Override.VelFactor", factor);
        for scan in 0..scans {
            bench.scan();
            assert!(off_path(place(&bench)) < 1e-6);
            if scan > 50 {
                assert!((norm(velocity(&bench)) - 0.5 * factor).abs() < 1e-6, "{factor}: {:?}", velocity(&bench));
            }
        }
    }
    for at in trace(&mut bench, "Linear3.Done") {
        assert!(off_path(at) < 1e-6);
    }
    bench.set_real("Override.VelFactor", 1.5);
    bench.scan();
    assert_eq!((bench.get("Override.Error"), bench.int("Override.ErrorID")), (true, 0x2d));
}

/// A PLC that is saved in the middle of a move and restored goes on to the bit.
#[test]
fn a_state_is_saved_and_restored_in_the_middle_of_a_curve() {
    let mut bench = standby(3);
    begin(&mut bench);
    bench.scans(120);
    let mut other = bench.resumed(application());
    for _ in 0..600 {
        bench.scan();
        other.scan();
        assert!(bench.memory() == other.memory());
    }
    assert!(bench.get("Linear3.Done"));
}
