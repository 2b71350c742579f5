//! The state diagram of a group and what its axes show of it; errors.

use super::bench::{
    BLENDING_LOW, BUFFERED, CORNER_DISTANCE, GroupState, apart, axis_state, disabled, line, norm, place, six, standby,
    state, trace, velocity,
};
use crate::bench::{Bench, State};

/// The group in a state; the line that moves it there is long.
fn in_state(wanted: GroupState) -> Bench {
    let mut bench = if wanted == GroupState::Disabled { disabled(3) } else { standby(3) };
    match wanted {
        GroupState::Disabled | GroupState::Standby => {}
        GroupState::Moving => line(&mut bench, "Linear3", &[9.0, 0.0, 0.0], &[("Velocity", 0.5)]),
        GroupState::Homing => {
            bench.set_real("A[1].HomingVelocity", 0.2);
            bench.set("Home.Execute", true);
        }
        GroupState::Stopping => {
            line(&mut bench, "Linear3", &[9.0, 0.0, 0.0], &[("Velocity", 0.5)]);
            bench.scans(20);
            bench.start("Stop", &[("Deceleration", 0.5)]);
        }
        GroupState::ErrorStop => {
            line(&mut bench, "Linear3", &[9.0, 0.0, 0.0], &[("Velocity", 0.5)]);
            bench.scans(20);
            bench.set("Power[2].Enable", false);
            bench.scan();
        }
    }
    bench.scans(20);
    assert_eq!(state(&bench), wanted);
    bench
}

/// What a command leads to, or its `ErrorID`.
fn after(from: GroupState, block: &str) -> Result<GroupState, i64> {
    let mut bench = in_state(from);
    if block == "GoOn" && from == GroupState::Standby {
        line(&mut bench, "Linear3", &[9.0, 0.0, 0.0], &[("Velocity", 0.5)]);
        bench.scans(5);
        bench.start("Interrupt", &[]);
        trace(&mut bench, "Interrupt.Done");
    }
    if bench.get(&format!("{block}.Execute")) {
        bench.set(&format!("{block}.Execute"), false);
        bench.scan();
    }
    match block {
        "Linear" | "Direct" => {
            line(&mut bench, block, &[1.0, 1.0, 1.0], if block == "Linear" { &[("Velocity", 1.0)] } else { &[] });
        }
        "Circular" => {
            six(&mut bench, "Circular.AuxPoint", &[5.0, 5.0, 2.0]);
            six(&mut bench, "Circular.EndPoint", &[0.0, 5.0, 3.0]);
            bench.start(block, &[("Velocity", 1.0)]);
        }
        "Stop" | "Halt" | "Interrupt" => bench.start(block, &[("Deceleration", 0.4)]),
        _ => bench.set(&format!("{block}.Execute"), true),
    }
    bench.scan();
    if bench.get(&format!("{block}.Error")) {
        return Err(bench.int(&format!("{block}.ErrorID")));
    }
    Ok(state(&bench))
}

/// The state diagram, one row per command.
#[test]
fn commands_lead_from_state_to_state() {
    use GroupState::{Disabled, Homing, Moving, Standby, Stopping};
    let moving = [Err(0x20), Ok(Moving), Ok(Moving), Err(0x23), Err(0x22), Err(0x21)];
    let rows = [
        ("Enable", [Ok(Standby), Err(0x24), Err(0x24), Err(0x24), Err(0x24), Err(0x24)]),
        ("Disable", [Ok(Disabled), Ok(Disabled), Err(0x2e), Err(0x2e), Err(0x2e), Ok(Disabled)]),
        ("Ungroup", [Ok(Disabled), Ok(Disabled), Err(0x2e), Err(0x2e), Err(0x2e), Ok(Disabled)]),
        ("Linear", moving),
        ("Direct", moving),
        ("Circular", moving),
        ("Home", [Err(0x20), Ok(Homing), Err(0x2e), Err(0x23), Err(0x22), Err(0x21)]),
        ("Halt", [Err(0x20), Ok(Standby), Ok(Moving), Err(0x23), Err(0x22), Err(0x21)]),
        ("Interrupt", [Err(0x20), Ok(Standby), Ok(Moving), Err(0x23), Err(0x22), Err(0x21)]),
        ("GoOn", [Err(0x20), Ok(Moving), Err(0x2e), Err(0x23), Err(0x22), Err(0x21)]),
        ("Stop", [Err(0x20), Ok(Stopping), Ok(Stopping), Ok(Stopping), Err(0x22), Err(0x21)]),
    ];
    for (block, expected) in rows {
        let found = GroupState::ALL.map(|from| {
            // A stop that is there already is another block's in the row of MC_GroupStop.
            if block == "Stop" && from == Stopping { Err(0x22) } else { after(from, block) }
        });
        assert_eq!(found, expected, "{block}");
    }
}

#[test]
fn stopping_lasts_as_long_as_execute_is_true() {
    let mut bench = in_state(GroupState::Stopping);
    assert_eq!(axis_state(&bench, 1), State::SynchronizedMotion);
    trace(&mut bench, "Stop.Done");
    bench.scans(5);
    assert_eq!((state(&bench), axis_state(&bench, 1)), (GroupState::Stopping, State::Standstill));
    bench.set("Stop.Execute", false);
    bench.scan();
    assert_eq!(state(&bench), GroupState::Standby);
}

#[test]
fn an_axis_without_power_stops_the_group_on_the_path() {
    let mut bench = standby(3);
    line(&mut bench, "Linear", &[3.0, 1.5, 0.0], &[("Velocity", 1.0), ("Acceleration", 4.0), ("Deceleration", 4.0)]);
    bench.scans(50);
    bench.set("Power[3].Enable", false);
    bench.scans(2);
    assert_eq!(state(&bench), GroupState::ErrorStop);
    assert_eq!((bench.get("Linear.Error"), bench.int("Linear.ErrorID")), (true, 0xa1));
    bench.set("Reset.Execute", true);
    for _ in 0..200 {
        let [x, y, _] = place(&bench);
        assert!((x / 2.0 - y).abs() < 1e-12);
        bench.scan();
    }
    assert!(bench.get("Reset.Done") && state(&bench) == GroupState::Standby);
    assert_eq!([1, 2, 3].map(|k| axis_state(&bench, k)), [State::Standstill, State::Standstill, State::Disabled]);
    // It does not move before all axes have power.
    bench.set("Linear.Execute", false);
    bench.scan();
    bench.set("Linear.Execute", true);
    bench.scan();
    assert_eq!(bench.int("Linear.ErrorID"), 0x26);
}

#[test]
fn a_command_to_an_axis_takes_it_out_of_a_move() {
    let mut bench = in_state(GroupState::Moving);
    bench.start("AxisStop", &[("Deceleration", 2.0)]);
    bench.scans(2);
    assert_eq!((state(&bench), bench.int("G.ErrorID")), (GroupState::ErrorStop, 0xa2));
    assert_eq!(axis_state(&bench, 1), State::Stopping);
    bench.scans(100);
    assert!(norm(velocity(&bench)) < 1e-12);
}

#[test]
fn an_axis_in_a_buffer_waits_for_its_group() {
    let mut bench = standby(3);
    line(&mut bench, "Linear", &[0.5, 0.0, 0.0], &[("Velocity", 0.5)]);
    bench.scan();
    bench.start("Single", &[("Position", 0.3), ("Velocity", 0.5), ("BufferMode", BUFFERED)]);
    trace(&mut bench, "Linear.Done");
    assert_eq!(place(&bench), [0.5, 0.0, 0.0]);
    trace(&mut bench, "Single.Done");
    assert_eq!((place(&bench), state(&bench)), ([0.5, 0.3, 0.0], GroupState::Standby));
}

#[test]
fn homing_takes_all_axes_at_a_time() {
    let mut bench = standby(3);
    bench.set_real("A[1].HomingVelocity", -0.2);
    six(&mut bench, "Home.Position", &[0.7, 0.2, 0.3]);
    bench.set("Home.Execute", true);
    bench.scans(10);
    assert!(bench.get("Home.Active") && state(&bench) == GroupState::Homing);
    assert_eq!(axis_state(&bench, 1), State::Homing);
    bench.set("A[1].HomeSwitch", true);
    trace(&mut bench, "Home.Done");
    let read = [1, 2, 3].map(|k| bench.real(&format!("ReadPosition.Position[{k}]")));
    assert!((read[0] - 0.7).abs() < 0.01 && read[1..] == [0.2, 0.3], "{read:?}");
    assert_eq!(state(&bench), GroupState::Standby);
}

#[test]
fn axes_are_added_and_removed_while_the_group_is_disabled() {
    let mut bench = disabled(2);
    assert!(bench.get("Add[1].Done") && bench.int("G.Axes") == 2);
    bench.set_int("Add[3].IdentInGroup", 1);
    bench.set_int("Remove.IdentInGroup", 2);
    bench.set("Remove.Execute", true);
    bench.scan();
    assert!(bench.get("Remove.Done") && bench.int("G.Axes") == 1);
    bench.set("Remove.Execute", false);
    bench.scan();
    bench.set("Remove.Execute", true);
    bench.scan();
    assert_eq!(bench.int("Remove.ErrorID"), 0x25, "there is none");
    bench.set("Enable.Execute", true);
    bench.set("Add[4].Execute", true);
    bench.scans(2);
    // In the scan in which it becomes Standby it is still added.
    assert_eq!(bench.int("G.Axes"), 4);
    bench.set("Add[5].Execute", true);
    bench.scan();
    assert_eq!((bench.get("Add[5].Error"), bench.int("Add[5].ErrorID")), (true, 0x24));
}

/// A target, inputs beside it, the error.
type Refused<'a> = (&'a [f64], &'a [(&'a str, f64)], i64);

#[test]
fn values_out_of_range_are_refused_and_change_nothing() {
    let mut bench = standby(3);
    bench.set_real("A[1].SWLimitPos", 2.0);
    bench.set("A[1].EnableLimitPos", true);
    let cases: [Refused<'_>; 7] = [
        (&[1.0, 0.0, 0.0], &[("Velocity", 0.0)], 0x10),
        (&[1.0, 0.0, 0.0], &[("Velocity", 1.0), ("Acceleration", -1.0)], 0x11),
        (&[1.0, 0.0, 0.0], &[("Acceleration", 0.0), ("Jerk", -1.0)], 0x11),
        (&[2.1, 0.0, 0.0], &[("Jerk", 0.0)], 0x12),
        (&[1.0, 0.0, 0.0, 0.5], &[], 0x27),
        (&[1.0, 0.0, 0.0], &[("BufferMode", BLENDING_LOW), ("TransitionMode", CORNER_DISTANCE)], 0x2b),
        (&[f64::NAN, 0.0, 0.0], &[("BufferMode", 0.0), ("TransitionMode", 0.0)], 0x29),
    ];
    for (goal, values, expected) in cases {
        bench.set("Linear.Execute", false);
        bench.scan();
        line(&mut bench, "Linear", goal, values);
        bench.scan();
        assert_eq!((bench.get("Linear.Error"), bench.int("Linear.ErrorID")), (true, expected), "{goal:?} {values:?}");
        assert_eq!((state(&bench), bench.int("G.Count")), (GroupState::Standby, 0));
    }
    for (mode, aux, end) in [
        (0.0, [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
        (1.0, [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
        (2.0, [0.0, 0.0, 0.5], [0.0, 1.5, 0.0]),
    ] {
        bench.set("Circular.Execute", false);
        bench.scan();
        six(&mut bench, "Circular.AuxPoint", &aux);
        six(&mut bench, "Circular.EndPoint", &end);
        bench.start("Circular", &[("CircMode", mode), ("Velocity", 1.0)]);
        bench.scan();
        assert_eq!(bench.int("Circular.ErrorID"), 0x28, "{mode}");
    }
}

/// Aborting moves while the group still halts for an earlier one, and an error in the middle of that.
#[test]
fn a_move_that_waits_for_rest_is_replaced_or_fails() {
    let mut bench = in_state(GroupState::Moving);
    bench.scans(50);
    let slow = [("Velocity", 1.0), ("Acceleration", 1.0), ("Deceleration", 1.0)];
    line(&mut bench, "Linear", &[0.0, 1.0, 0.0], &slow);
    bench.scan();
    line(&mut bench, "Linear2", &[0.0, 0.0, 1.0], &slow);
    bench.scans(2);
    assert!(bench.get("Linear.CommandAborted") && bench.get("Linear3.CommandAborted") && bench.get("Linear2.Busy"));
    bench.set("Linear.Execute", false);
    trace(&mut bench, "Linear2.Done");
    assert!(apart(place(&bench), [0.0, 0.0, 1.0]) < 1e-12);
    line(&mut bench, "Linear", &[1.0, 0.0, 1.0], &slow);
    bench.scans(80);
    bench.set("Linear2.Execute", false);
    bench.scan();
    line(&mut bench, "Linear2", &[0.0, 0.0, 0.0], &slow);
    bench.scans(2);
    bench.set("Power[3].Enable", false);
    bench.scans(200);
    assert!(bench.get("Linear2.Error") && state(&bench) == GroupState::ErrorStop);
    let [x, y, z] = place(&bench);
    assert!(x > 0.1 && x < 1.0 && y == 0.0 && (z - 1.0).abs() < 1e-12, "{x} {y} {z}");
}

/// One active and four that wait; of what is refused nothing is left.
#[test]
fn the_queue_has_an_end() {
    let mut bench = in_state(GroupState::Moving);
    let mut taken = 0;
    for _ in 0..7 {
        bench.set("Relative.Execute", false);
        bench.scan();
        line(&mut bench, "Relative", &[0.0, 0.01, 0.0], &[("Velocity", 1.0), ("BufferMode", BUFFERED)]);
        bench.scan();
        if bench.get("Relative.Error") {
            assert_eq!(bench.int("Relative.ErrorID"), 0x14);
        } else {
            taken += 1;
        }
    }
    assert_eq!((taken, bench.int("G.Count")), (4, 5));
    bench.start("Halt", &[("BufferMode", BUFFERED)]);
    bench.scan();
    assert_eq!((bench.int("Halt.ErrorID"), bench.int("G.Count")), (0x14, 5));
    line(&mut bench, "Linear", &[0.0, 0.0, 0.1], &[("Velocity", 1.0)]);
    trace(&mut bench, "Linear.Done");
    assert_eq!((place(&bench), bench.int("G.Count")), ([0.0, 0.0, 0.1], 0));
}
