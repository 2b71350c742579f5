use super::*;
use crate::component::tests::Rig;

/// A position command of the linear feeder, `[Nyyssönen]` Fig. 22.
const FEEDER: Inputs = Inputs {
    execute: true,
    tracking: false,
    torque_control: false,
    speed_control: false,
    enable: true,
    target_position: 6300.0,
    target_speed: 8000.0,
    target_acceleration: 15_000.0,
    target_deceleration: 15_000.0,
    target_torque: 0.0,
    tracked: 0.0,
    tracked_speed: 0.0,
    obstacle: -1e9,
};
const REST: Inputs = Inputs { execute: false, ..FEEDER };

fn rig(p: Parameters) -> Rig<CommandAxis> {
    Rig::new(CommandAxis::new(p))
}

fn feeder() -> Rig<CommandAxis> {
    rig(Parameters { upper_units: 14_000.0, ..Parameters::default() })
}

#[test]
fn a_position_move_takes_its_closed_form_to_a_step() {
    for (target, exact_s, peak) in
        [(6300.0, 1.320_833, 8000.0), (13_950.0, 2.277_083, 8000.0), (2000.0, 0.730_297, 5477.226)]
    {
        let mut rig = feeder();
        let command = Inputs { target_position: target, ..FEEDER };
        let (mut steps, mut fastest, mut area) = (0_u32, 0.0_f64, 0.0);
        let mut before = Setpoint::default();
        loop {
            let out = rig.run(command, 0.01, 1);
            steps += 1;
            fastest = fastest.max(out.speed);
            area += out.position - before.position;
            before = Setpoint { position: out.position, velocity: out.speed };
            if out.in_position {
                break;
            }
            assert!(steps < 1000, "{out:?}");
        }
        assert!((f64::from(steps) * 0.01 - exact_s).abs() <= 0.01, "{target}: {steps}");
        // a triangle's peak lies between two steps
        assert!(fastest <= peak && fastest >= peak - 150.0, "{fastest}");
        assert!((area - target).abs() < 1e-9 && before.velocity == 0.0, "{area}");
        assert!(peak < 8000.0 || fastest == 8000.0);
    }
}

#[test]
fn only_an_edge_is_a_command_and_a_new_one_takes_its_place() {
    let mut rig = feeder();
    rig.run(FEEDER, 0.01, 200);
    // another target without an edge
    assert_eq!(rig.run(Inputs { target_position: 100.0, ..FEEDER }, 0.01, 200).position, 6300.0);
    rig.run(REST, 0.01, 1);
    let moving = rig.run(Inputs { target_position: 100.0, ..FEEDER }, 0.01, 50);
    assert!(!moving.in_position && (moving.speed + 7500.0).abs() < 1e-9);
    rig.run(REST, 0.01, 1);
    // back again, in motion: it brakes and turns
    let out = rig.run(FEEDER, 0.01, 300);
    assert!(out.in_position && out.position == 6300.0, "{out:?}");
    assert!(!rig.run(Inputs { enable: false, ..REST }, 0.01, 1).enabled);
    rig.run(Inputs { enable: false, ..FEEDER }, 0.01, 10);
    assert_eq!(
        rig.run(Inputs { target_position: 0.0, ..FEEDER }, 0.01, 300).position,
        6300.0,
        "an edge without enable"
    );
}

#[test]
fn a_joystick_runs_the_axis_until_it_is_let_go_or_at_its_end() {
    let joystick = Inputs { speed_control: true, target_position: 20_000.0, ..FEEDER };
    let mut rig = feeder();
    assert_eq!(rig.run(joystick, 0.01, 100).speed, 8000.0);
    let out = rig.run(Inputs { speed_control: false, ..joystick }, 0.01, 100);
    // 5866.67 units in a second, and 2133.33 until it stands; ramps that end within a step cost 0.2 units
    assert!(out.speed == 0.0 && (out.position - 8000.0).abs() < 0.5, "{out:?}");
    rig.run(Inputs { execute: false, ..joystick }, 0.01, 1);
    let out = rig.run(joystick, 0.01, 300);
    assert!(out.speed == 0.0 && out.position == 14_000.0, "{out:?}");
}

#[test]
fn torque_closes_on_a_block_holds_it_and_opens() {
    let p = Parameters { upper_units: 30_000.0, initial_units: 30_000.0, ..Parameters::default() };
    let close = Inputs { tracking: true, target_torque: 100.0, obstacle: 10_000.0, ..FEEDER };
    let mut axis = rig(p.clone());
    let out = axis.run(close, 0.01, 80);
    assert!(out.in_position && out.position == 10_000.0 && out.pressing_pct == 100.0, "{out:?}");
    // less pressure after the stroke, without a new edge
    assert_eq!(axis.run(Inputs { target_torque: 40.0, ..close }, 0.01, 1).pressing_pct, 40.0);
    let lost = axis.run(Inputs { tracking: false, ..close }, 0.01, 1);
    assert!(lost.pressing_pct == 0.0 && !lost.in_position, "neither bit: {lost:?}");
    axis.run(Inputs { execute: false, ..close }, 0.01, 1);
    let open = Inputs { tracking: false, torque_control: true, ..close };
    let out = axis.run(open, 0.01, 80);
    assert!(out.in_position && out.position == 30_000.0, "{out:?}");
    let empty = rig(p).run(Inputs { obstacle: -1e9, ..close }, 0.01, 200);
    assert!(empty.in_position && empty.position == 0.0, "nothing to close on: {empty:?}");
}

#[test]
fn it_tracks_a_turn_an_offset_a_rate_and_a_curve() {
    let tracking = Inputs { tracking: true, target_speed: 1e6, ..FEEDER };
    // 5 turns a second of 100 units, 150 units a turn
    let knife = Parameters {
        track: Track::PerTurn,
        initial_units: 30_000.0,
        turn_modulo_units: 6000.0,
        ..Parameters::default()
    };
    let mut rig_ = rig(knife);
    let mut at = 5900.0;
    for _ in 0..200 {
        let inputs =
            Inputs { tracked: at, tracked_speed: 500.0, target_torque: 150.0, target_position: 0.0, ..tracking };
        rig_.run(inputs, 0.01, 1);
        at = (at + 5.0) % 6000.0;
    }
    // a hundred additions of some thousands
    assert!((rig_.state.actual.position - 28_500.0).abs() < 1e-8, "{:?}", rig_.state.actual);
    let one = |track: Track, inputs: Inputs| {
        let curve = Parameters { curve_at_from_units: 100.0, curve_at_to_units: 750.0, track, ..Parameters::default() };
        rig(curve).run(inputs, 0.01, 100)
    };
    let near = Inputs { tracked: 9000.0, tracked_speed: 100.0, target_position: 40.0, ..tracking };
    assert_eq!(one(Track::Offset, near).position, 9041.0);
    assert!((one(Track::Curve, near).position - (100.0 + 9001.0 * 0.01 + 40.0)).abs() < 1e-9);
    let rate = Inputs { tracked_speed: 700.0, ..tracking };
    assert_eq!(one(Track::Rate, rate).speed, 700.0);
}

#[test]
fn a_valve_follows_with_an_error_that_is_stated_and_ends_in_position() {
    let p = Parameters { drive: Drive::Valve, full_units_s: 12_000.0, knee_units_s: 2000.0, ..Parameters::default() };
    let mut rig = rig(p);
    let mut worst = 0.0_f64;
    let mut volt = 0.0_f64;
    for _ in 0..135 {
        let out = rig.run(FEEDER, 0.01, 1);
        worst = worst.max((rig.state.set.position - out.position).abs());
        volt = volt.max(out.valve_v.abs());
    }
    let out = rig.run(FEEDER, 0.01, 65);
    // the lag of spool and oil at 8000 units/s: below 150 units while it moves
    assert!(out.in_position && worst > 10.0 && worst < 150.0, "{worst} {out:?}");
    assert!((out.position - 6300.0).abs() < 2.0 && volt > 6.0 && volt <= 10.0, "{volt} {out:?}");
}

#[test]
fn each_failure_has_its_effect() {
    let run = |mode: Failure, drive: Drive| {
        let p = Parameters { drive, full_units_s: 12_000.0, knee_units_s: 2000.0, ..Parameters::default() };
        rig(p).failing(mode).run(FEEDER, 0.01, 200)
    };
    for drive in [Drive::Ideal, Drive::Valve] {
        assert!(!run(Failure::Dead, drive).enabled && run(Failure::Dead, drive).position == 0.0);
        assert!(run(Failure::Jammed, drive).enabled && run(Failure::Jammed, drive).position == 0.0);
        assert_eq!(run(Failure::NoPressure, drive).position, 0.0);
        assert!(!run(Failure::HoseBurst, drive).in_position);
        let drifted = run(Failure::Drifting, drive);
        assert!((drifted.actual_position - drifted.position - 40.0).abs() < 1e-9);
        assert_eq!(run(Failure::FrozenFeedback, drive).actual_position, 0.0);
    }
    let worn = run(Failure::WornValve, Drive::Valve);
    let new =
        rig(Parameters { drive: Drive::Valve, full_units_s: 12_000.0, knee_units_s: 2000.0, ..Parameters::default() })
            .run(FEEDER, 0.01, 200);
    assert!((worn.position - 6300.0).abs() > (new.position - 6300.0).abs());
}
