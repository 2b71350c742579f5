//! What is between an axis and its drive, homing, torque, parameters.

use crate::bench::{Bench, State};

/// Axis X follows a drive that the test plays.
fn linked() -> Bench {
    let mut bench = Bench::cold();
    bench.set("X.Linked", true);
    bench.set_real("X.ActualPosition", 4.0);
    bench.scan();
    bench.set("Power.Enable", true);
    bench.scan();
    bench
}

/// The drive of this scan: it is where it was ordered to be.
fn follow(bench: &mut Bench) {
    let (position, velocity) = (bench.position(), bench.velocity());
    bench.set_real("X.ActualPosition", position);
    bench.set_real("X.ActualVelocity", velocity);
}

#[test]
fn power_waits_for_the_drive_and_the_axis_begins_where_that_is() {
    let mut bench = linked();
    assert!(bench.get("X.DriveEnable") && !bench.get("Power.Status"));
    assert_eq!(bench.state(), State::Disabled);
    bench.set_real("X.ActualPosition", 5.0);
    bench.set("X.DriveReady", true);
    bench.scan();
    assert!(bench.get("Power.Status"));
    assert_eq!((bench.state(), bench.position()), (State::Standstill, 5.0));
    bench.start("Relative", &[("Distance", 1.0), ("Velocity", 2.0)]);
    while !bench.get("Relative.Done") {
        bench.scan();
        follow(&mut bench);
    }
    assert_eq!(bench.position(), 6.0);
}

#[test]
fn a_drive_that_fails_or_lags_puts_the_axis_into_error_stop() {
    for (fault, number) in [("X.DriveFault", 0x81), ("X.DriveReady", 0x81), ("lag", 0x82)] {
        let mut bench = linked();
        bench.set("X.DriveReady", true);
        bench.set("X.EnablePosLagMonitoring", true);
        bench.set_real("X.MaxPositionLag", 0.5);
        bench.start("Velocity", &[("Velocity", 2.0), ("Acceleration", 10.0)]);
        for _ in 0..50 {
            bench.scan();
            follow(&mut bench);
        }
        assert_eq!(bench.state(), State::ContinuousMotion);
        match fault {
            "lag" => bench.scans(30),
            "X.DriveReady" => bench.set(fault, false),
            _ => bench.set(fault, true),
        }
        bench.scan();
        bench.scan();
        assert_eq!((bench.state(), bench.int("Velocity.ErrorID")), (State::ErrorStop, number), "{fault}");
        // A cause that lasts cannot be reset; after a second that is an error.
        if fault == "X.DriveFault" {
            bench.start("Reset", &[]);
            bench.scan();
            assert!(bench.get("X.DriveReset"));
            bench.until("Reset.Error");
            assert_eq!(bench.state(), State::ErrorStop);
            bench.set("Reset.Execute", false);
            bench.set("X.DriveFault", false);
            bench.scan();
        }
        bench.set("X.DriveReady", true);
        bench.start("Reset", &[]);
        bench.until("Reset.Done");
        assert_eq!((bench.state(), bench.position()), (State::Standstill, bench.real("X.ActualPosition")), "{fault}");
    }
}

#[test]
fn homing_sets_the_position_at_the_switch() {
    let mut bench = Bench::new();
    bench.set_real("X.HomingVelocity", -2.0);
    bench.set_real("X.MaxDeceleration", 10.0);
    bench.set_real("X.MaxAcceleration", 10.0);
    bench.start("Home", &[("Position", 100.0)]);
    bench.scans(100);
    assert_eq!((bench.state(), bench.velocity()), (State::Homing, -2.0));
    let switch = bench.position();
    bench.set("X.HomeSwitch", true);
    bench.until("Home.Done");
    bench.set("ReadPosition.Enable", true);
    bench.scan();
    // 0.2 u to come to rest: the drive stays in its own coordinates.
    assert!((bench.real("ReadPosition.Position") - (100.0 - 0.2)).abs() < 1e-9);
    assert!((bench.position() - (switch - 0.2)).abs() < 1e-9);
    bench.start("Absolute", &[("Position", 100.0), ("Velocity", 1.0)]);
    bench.until("Absolute.Done");
    assert!((bench.position() - switch).abs() < 1e-9);
}

#[test]
fn a_position_can_be_set_while_it_moves() {
    let mut bench = Bench::new();
    bench.set("ReadPosition.Enable", true);
    bench.start("Absolute", &[("Position", 10.0), ("Velocity", 2.0), ("Acceleration", 5.0)]);
    bench.scans(100);
    bench.set("SetPosition.Relative", true);
    bench.start("SetPosition", &[("Position", 50.0)]);
    bench.scan();
    assert!(bench.get("SetPosition.Done"));
    bench.until("Absolute.Done");
    bench.scan();
    // The same distance to go; 10 is now 60.
    assert!((bench.position() - 10.0).abs() < 1e-9);
    assert!((bench.real("ReadPosition.Position") - 60.0).abs() < 1e-9);
    bench.set("SetPosition.Execute", false);
    bench.set("SetPosition.Relative", false);
    bench.scan();
    bench.start("SetPosition", &[("Position", 0.0)]);
    bench.scans(2);
    assert!(bench.real("ReadPosition.Position").abs() < 1e-9);
}

#[test]
fn a_modulo_axis_goes_the_way_round_that_it_is_given() {
    // Positive, shortest, negative, current: from 350 to 10 and from 10 to 350 of 360.
    for (direction, there, back) in [(0.0, 370.0, 710.0), (1.0, 370.0, 350.0), (2.0, 10.0, -10.0)] {
        let mut bench = Bench::new();
        bench.set_real("X.ModuloPeriod", 360.0);
        bench.set("ReadPosition.Enable", true);
        bench.start("Relative", &[("Distance", 350.0), ("Velocity", 200.0)]);
        bench.until("Relative.Done");
        bench.start("Absolute", &[("Position", 10.0), ("Velocity", 200.0), ("Direction", direction)]);
        bench.until("Absolute.Done");
        assert!((bench.position() - there).abs() < 1e-9, "{direction}: {}", bench.position());
        bench.scan();
        assert!((bench.real("ReadPosition.Position") - 10.0).abs() < 1e-9);
        bench.start("Absolute2", &[("Position", 350.0), ("Velocity", 200.0), ("Direction", direction)]);
        bench.until("Absolute2.Done");
        assert!((bench.position() - back).abs() < 1e-9, "{direction}: {}", bench.position());
    }
}

#[test]
fn a_modulo_axis_that_cannot_stop_in_time_goes_round_once_more() {
    let mut bench = Bench::new();
    bench.set_real("X.ModuloPeriod", 360.0);
    bench.start("Velocity", &[("Velocity", 100.0), ("Acceleration", 100.0)]);
    bench.until("Velocity.InVelocity");
    let here = bench.position();
    // 50 to stop; 10 to go.
    bench.start("Absolute", &[("Position", here + 10.0), ("Velocity", 100.0), ("Deceleration", 100.0)]);
    let mut last = bench.position();
    while !bench.get("Absolute.Done") {
        bench.scan();
        assert!(bench.position() >= last - 1e-9);
        last = bench.position();
    }
    assert!((last - here - 370.0).abs() < 1e-9, "{}", last - here);
}

#[test]
fn a_torque_rises_by_its_ramp_and_accelerates_the_inertia() {
    let mut bench = Bench::new();
    bench.set_real("X.Inertia", 2.0);
    bench.set("ReadTorque.Enable", true);
    bench.start("Torque", &[("Torque", 4.0), ("TorqueRamp", 8.0), ("Velocity", 3.0)]);
    bench.scan();
    let begun = bench.now_s();
    assert!(bench.get("X.TorqueMode"));
    bench.until("Torque.InTorque");
    assert!((bench.now_s() - begun - 0.5).abs() < 0.011);
    assert_eq!((bench.real("X.SetTorque"), bench.state()), (4.0, State::ContinuousMotion));
    let (before, since) = (bench.velocity(), bench.now_s());
    bench.scans(20);
    // a = 4 Nm / 2 kgm2.
    assert!((bench.velocity() - before - 2.0 * (bench.now_s() - since)).abs() < 1e-9);
    bench.scans(200);
    assert_eq!((bench.velocity(), bench.real("ReadTorque.Torque")), (3.0, 4.0));
    bench.start("Halt", &[("Deceleration", 10.0)]);
    bench.until("Halt.Done");
    assert_eq!((bench.real("X.SetTorque"), bench.get("X.TorqueMode")), (0.0, false));
    assert!(bench.get("Torque.CommandAborted"));
}

#[test]
fn values_out_of_range_are_refused_with_their_number() {
    for (block, values, number) in [
        ("Absolute", &[("Velocity", 0.0)][..], 0x10),
        ("Absolute", &[("Velocity", -1.0)], 0x10),
        ("Absolute", &[("Velocity", f64::NAN)], 0x10),
        ("Absolute", &[("Velocity", 11.0)], 0x10),
        ("Velocity", &[("Velocity", -11.0)], 0x10),
        ("Velocity", &[("Velocity", 1.0), ("Direction", 1.0)], 0x13),
        ("Absolute", &[("Velocity", 1.0), ("Acceleration", -1.0)], 0x11),
        ("Relative", &[("Velocity", 1.0), ("Deceleration", 101.0)], 0x11),
        ("Relative", &[("Velocity", 1.0), ("Jerk", -1.0)], 0x11),
        ("Absolute", &[("Velocity", 1.0), ("Position", 51.0)], 0x12),
        ("Additive", &[("Velocity", 1.0), ("Distance", 51.0)], 0x12),
        ("Torque", &[("Velocity", 1.0), ("TorqueRamp", -1.0)], 0x17),
    ] {
        let mut bench = Bench::new();
        bench.set_real("X.MaxVelocity", 10.0);
        bench.set_real("X.MaxDeceleration", 100.0);
        bench.set("X.EnableLimitPos", true);
        bench.set_real("X.SWLimitPos", 50.0);
        bench.start(block, values);
        bench.scan();
        assert_eq!(bench.int(&format!("{block}.ErrorID")), number, "{block} {values:?}");
        assert!(bench.get(&format!("{block}.Error")) && bench.state() == State::Standstill);
    }
}

#[test]
fn a_direction_that_is_not_enabled_is_refused() {
    let mut bench = Bench::new();
    bench.set("Power.EnableNegative", false);
    bench.scan();
    bench.start("Relative", &[("Distance", -1.0), ("Velocity", 1.0)]);
    bench.start("Relative2", &[("Distance", 1.0), ("Velocity", 1.0)]);
    bench.scan();
    assert_eq!((bench.int("Relative.ErrorID"), bench.get("Relative2.Busy")), (0x19, true));
}

#[test]
fn parameters_are_read_and_written_by_number() {
    let mut bench = Bench::new();
    bench.start("WriteParameter", &[("ParameterNumber", 9.0), ("Value", 7.5)]);
    bench.set_int("ReadParameter.ParameterNumber", 8);
    bench.set("ReadParameter.Enable", true);
    bench.set_int("WriteBool.ParameterNumber", 6);
    bench.set("WriteBool.Value", true);
    bench.set("WriteBool.Execute", true);
    bench.set_int("ReadBool.ParameterNumber", 6);
    bench.set("ReadBool.Enable", true);
    bench.scan();
    bench.scan();
    assert!(bench.get("WriteParameter.Done") && bench.get("WriteBool.Done"));
    assert_eq!((bench.real("ReadParameter.Value"), bench.get("ReadBool.Value")), (7.5, true));
    bench.set("WriteParameter.Execute", false);
    bench.scan();
    // That of the system is read only.
    bench.start("WriteParameter", &[("ParameterNumber", 8.0), ("Value", 7.5)]);
    bench.set_int("ReadParameter.ParameterNumber", 99);
    bench.scan();
    assert_eq!((bench.int("WriteParameter.ErrorID"), bench.int("ReadParameter.ErrorID")), (0x18, 0x18));
    assert!(!bench.get("ReadParameter.Valid"));
}
