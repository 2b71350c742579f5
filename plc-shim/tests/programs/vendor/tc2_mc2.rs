//! `Tc2_MC2`: TwinCAT's names of motion control, on the axis of `iec/motion`.

use onescan_iec::Dialect;

use super::hold;
use crate::rig::{Rig, findings_in};

fn rig(declarations: &str, statements: &str) -> Rig {
    let text = format!("PROGRAM P\nVAR\n{declarations}\nEND_VAR\n{statements}\nEND_PROGRAM");
    Rig::in_dialect(Dialect::TwinCat, &text)
}

fn scans(rig: &mut Rig, count: usize) {
    for _ in 0..count {
        rig.scan().expect("no fault");
    }
}

/// An axis with power, and its status in each scan.
const AXIS: &str = "axis : AXIS_REF; power : MC_Power; on : BOOL := TRUE;";
const POWER: &str = "axis.ReadStatus();\npower(Axis := axis, Enable := on, Enable_Positive := TRUE, \
                     Enable_Negative := TRUE, Override := 50.0);\n";

#[test]
fn enumerations_have_twincats_numbers() {
    hold(
        Dialect::TwinCat,
        "d : MC_Direction; e : Tc2_MC2.MC_Direction := Tc2_MC2.MC_Direction.MC_Negative_Direction; \
         m : MC_BufferMode := MC_BufferMode.MC_Buffered; h : MC_HomingMode; o : ST_HomingOptions; s : ST_AxisStatus;",
        "",
        &[
            "d = MC_Direction.MC_Positive_Direction AND TO_INT(d) = 1",
            "TO_INT(e) = 3 AND TO_INT(MC_Undefined_Direction) = 128 AND TO_INT(MC_Current_Direction) = 4",
            "TO_INT(m) = 1 AND TO_INT(MC_BlendingHigh) = 5",
            "TO_INT(E_JogMode.MC_JOGMODE_INCHING) = 3",
            "TO_INT(MC_AxisStates.MC_AXISSTATE_SYNCHRONIZEDMOTION) = 8",
            "h = MC_DefaultHoming AND TO_INT(MC_ResetCalibration) = 3",
            "o.SearchDirection = MC_Undefined_Direction",
            "s.MotionState = MC_AXISSTATE_UNDEFINED",
        ],
    );
}

#[test]
fn an_axis_is_powered_and_moved() {
    let mut rig = rig(
        &format!("{AXIS} move : MC_MoveAbsolute; go : BOOL; done : BOOL; late : LREAL;"),
        &format!(
            "{POWER}move(Axis := axis, Execute := go, Position := 5.0, Velocity := 10.0, Acceleration := 100.0, \
             Deceleration := 100.0, Options := , BufferMode := MC_BufferMode.MC_Aborting, Done => done);\n\
             late := axis.NcToPlc.PosDiff;"
        ),
    );
    scans(&mut rig, 1);
    assert!(rig.bool("P.axis.Status.Disabled") && !rig.bool("P.axis.Status.Operational"), "before MC_Power was called");
    scans(&mut rig, 1);
    assert!(rig.bool("P.power.Status") && rig.bool("P.power.Active") && rig.bool("P.axis.Status.StandStill"));
    assert_eq!(rig.int("P.axis.Status.MotionState"), 2);
    assert_eq!(rig.int("P.axis.PlcToNc.ControlDWord"), 7);
    assert_eq!(rig.int("P.axis.PlcToNc.Override"), 500_000);
    rig.set("P.go", 1);
    scans(&mut rig, 11);
    // Ten scans of 10 ms after the start: the ramp to 10 u/s has just ended, half a unit on the way.
    assert!((rig.real("P.axis.NcToPlc.SetPos") - 0.5).abs() < 1e-9, "{}", rig.real("P.axis.NcToPlc.SetPos"));
    assert!((rig.real("P.axis.NcToPlc.ActVelo") - 10.0).abs() < 1e-9);
    scans(&mut rig, 10);
    assert_eq!(rig.int("P.axis.Status.MotionState"), 6);
    for (member, value) in [
        ("DiscreteMotion", true),
        ("Moving", true),
        ("PositiveDirection", true),
        ("NegativeDirection", false),
        ("ConstantVelocity", true),
        ("HasJob", true),
        ("NotMoving", false),
        ("InTargetPosition", false),
        ("Error", false),
    ] {
        assert_eq!(rig.bool(&format!("P.axis.Status.{member}")), value, "{member}");
    }
    assert_eq!(rig.int("P.axis.NcToPlc.StateDWord") >> 9 & 3, 1);
    assert!((rig.real("P.axis.NcToPlc.TargetPos") - 5.0).abs() < 1e-9);
    scans(&mut rig, 45);
    assert!(rig.bool("P.done") && rig.bool("P.axis.Status.InTargetPosition") && rig.bool("P.axis.Status.NotMoving"));
    assert!((rig.real("P.axis.NcToPlc.ActPos") - 5.0).abs() < 1e-9);
    assert_eq!(rig.int("P.axis.Status.MotionState"), 2);
    rig.set("P.on", 0);
    scans(&mut rig, 2);
    assert!(rig.bool("P.axis.Status.Disabled") && !rig.bool("P.power.Status"));
}

#[test]
fn errors_are_those_of_the_axis_until_a_reset() {
    let mut rig = rig(
        &format!(
            "{AXIS} move : MC_MoveVelocity; reset : MC_Reset; go, again : BOOL; read : MC_ReadStatus; hurt : BOOL;"
        ),
        &format!(
            "{POWER}move(Axis := axis, Execute := go, Velocity := 10.0, Direction := MC_Direction.MC_Negative_Direction);\n\
             reset(Axis := axis, Execute := again);\nread(Axis := axis, Enable := TRUE);\n\
             axis.OnescanAxis.Linked := hurt; axis.OnescanAxis.DriveFault := hurt;"
        ),
    );
    scans(&mut rig, 2);
    rig.set("P.go", 1);
    scans(&mut rig, 5);
    assert!(rig.bool("P.read.ContinuousMotion") && rig.bool("P.read.Status.NegativeDirection"));
    assert_eq!(rig.int("P.axis.Status.MotionState"), 7);
    assert!(rig.bool("P.move.InVelocity"));
    rig.set("P.hurt", 1);
    scans(&mut rig, 3);
    assert!(rig.bool("P.axis.Status.Error") && rig.bool("P.read.ErrorStop") && rig.bool("P.move.Error"));
    assert_eq!((rig.int("P.axis.Status.ErrorID"), rig.int("P.axis.NcToPlc.ErrorCode")), (0x81, 0x81));
    assert_eq!(rig.int("P.axis.Status.MotionState"), 3);
    rig.set("P.hurt", 0);
    scans(&mut rig, 2);
    rig.set("P.again", 1);
    scans(&mut rig, 3);
    assert!(rig.bool("P.reset.Done") && rig.bool("P.read.StandStill") && !rig.bool("P.axis.Status.Error"));
}

#[test]
fn jogging_moves_as_long_as_it_is_asked_for() {
    let mut rig = rig(
        &format!("{AXIS} jog : MC_Jog; forward, back : BOOL; mode : E_JogMode := E_JogMode.MC_JOGMODE_CONTINOUS;"),
        &format!(
            "{POWER}jog(Axis := axis, JogForward := forward, JogBackwards := back, Mode := mode, Position := 2.0, \
             Velocity := 20.0, Acceleration := 1000.0, Deceleration := 1000.0);"
        ),
    );
    scans(&mut rig, 2);
    rig.set("P.forward", 1);
    scans(&mut rig, 12);
    assert!(rig.bool("P.jog.Busy") && rig.bool("P.axis.Status.Moving"));
    assert!((rig.real("P.axis.NcToPlc.ActVelo") - 20.0).abs() < 1e-9);
    rig.set("P.forward", 0);
    rig.set("P.back", 1);
    scans(&mut rig, 12);
    assert!((rig.real("P.axis.NcToPlc.ActVelo") + 20.0).abs() < 1e-9 && !rig.bool("P.jog.Error"));
    rig.set("P.back", 0);
    scans(&mut rig, 10);
    assert!(
        rig.real("P.axis.NcToPlc.ActVelo") == 0.0 && !rig.bool("P.jog.Busy") && rig.bool("P.axis.Status.StandStill")
    );
    // Inching: one step, then rest, though it is still asked for.
    let start = rig.real("P.axis.NcToPlc.ActPos");
    rig.set("P.mode", 3);
    rig.set("P.forward", 1);
    scans(&mut rig, 40);
    assert!((rig.real("P.axis.NcToPlc.ActPos") - start - 2.0).abs() < 1e-9 && rig.bool("P.jog.Done"));
    rig.set("P.forward", 0);
    scans(&mut rig, 2);
    // To the next multiple of Position below.
    rig.set("P.mode", 4);
    rig.set("P.back", 1);
    scans(&mut rig, 40);
    let there = rig.real("P.axis.NcToPlc.ActPos") / 2.0;
    assert!((there - there.round()).abs() < 1e-9, "{there}");
    // The axis's own velocity of hand.
    rig.set("P.back", 0);
    scans(&mut rig, 2);
    rig.set("P.mode", 0);
    rig.set("P.back", 1);
    scans(&mut rig, 30);
    assert!((rig.real("P.axis.NcToPlc.ActVelo") + 100.0).abs() < 1e-9);
}

#[test]
fn homing_waits_for_its_cam() {
    let mut rig = rig(
        &format!("{AXIS} home : MC_Home; go, cam : BOOL; mode : MC_HomingMode; o : ST_HomingOptions;"),
        &format!(
            "{POWER}o.SearchVelocity := 10.0; o.SearchDirection := MC_Direction.MC_Negative_Direction;\n\
             home(Axis := axis, Execute := go, Position := 7.0, HomingMode := mode, Options := o, bCalibrationCam := cam);"
        ),
    );
    scans(&mut rig, 2);
    rig.set("P.go", 1);
    scans(&mut rig, 20);
    assert!(rig.bool("P.home.Busy") && rig.bool("P.axis.Status.HomingBusy") && !rig.bool("P.axis.Status.Homed"));
    assert_eq!(rig.int("P.axis.Status.MotionState"), 5);
    assert!(rig.real("P.axis.NcToPlc.ActPos") < -1.0);
    rig.set("P.cam", 1);
    scans(&mut rig, 5);
    assert!(rig.bool("P.home.Done") && rig.bool("P.axis.Status.Homed"));
    assert!((rig.real("P.axis.NcToPlc.ActPos") - 7.0).abs() < 0.2, "{}", rig.real("P.axis.NcToPlc.ActPos"));
    for (mode, homed, position) in [(3, false, None), (2, true, None), (3, false, None), (1, true, Some(7.0))] {
        rig.set("P.go", 0);
        scans(&mut rig, 2);
        rig.set("P.mode", mode);
        rig.set("P.go", 1);
        scans(&mut rig, 3);
        assert!(rig.bool("P.home.Done"), "{mode}");
        assert_eq!(rig.bool("P.axis.Status.Homed"), homed, "{mode}");
        if let Some(position) = position {
            assert_eq!(rig.real("P.axis.NcToPlc.ActPos"), position);
        }
    }
}

#[test]
fn positions_are_set_parameters_written_and_stops_lock() {
    let mut rig = rig(
        &format!(
            "{AXIS} set : MC_SetPosition; write : MC_WriteParameter; read : MC_ReadParameter; stop : MC_Stop; halt : MC_Halt; \
             move : MC_MoveRelative; where : MC_ReadActualPosition; go, still : BOOL; p : LREAL;"
        ),
        &format!(
            "{POWER}set.Options.ClearPositionLag := TRUE;\nset(Axis := axis, Execute := go, Position := 3.0, Mode := TRUE);\n\
             write(Axis := axis, Execute := go, ParameterNumber := 2, Value := 250.0);\n\
             read(Axis := axis, Enable := TRUE, ParameterNumber := 2, ReadMode := READMODE_CYCLIC);\n\
             move(Axis := axis, Execute := set.Done, Distance := 100.0, Velocity := 5.0);\n\
             halt(Axis := axis, Execute := FALSE); stop(Axis := axis, Execute := still, Deceleration := 50.0);\n\
             where(Axis := axis, Enable := TRUE, Position => p);"
        ),
    );
    scans(&mut rig, 2);
    rig.set("P.go", 1);
    scans(&mut rig, 10);
    assert!(rig.bool("P.set.Done") && rig.bool("P.write.Done") && rig.bool("P.axis.Status.Moving"));
    assert_eq!(rig.real("P.read.Value"), 250.0);
    assert!(rig.real("P.p") > 3.0 && rig.real("P.p") < 4.0);
    rig.set("P.still", 1);
    scans(&mut rig, 20);
    assert!(
        rig.bool("P.stop.Done") && rig.bool("P.axis.Status.Stopping") && rig.bool("P.axis.Status.MotionCommandsLocked")
    );
    rig.set("P.still", 0);
    scans(&mut rig, 2);
    assert!(rig.bool("P.axis.Status.StandStill"));
}

#[test]
fn a_slave_follows_by_a_broken_ratio() {
    let mut rig = rig(
        &format!("{AXIS} slave : AXIS_REF; power2 : MC_Power; move : MC_MoveVelocity; gear : MC_GearIn; go : BOOL;"),
        &format!(
            "{POWER}slave.ReadStatus();\npower2(Axis := slave, Enable := TRUE, Enable_Positive := TRUE, Enable_Negative := TRUE);\n\
             move(Axis := axis, Execute := go, Velocity := 10.0);\n\
             gear(Master := axis, Slave := slave, Execute := go, RatioNumerator := 0.5, RatioDenominator := 2);"
        ),
    );
    scans(&mut rig, 2);
    rig.set("P.go", 1);
    scans(&mut rig, 20);
    assert!(rig.bool("P.gear.InGear") && rig.bool("P.slave.Status.Coupled"));
    assert_eq!(rig.int("P.slave.NcToPlc.CoupleState"), 3);
    assert!((rig.real("P.slave.NcToPlc.SetVelo") - 2.5).abs() < 1e-9);
}

#[test]
fn a_project_derives_its_axis() {
    let text = "FUNCTION_BLOCK Mine EXTENDS Tc2_MC2.AXIS_REF VAR State, Target : INT; END_VAR END_FUNCTION_BLOCK
        FUNCTION_BLOCK Switch VAR_IN_OUT a : AXIS_REF; END_VAR VAR power : Tc2_MC2.MC_Power; END_VAR
            power(Axis := a, Enable := TRUE, Enable_Positive := TRUE); END_FUNCTION_BLOCK
        PROGRAM P VAR a : Mine; s : Switch; END_VAR s(a := a); a.ReadStatus(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    scans(&mut rig, 2);
    assert!(rig.bool("P.a.Status.StandStill") && rig.bool("P.s.power.Status"));
}

#[test]
fn a_projects_own_names_take_precedence() {
    let text = "TYPE MC_Direction : (Up, Down); END_TYPE
        PROGRAM P VAR d : MC_Direction := Down; a : AXIS_REF; on : MC_Power; m : MC_MoveVelocity; END_VAR
            on(Axis := a, Enable := TRUE, Enable_Positive := TRUE, Enable_Negative := TRUE);
            m(Axis := a, Execute := on.Status, Velocity := 10.0, Direction := Tc2_MC2.MC_Direction.MC_Negative_Direction);
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    scans(&mut rig, 5);
    assert!(rig.real("P.a.NcToPlc.ActVelo") < 0.0 && rig.int("P.d") == 1);
    let declared =
        "TYPE AXIS_REF : STRUCT x : INT; END_STRUCT END_TYPE PROGRAM P VAR a : AXIS_REF; END_VAR a.x := 1; END_PROGRAM";
    assert_eq!(findings_in(Dialect::TwinCat, declared).to_string(), "");
}
