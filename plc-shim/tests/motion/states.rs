//! The state diagram of an axis (2.1, figure 2): every command in every state, and every way back.

use std::fmt::Write;

use crate::bench::{Bench, State};

/// Commands of motion, each with values that are allowed.
const COMMANDS: [(&str, &[(&str, f64)]); 12] = [
    ("Home", &[]),
    ("Stop", &[("Deceleration", 10.0)]),
    ("Halt", &[("Deceleration", 10.0)]),
    ("Absolute", &[("Position", 1000.0), ("Velocity", 10.0), ("Acceleration", 10.0)]),
    ("Relative", &[("Distance", 1000.0), ("Velocity", 10.0), ("Acceleration", 10.0)]),
    ("Additive", &[("Distance", 1000.0), ("Velocity", 10.0), ("Acceleration", 10.0)]),
    ("Velocity", &[("Velocity", 10.0), ("Acceleration", 10.0)]),
    ("Superimposed", &[("Distance", 1000.0), ("VelocityDiff", 10.0), ("Acceleration", 10.0)]),
    ("Torque", &[("Torque", 1.0), ("Velocity", 10.0)]),
    ("GearBack", &[("Acceleration", 10.0)]),
    ("Reset", &[]),
    ("SetPosition", &[("Position", 5.0)]),
];

/// Axis X in `state`, with nothing left to be reported.
fn axis_in(state: State) -> Bench {
    if state == State::Disabled {
        let mut bench = Bench::cold();
        bench.scan();
        return bench;
    }
    let mut bench = Bench::new();
    match state {
        State::Homing => {
            bench.set_real("X.HomingVelocity", 1.0);
            bench.start("Home", &[]);
        }
        State::DiscreteMotion => {
            bench.start("Absolute2", &[("Position", 500.0), ("Velocity", 10.0), ("Acceleration", 10.0)]);
        }
        State::ContinuousMotion | State::Stopping => {
            bench.start("Relative2", &[("Distance", 0.0), ("Velocity", 10.0)]);
            bench.scans(3);
            bench.start("Velocity", &[("Velocity", 10.0), ("Acceleration", 10.0)]);
        }
        State::SynchronizedMotion => {
            bench.start("VelocityY", &[("Velocity", 5.0)]);
            bench.start("GearBack", &[("Acceleration", 1000.0)]);
        }
        State::ErrorStop => {
            bench.set("X.EnableLimitPos", true);
            bench.start("Velocity", &[("Velocity", 1.0), ("Acceleration", 10.0)]);
        }
        State::Disabled | State::Standstill => {}
    }
    bench.scans(5);
    if state == State::Stopping {
        bench.start("Stop", &[("Deceleration", 1.0)]);
        bench.scan();
    }
    assert_eq!(bench.state(), state);
    bench
}

/// What the figure says: the state behind the command, or the number of the error.
fn expected(state: State, command: &str) -> Result<State, i64> {
    use State::{
        ContinuousMotion, Disabled, DiscreteMotion, ErrorStop, Homing, Standstill, Stopping, SynchronizedMotion,
    };
    // Not commands of motion: they change the state in ErrorStop only, or never.
    match command {
        // Note 4.
        "Reset" if state == ErrorStop => return Ok(Standstill),
        "Reset" | "SetPosition" => return Ok(state),
        _ => {}
    }
    match state {
        Disabled => return Err(0x01),
        ErrorStop => return Err(0x02),
        Stopping => return Err(0x03),
        Homing if command != "Stop" => return Err(0x04),
        _ => {}
    }
    match command {
        "Stop" => Ok(Stopping),
        "Home" if state == Standstill => Ok(Homing),
        "Home" => Err(0x05),
        "Halt" | "Absolute" | "Relative" | "Additive" => Ok(DiscreteMotion),
        "Superimposed" if state == Standstill => Ok(DiscreteMotion),
        "Superimposed" => Ok(state),
        "Velocity" | "Torque" => Ok(ContinuousMotion),
        "GearBack" => Ok(SynchronizedMotion),
        other => panic!("{other}"),
    }
}

#[test]
fn every_command_in_every_state() {
    let mut table = String::new();
    for (command, values) in COMMANDS {
        write!(table, "{command:12}").expect("a string takes all");
        for state in State::ALL {
            let mut bench = axis_in(state);
            bench.set(&format!("{command}.Execute"), false);
            // A block that has brought the axis here is called with another edge.
            let busy = bench.get(&format!("{command}.Busy"));
            bench.scan();
            if command == "Stop" && state == State::Stopping {
                // Its own falling edge does not end the stop before the axis stands.
                assert_eq!(bench.state(), State::Stopping);
            }
            bench.start(command, values);
            bench.scan();
            let error = bench.int(&format!("{command}.ErrorID"));
            let found = if bench.get(&format!("{command}.Error")) { Err(error) } else { Ok(bench.state()) };
            assert_eq!(found, expected(state, command), "{command} in {state:?}, busy {busy}");
            let cell = found.map_or_else(|error| format!("16#{error:02X}"), |state| format!("{state:?}"));
            write!(table, " {cell:>18}").expect("a string takes all");
        }
        table.push('\n');
    }
    let states: String = State::ALL.iter().map(|state| format!(" {:>18}", format!("{state:?}"))).collect();
    insta::assert_snapshot!(format!("{:12}{states}\n{table}", ""));
}

#[test]
fn without_power_every_state_but_error_stop_becomes_disabled() {
    for state in State::ALL {
        let mut bench = axis_in(state);
        bench.set("Power.Enable", false);
        bench.scan();
        let left = if state == State::ErrorStop { State::ErrorStop } else { State::Disabled };
        assert_eq!(bench.state(), left, "{state:?}");
        assert_eq!(bench.velocity(), 0.0);
        for block in ["Absolute2", "Velocity", "Home", "GearBack", "Stop"] {
            assert!(!bench.get(&format!("{block}.Busy")) || left == State::ErrorStop, "{block} in {state:?}");
        }
        // Note 3: without power a reset leads to Disabled.
        bench.scan();
        bench.start("Reset", &[]);
        bench.scans(2);
        assert_eq!(bench.state(), State::Disabled, "{state:?}");
        // Note 5.
        bench.set("Power.Enable", true);
        bench.scan();
        assert_eq!(bench.state(), State::Standstill, "{state:?}");
    }
}

#[test]
fn what_is_done_leads_to_standstill() {
    for (block, values) in [
        ("Home", &[][..]),
        ("Halt", &[]),
        ("Absolute", &[("Position", 1.0), ("Velocity", 10.0)]),
        ("Superimposed", &[("Distance", 1.0), ("VelocityDiff", 10.0)]),
    ] {
        let mut bench = Bench::new();
        bench.start(block, values);
        bench.scan();
        assert_ne!(bench.state(), State::Standstill, "{block}");
        bench.until(&format!("{block}.Done"));
        assert_eq!(bench.state(), State::Standstill, "{block}");
    }
}

/// Note 6: the axis stays locked until `MC_Stop` is done and its Execute FALSE.
#[test]
fn a_stop_locks_the_axis_as_long_as_it_is_executed() {
    let mut bench = axis_in(State::ContinuousMotion);
    bench.start("Stop", &[("Deceleration", 10.0)]);
    bench.until("Stop.Done");
    assert!(bench.get("Velocity.CommandAborted"));
    bench.scans(10);
    assert_eq!((bench.state(), bench.velocity(), bench.get("Stop.Done")), (State::Stopping, 0.0, true));
    bench.set("Stop.Execute", false);
    bench.scan();
    assert_eq!((bench.state(), bench.get("Stop.Done")), (State::Standstill, false));
}

#[test]
fn a_stop_whose_execute_falls_early_goes_on_to_rest() {
    let mut bench = axis_in(State::ContinuousMotion);
    bench.start("Stop", &[("Deceleration", 1.0)]);
    bench.scan();
    bench.set("Stop.Execute", false);
    let mut shown = 0;
    for _ in 0..1000 {
        bench.scan();
        shown += usize::from(bench.get("Stop.Done"));
        if bench.state() == State::Standstill {
            break;
        }
        assert_eq!(bench.state(), State::Stopping);
    }
    bench.scan();
    assert_eq!((bench.state(), bench.velocity(), shown), (State::Standstill, 0.0, 1));
}

#[test]
fn a_coupling_that_is_dissolved_leads_to_continuous_motion() {
    let mut bench = Bench::new();
    bench.start("Velocity", &[("Velocity", 4.0)]);
    bench.start("Gear", &[("RatioNumerator", 2.0), ("Acceleration", 50.0)]);
    bench.until("Gear.InGear");
    assert_eq!(bench.state_of("StatusY"), State::SynchronizedMotion);
    bench.start("GearOut", &[]);
    bench.scan();
    assert!(bench.get("GearOut.Done"));
    bench.scan();
    assert!(bench.get("Gear.CommandAborted"));
    assert_eq!(bench.state_of("StatusY"), State::ContinuousMotion);
    bench.scans(50);
    assert_eq!(bench.real("Y.SetVelocity"), 8.0);
    bench.set("GearOut.Execute", false);
    bench.scan();
    bench.start("GearOut", &[]);
    bench.scan();
    assert_eq!((bench.get("GearOut.Error"), bench.int("GearOut.ErrorID")), (true, 0x06));
}

#[test]
fn an_error_of_the_axis_ends_its_commands_with_its_number() {
    let mut bench = Bench::new();
    bench.set("X.EnableLimitPos", true);
    bench.set_real("X.SWLimitPos", 3.0);
    bench.set_real("X.MaxDeceleration", 20.0);
    bench.start("Velocity", &[("Velocity", 10.0), ("Acceleration", 5.0)]);
    bench.scan();
    bench.start("Absolute3", &[("Position", 1.0), ("Velocity", 1.0), ("BufferMode", 1.0)]);
    bench.until("Velocity.Error");
    assert_eq!(bench.state(), State::ErrorStop);
    assert_eq!((bench.int("Velocity.ErrorID"), bench.int("Absolute3.ErrorID")), (0x83, 0x83));
    bench.set("ReadError.Enable", true);
    bench.start("Reset", &[]);
    bench.scan();
    assert_eq!((bench.get("Power.Error"), bench.int("ReadError.AxisErrorID")), (true, 0x83));
    // It comes to rest first.
    assert!(bench.get("Reset.Busy") && bench.velocity() > 0.0);
    bench.until("Reset.Done");
    assert_eq!((bench.state(), bench.velocity(), bench.int("X.ErrorID")), (State::Standstill, 0.0, 0));
}
