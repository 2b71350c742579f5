//! Bodies and axes against closed forms.

use onescan_server::time::TimeSpan;

use crate::bench::Bench;

/// A load of 100 kg on a vertical slide; `drive` is the rest of its axis.
fn lift(drive: &str) -> String {
    format!(
        r#"
        version = 1
        [[body]]
        name = "load"
        kind = "dynamic"
        shape = "box"
        size_m = [0.4, 0.4, 0.4]
        mass_kg = 100.0
        [[joint]]
        name = "slide"
        kind = "prismatic"
        parent = "ground"
        child = "load"
        axis = [0.0, 0.0, 1.0]
        lower_m = -1.0
        upper_m = 1.0
        [[axis]]
        name = "lift"
        joint = "slide"
        position_signal = "position"
        velocity_signal = "velocity"
        {drive}
        "#
    )
}

const TWO_SIGNALS: &str = r#"
    drive = "bidirectional"
    forward_signal = "up"
    reverse_signal = "down"
    speed_m_s = 0.5
    acceleration_m_s2 = 2.0
"#;

fn height_m(bench: &Bench, body: &str) -> f64 {
    bench.plant.poses().find(|pose| pose.name == body).expect("a body").position_m[2]
}

#[test]
fn a_free_body_falls_as_bodies_do() {
    let scene = r#"
        version = 1
        solver_iterations = 4
        [[body]]
        name = "stone"
        kind = "dynamic"
        shape = "sphere"
        radius_m = 0.1
        density_kg_m3 = 2500.0
        position_m = [0.0, 0.0, 100.0]
    "#;
    let mut bench = Bench::new(scene);
    for k in 1..=200 {
        bench.turn();
        let t_s = f64::from(k) * 0.01;
        let fallen_m = 100.0 - height_m(&bench, "stone");
        let exact_m = 0.5 * 9.81 * t_s * t_s;
        // the engine integrates velocity first, in four parts of a step: g t h / 2 too far
        let first_order_m = 0.5 * 9.81 * t_s * 0.01 / 4.0;
        assert!((fallen_m - exact_m - first_order_m).abs() < 1e-9, "{k}: {fallen_m} {exact_m}");
    }
}

#[test]
fn substeps_make_the_fall_finer() {
    let scene = |substeps| {
        format!(
            "version = 1\nsubsteps = {substeps}\n[[body]]\nname = \"stone\"\nkind = \"dynamic\"\nshape = \"sphere\"\n\
             radius_m = 0.1\nmass_kg = 1.0\n"
        )
    };
    let error_m = |substeps| {
        let mut bench = Bench::new(&scene(substeps));
        for _ in 0..100 {
            bench.turn();
        }
        -height_m(&bench, "stone") - 0.5 * 9.81
    };
    assert!((error_m(1) / error_m(10) - 10.0).abs() < 1e-3);
}

#[test]
fn a_loaded_axis_follows_its_ramp() {
    for period_ms in [1, 4, 10] {
        let period = TimeSpan::from_millis(period_ms).expect("not zero");
        let mut bench = Bench::with_period(&lift(TWO_SIGNALS), period);
        bench.command("up", true);
        for k in 1..=1000 / period_ms {
            bench.turn();
            let t_s = (k * period_ms) as f64 / 1000.0;
            let exact_m = if t_s < 0.25 { t_s * t_s } else { 0.0625 + 0.5 * (t_s - 0.25) };
            let position_m: f64 = bench.read("position");
            // the motor's compliance and the joint's lets 100 kg sink by less than this
            assert!((position_m - exact_m).abs() < 1e-8, "{period}: {k}: {position_m} {exact_m}");
        }
        let velocity_m_s: f64 = bench.read("velocity");
        assert!((velocity_m_s - 0.5).abs() < 1e-6, "{velocity_m_s}");
    }
}

#[test]
fn both_commands_at_once_are_none() {
    let mut bench = Bench::new(&lift(TWO_SIGNALS));
    bench.command("up", true);
    bench.command("down", true);
    for _ in 0..20 {
        bench.turn();
    }
    assert!(bench.read::<f64>("position").abs() < 1e-9);
}

#[test]
fn a_weak_drive_cannot_hold_its_load() {
    // 981 N are needed
    let mut bench = Bench::new(&lift(&format!("{TWO_SIGNALS}\nforce_max_n = 900.0")));
    for _ in 0..50 {
        bench.turn();
    }
    // what is left of gravity is 0.81 m/s², for half a second
    let position_m: f64 = bench.read("position");
    assert!((position_m + 0.5 * 0.81 * 0.25).abs() < 2e-3, "{position_m}");
}

#[test]
fn a_strong_drive_holds_its_load() {
    let mut bench = Bench::new(&lift(&format!("{TWO_SIGNALS}\nforce_max_n = 1000.0")));
    for _ in 0..50 {
        bench.turn();
    }
    assert!(bench.read::<f64>("position").abs() < 1e-8);
}

#[test]
fn an_axis_that_was_blocked_does_not_jump() {
    let mut bench = Bench::new(&lift(TWO_SIGNALS));
    bench.command("up", true);
    for _ in 0..400 {
        bench.turn();
    }
    let blocked_m: f64 = bench.read("position");
    assert!((blocked_m - 1.0).abs() < 1e-4, "{blocked_m}");
    bench.command("up", false);
    bench.command("down", true);
    let mut before_m = blocked_m;
    for _ in 0..50 {
        bench.turn();
        let now_m: f64 = bench.read("position");
        // a quarter more than its speed while the setpoint's lead of one period is made up for
        assert!((before_m - now_m) / 0.01 < 0.5 * 1.25 + 1e-6, "{before_m} {now_m}");
        before_m = now_m;
    }
    assert!(before_m < 0.9, "{before_m}");
}

#[test]
fn a_commanded_velocity_is_ramped_to_and_bounded() {
    let drive = r#"
        drive = "velocity"
        command_signal = "speed"
        speed_m_s = 0.5
        acceleration_m_s2 = 2.0
        signal_type = "REAL"
    "#;
    let mut bench = Bench::new(&lift(drive));
    bench.command("speed", 0.25_f32);
    for _ in 0..14 {
        bench.turn();
    }
    assert!((bench.read::<f32>("velocity") - 0.25).abs() < 1e-6);
    bench.command("speed", -7.0_f32);
    for _ in 0..40 {
        bench.turn();
    }
    assert!((bench.read::<f32>("velocity") + 0.5).abs() < 1e-6);
}

#[test]
fn a_command_that_is_no_number_is_a_fault_of_that_axis() {
    let drive = "drive = \"position\"\ncommand_signal = \"to\"\nspeed_m_s = 1.0\nacceleration_m_s2 = 1.0";
    let mut bench = Bench::new(&lift(drive));
    bench.command("to", f64::NAN);
    let fault = bench.try_turn().expect_err("a fault");
    assert_eq!(fault.to_string(), "axis `lift` is commanded NaN, which is not a finite number");
}

#[test]
fn a_commanded_position_is_reached_and_held() {
    let drive = "drive = \"position\"\ncommand_signal = \"to\"\nspeed_m_s = 0.5\nacceleration_m_s2 = 2.0";
    let mut bench = Bench::new(&lift(drive));
    for (target_m, reached_m) in [(0.7, 0.7), (-0.2, -0.2), (5.0, 1.0)] {
        bench.command("to", target_m);
        for _ in 0..300 {
            bench.turn();
        }
        let position_m: f64 = bench.read("position");
        assert!((position_m - reached_m).abs() < 1e-8, "{position_m}");
    }
}

#[test]
fn a_turntable_counts_its_turns() {
    let scene = r#"
        version = 1
        [[body]]
        name = "table"
        kind = "dynamic"
        shape = "cylinder"
        radius_m = 0.5
        length_m = 0.05
        mass_kg = 60.0
        rpy_deg = [0.0, 0.0, 30.0]
        [[joint]]
        name = "bearing"
        kind = "revolute"
        parent = "ground"
        child = "table"
        axis = [0.0, 0.0, 1.0]
        initial_rad = 1.0
        [[axis]]
        name = "turntable"
        joint = "bearing"
        drive = "position"
        command_signal = "to"
        speed_rad_s = 6.0
        acceleration_rad_s2 = 12.0
        position_signal = "angle"
    "#;
    let mut bench = Bench::new(scene);
    assert_eq!(bench.read::<f64>("angle"), 1.0);
    for target_rad in [31.0, -50.0] {
        bench.command("to", target_rad);
        for _ in 0..1600 {
            bench.turn();
        }
        let angle_rad: f64 = bench.read("angle");
        assert!((angle_rad - target_rad).abs() < 1e-6, "{angle_rad}");
    }
}

/// A ball on a string of 1 m, thrown across it.
pub(crate) const BALL: &str = r#"
    version = 1
    [[body]]
    name = "bob"
    kind = "dynamic"
    shape = "sphere"
    radius_m = 0.05
    mass_kg = 2.0
    position_m = [1.0, 0.0, 0.0]
    velocity_m_s = [0.0, 1.0, 0.0]
    [[joint]]
    name = "string"
    kind = "ball"
    parent = "ground"
    child = "bob"
    anchor_m = [0.0, 0.0, 0.0]
"#;

#[test]
fn a_ball_joint_keeps_its_distance() {
    let mut bench = Bench::new(BALL);
    for k in 0..300 {
        bench.turn();
        let [x, y, z] = bench.plant.poses().next().expect("a bob").position_m;
        let length_m = (x * x + y * y + z * z).sqrt();
        assert!((length_m - 1.0).abs() < 1e-3, "{k}: {length_m}");
    }
}

#[test]
fn a_kinematic_body_keeps_its_velocity_and_carries_what_lies_on_it() {
    let scene = r#"
        version = 1
        [[body]]
        name = "table"
        kind = "kinematic"
        shape = "box"
        size_m = [4.0, 1.0, 0.1]
        position_m = [0.0, 0.0, -0.05]
        velocity_m_s = [0.2, 0.0, 0.0]
        [[body]]
        name = "parcel"
        kind = "dynamic"
        shape = "box"
        size_m = [0.2, 0.2, 0.2]
        mass_kg = 3.0
        position_m = [0.0, 0.0, 0.1]
    "#;
    let mut bench = Bench::new(scene);
    for _ in 0..200 {
        bench.turn();
    }
    let [table, parcel] = [0, 1].map(|index| bench.plant.poses().nth(index).expect("a body").position_m[0]);
    assert!((table - 0.4).abs() < 1e-12, "{table}");
    assert!(table - parcel > 0.0 && table - parcel < 0.02, "{parcel} slips while it gathers speed");
}

#[test]
fn bodies_of_one_group_pass_through_each_other() {
    let scene = |group: &str| {
        format!(
            r#"
            version = 1
            [[body]]
            name = "floor"
            kind = "fixed"
            shape = "box"
            size_m = [4.0, 4.0, 0.2]
            position_m = [0.0, 0.0, -0.1]
            group = "a"
            [[body]]
            name = "ball"
            kind = "dynamic"
            shape = "sphere"
            radius_m = 0.1
            mass_kg = 1.0
            position_m = [0.0, 0.0, 0.3]
            group = "{group}"
            "#
        )
    };
    let height_after = |group| {
        let mut bench = Bench::new(&scene(group));
        for _ in 0..100 {
            bench.turn();
        }
        height_m(&bench, "ball")
    };
    assert!(height_after("a") < -3.0);
    assert!((height_after("b") - 0.1).abs() < 0.01);
}
