//! The axis against the closed forms of its loops.

use super::*;
use crate::component::tests::Rig;

const ON: Inputs = Inputs {
    enable: true,
    execute: false,
    target_m: 0.0,
    speed_m_s: 0.0,
    home: false,
    jog_forward: false,
    jog_reverse: false,
    halt: false,
    reset: false,
};

fn go(target_m: f64) -> Inputs {
    Inputs { execute: true, target_m, ..ON }
}

fn free() -> Parameters {
    Parameters { friction_n: 0.0, needs_homing: false, initial_m: 0.0, ..Parameters::default() }
}

/// An axis that is switched on.
fn rig(p: Parameters) -> Rig<ServoAxis> {
    let mut rig = Rig::new(ServoAxis::new(p));
    rig.run(ON, 0.01, 2);
    rig
}

#[test]
fn the_following_error_is_speed_over_gain() {
    for jerk_m_s3 in [0.0, 20.0] {
        let mut rig = rig(Parameters { jerk_m_s3, ..free() });
        let out = rig.run(go(0.9), 0.001, 1000);
        // 0.5 m/s by 50 1/s; the loops have settled to rounding of positions near 1
        assert!((out.following_m - 0.01).abs() < 1e-9 && out.busy, "{out:?}");
        assert!((out.velocity_m_s - 0.5).abs() < 1e-9);
    }
    let mut fed = rig(Parameters { feed_forward_ratio: 1.0, ..free() });
    assert!(fed.run(go(0.9), 0.001, 1000).following_m.abs() < 1e-9, "nothing is left to the loop");
}

#[test]
fn a_move_ends_in_its_time_at_its_target() {
    let mut rig = rig(free());
    // 0.8/0.5 + 0.5/2 + 2/20 = 1.95 s of set motion
    assert!(rig.run(go(0.8), 0.01, 194).busy);
    assert!(!rig.run(go(0.8), 0.01, 2).busy);
    let out = rig.run(go(0.8), 0.01, 30);
    assert!(out.in_position && (out.position_m - 0.8).abs() < 1e-6, "{out:?}");
}

#[test]
fn halving_the_step_halves_the_error() {
    let reached = |longest_s: f64| {
        let mut rig = Rig::new(ServoAxis::new(free()));
        rig.component.longest_s = longest_s;
        rig.run(ON, 0.01, 2);
        rig.run(go(0.9), 0.01, 20).position_m
    };
    let finest = reached(1e-6);
    let errors: Vec<_> = [0.4e-3, 0.2e-3, 0.1e-3].iter().map(|h| (reached(*h) - finest).abs()).collect();
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.3, "{errors:?}");
    }
}

#[test]
fn homing_finds_the_switch_and_makes_it_zero() {
    let p = Parameters { reference_m: 0.02, initial_m: 0.3, ..Parameters::default() };
    let mut rig = rig(p);
    assert!(rig.run(go(0.1), 0.01, 2).error, "no target before homing");
    rig.run(Inputs { reset: true, ..ON }, 0.01, 3);
    let out = rig.run(Inputs { home: true, ..ON }, 0.01, 800);
    assert!(out.homed && !out.busy && !out.error, "{out:?}");
    let out = rig.run(go(0.25), 0.01, 300);
    assert!(out.in_position && (rig.state.axis.position - 0.27).abs() < 1e-4, "{out:?} {:?}", rig.state.axis);
}

#[test]
fn jogging_and_halting() {
    let mut rig = rig(free());
    let jog = Inputs { jog_forward: true, speed_m_s: 0.1, ..ON };
    assert!((rig.run(jog, 0.01, 100).velocity_m_s - 0.1).abs() < 1e-6);
    let out = rig.run(ON, 0.01, 100);
    assert!(!out.busy && out.velocity_m_s.abs() < 1e-9);
    rig.run(go(0.9), 0.01, 40);
    let out = rig.run(Inputs { halt: true, ..go(0.9) }, 0.01, 100);
    assert!(!out.busy && !out.in_position && out.velocity_m_s.abs() < 1e-9, "{out:?}");
}

#[test]
fn a_load_beyond_the_force_is_a_following_error() {
    let mut rig = rig(Parameters { force_max_n: 30.0, acceleration_m_s2: 10.0, ..free() });
    assert!(rig.run(go(0.9), 0.01, 100).error);
}

#[test]
fn targets_beyond_the_ends_are_refused() {
    assert!(rig(free()).run(go(1.5), 0.01, 2).error);
}

#[test]
fn each_failure_has_its_effect() {
    let after = |mode: Failure| rig(free()).failing(mode).run(go(0.5), 0.01, 100);
    assert!(after(Failure::DriveFault).error);
    assert!(after(Failure::Blocked).error, "it does not follow");
    assert!(after(Failure::EncoderFrozen).error, "it seems not to follow");
    let mut blind = rig(Parameters { initial_m: 0.1, ..free() }).failing(Failure::ReferenceDead);
    let out = blind.run(Inputs { home: true, ..ON }, 0.01, 1000);
    assert!(out.error && !out.homed, "it runs into the stop: {out:?}");
}
