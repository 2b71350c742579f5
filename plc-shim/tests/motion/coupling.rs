//! Gears and cams: what the slave does of what the master does.

use crate::bench::{Bench, State};

/// Y coupled to X with `numerator` to `denominator`, X with `velocity`.
fn geared(numerator: f64, denominator: f64, velocity: f64, jerk: f64) -> Bench {
    let mut bench = Bench::new();
    bench.start("Velocity", &[("Velocity", velocity), ("Acceleration", 10.0)]);
    bench.until("Velocity.InVelocity");
    let ratio = [("RatioNumerator", numerator), ("RatioDenominator", denominator)];
    bench.start("Gear", &[ratio[0], ratio[1], ("Acceleration", 20.0), ("Deceleration", 20.0), ("Jerk", jerk)]);
    bench.scan();
    bench
}

#[test]
fn the_slave_runs_up_to_the_ratio_and_then_keeps_its_way() {
    for (numerator, denominator, jerk) in [(2.0, 1.0, 0.0), (-3.0, 2.0, 0.0), (1.0, 4.0, 200.0)] {
        let ratio = numerator / denominator;
        let mut bench = geared(numerator, denominator, 4.0, jerk);
        let begun = bench.now_s();
        assert_eq!(bench.state_of("StatusY"), State::SynchronizedMotion);
        bench.until("Gear.InGear");
        let change = (4.0 * ratio).abs();
        let wanted = if jerk == 0.0 { change / 20.0 } else { 2.0 * (change / jerk).sqrt() };
        assert!((bench.now_s() - begun - wanted).abs() < 0.021, "{} s, not {wanted}", bench.now_s() - begun);
        // The master accelerates, turns round and stops: the difference of ways stays to the last bit but rounding.
        let difference = |bench: &Bench| bench.real("Y.SetPosition") - ratio * bench.position();
        let first = difference(&bench);
        for (velocity, scans) in [(9.0, 100), (-5.0, 200), (0.0, 100)] {
            bench.set("Velocity.Execute", false);
            bench.scan();
            bench.start("Velocity", &[("Velocity", velocity), ("Acceleration", 10.0), ("Deceleration", 10.0)]);
            for _ in 0..scans {
                bench.scan();
                assert!((difference(&bench) - first).abs() < 1e-9, "{}", difference(&bench) - first);
                assert!((bench.real("Y.SetVelocity") - ratio * bench.velocity()).abs() < 1e-12);
            }
        }
        assert!(bench.get("Gear.InGear") && bench.get("Gear.Active"));
    }
}

#[test]
fn the_ratio_can_be_changed_while_it_runs() {
    let mut bench = Bench::new();
    bench.start("Velocity", &[("Velocity", 4.0), ("Acceleration", 10.0)]);
    bench.until("Velocity.InVelocity");
    bench.set("Gear.ContinuousUpdate", true);
    bench.start("Gear", &[("RatioNumerator", 1.0), ("Acceleration", 20.0)]);
    bench.until("Gear.InGear");
    bench.set_int("Gear.RatioNumerator", 3);
    bench.scan();
    assert!(!bench.get("Gear.InGear") && bench.get("Gear.Active"));
    bench.until("Gear.InGear");
    assert!((bench.real("Y.SetVelocity") - 12.0).abs() < 1e-12);
}

#[test]
fn a_gear_without_a_denominator_is_refused() {
    let mut bench = Bench::new();
    bench.start("Gear", &[("RatioDenominator", 0.0)]);
    bench.scan();
    assert_eq!((bench.get("Gear.Error"), bench.int("Gear.ErrorID")), (true, 0x15));
}

#[test]
fn a_command_to_the_slave_ends_the_coupling() {
    let mut bench = geared(2.0, 1.0, 4.0, 0.0);
    bench.until("Gear.InGear");
    bench.start("HaltY", &[("Deceleration", 16.0)]);
    bench.scan();
    bench.scan();
    assert!(bench.get("Gear.CommandAborted") && !bench.get("Gear.InGear"));
    bench.until("HaltY.Done");
    assert_eq!((bench.real("Y.SetVelocity"), bench.state_of("StatusY")), (0.0, State::Standstill));
    // The master does not care.
    assert_eq!(bench.velocity(), 4.0);
}

/// A rise from 0 to 5 over 10 of the master with a rest at both ends, and back.
fn cam(bench: &mut Bench) {
    bench.set_int("Table.Count", 3);
    for (at, (master, slave)) in [(0.0, 0.0), (10.0, 5.0), (20.0, 0.0)].into_iter().enumerate() {
        bench.set_real(&format!("Table.Points[{}].Master", at + 1), master);
        bench.set_real(&format!("Table.Points[{}].Slave", at + 1), slave);
    }
}

/// The cubic between two rests: 3 x2 - 2 x3.
fn rise(master: f64) -> f64 {
    let x = (master / 10.0).clamp(0.0, 2.0);
    let x = if x > 1.0 { 2.0 - x } else { x };
    5.0 * (3.0 - 2.0 * x) * x * x
}

#[test]
fn the_slave_follows_the_cam_turn_after_turn() {
    let mut bench = Bench::new();
    cam(&mut bench);
    bench.set("Select.Periodic", true);
    bench.start("Select", &[]);
    bench.start("Cam", &[]);
    bench.start("Velocity", &[("Velocity", 8.0), ("Acceleration", 10.0)]);
    bench.scan();
    assert!(bench.get("Select.Done") && bench.get("Cam.Active"));
    let mut ends = 0;
    for _ in 0..1000 {
        bench.scan();
        let turn = bench.position().rem_euclid(20.0);
        assert!(bench.get("Cam.InSync"));
        assert!((bench.real("Y.SetPosition") - rise(turn)).abs() < 1e-9, "at {turn}");
        ends += usize::from(bench.get("Cam.EndOfProfile"));
    }
    assert_eq!(ends, (bench.position() / 20.0) as usize);
    bench.start("CamOut", &[]);
    bench.scan();
    bench.scan();
    assert_eq!(bench.state_of("StatusY"), State::ContinuousMotion);
    assert!(bench.get("Cam.CommandAborted"));
}

#[test]
fn a_cam_that_is_not_periodic_ends_where_it_ends() {
    let mut bench = Bench::new();
    cam(&mut bench);
    bench.start("Select", &[]);
    bench.start("Cam", &[("SlaveScaling", 2.0), ("SlaveOffset", 1.0), ("MasterScaling", 0.5)]);
    bench.scan();
    // The slave runs to where the cam wants it, which is 1, with the limits of the axis.
    bench.until("Cam.InSync");
    assert!((bench.real("Y.SetPosition") - 1.0).abs() < 1e-9);
    bench.start("Velocity", &[("Velocity", 8.0), ("Acceleration", 10.0)]);
    while bench.position() < 9.0 {
        bench.scan();
        let wanted = 1.0 + 2.0 * rise(bench.position() / 0.5);
        assert!((bench.real("Y.SetPosition") - wanted).abs() < 1e-9);
    }
    bench.until("Cam.EndOfProfile");
    bench.scans(10);
    assert!((bench.real("Y.SetPosition") - 1.0).abs() < 1e-9 && bench.real("Y.SetVelocity") == 0.0);
}

#[test]
fn a_relative_cam_begins_where_the_slave_is() {
    let mut bench = Bench::new();
    cam(&mut bench);
    bench.start("VelocityY", &[("Velocity", 3.0), ("Acceleration", 10.0)]);
    bench.scans(100);
    bench.start("HaltY", &[("Deceleration", 10.0)]);
    bench.until("HaltY.Done");
    let rest = bench.real("Y.SetPosition");
    bench.set("Select.Execute", true);
    bench.start("Cam", &[("StartMode", 1.0)]);
    bench.start("Velocity", &[("Velocity", 8.0), ("Acceleration", 10.0)]);
    bench.scan();
    bench.scans(90);
    let wanted = rest + rise(bench.position());
    assert!((bench.real("Y.SetPosition") - wanted).abs() < 1e-9);
}

#[test]
fn a_table_that_does_not_rise_is_refused() {
    let mut bench = Bench::new();
    cam(&mut bench);
    bench.set_real("Table.Points[2].Master", 0.0);
    bench.start("Select", &[]);
    bench.start("Cam", &[]);
    bench.scan();
    assert_eq!((bench.get("Select.Error"), bench.int("Select.ErrorID")), (true, 0x16));
    assert_eq!((bench.get("Cam.Error"), bench.int("Cam.ErrorID")), (true, 0x16));
}
