//! An arm of six joints: falling, and driven along a path by position drives.

use std::fmt::Write as _;

use crate::bench::Bench;

/// Name, where its joint is, the joint's axis, its box (length along x) and mass; greatest torque.
type Link = (&'static str, f64, [f64; 3], f64, f64, f64);

const LINKS: [Link; 6] = [
    ("turret", 0.0, [0.0, 0.0, 1.0], 0.2, 20.0, 300.0),
    ("upper", 0.2, [0.0, 1.0, 0.0], 0.4, 15.0, 600.0),
    ("fore", 0.6, [0.0, 1.0, 0.0], 0.3, 8.0, 300.0),
    ("roll", 0.9, [1.0, 0.0, 0.0], 0.1, 3.0, 60.0),
    ("pitch", 1.0, [0.0, 1.0, 0.0], 0.1, 2.0, 60.0),
    ("flange", 1.1, [1.0, 0.0, 0.0], 0.05, 1.0, 20.0),
];

/// The arm, stretched out along x. With `drives` each joint has a position drive.
fn arm(drives: bool, strong: bool) -> String {
    let mut scene = "version = 1\n".to_owned();
    let mut parent = "ground";
    for (name, x_m, [ax, ay, az], length_m, kg, torque_nm) in LINKS {
        let centre_m = x_m + 0.5 * length_m;
        write!(
            scene,
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [{length_m}, 0.1, 0.1]\n\
             mass_kg = {kg:?}\nposition_m = [{centre_m}, 0.0, 1.0]\ngroup = \"arm\"\n\
             [[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"{parent}\"\nchild = \"{name}\"\n\
             anchor_m = [{x_m}, 0.0, 1.0]\naxis = [{ax:?}, {ay:?}, {az:?}]\n"
        )
        .expect("a text takes it");
        if drives {
            let torque = if strong { String::new() } else { format!("torque_max_nm = {torque_nm:?}\n") };
            write!(
            scene,
                "[[axis]]\nname = \"{name}\"\njoint = \"{name}\"\ndrive = \"position\"\ncommand_signal = \"to_{name}\"\n\
                 speed_rad_s = 1.5\nacceleration_rad_s2 = 6.0\nposition_signal = \"at_{name}\"\n\
                 torque_signal = \"torque_{name}\"\n{torque}"
            ).expect("a text takes it");
        }
        parent = name;
    }
    if drives {
        scene += GRIPPER;
    }
    scene
}

/// A box of 5 kg at the flange, and what grips it.
const GRIPPER: &str = r#"
    [[body]]
    name = "part"
    kind = "dynamic"
    shape = "box"
    size_m = [0.1, 0.1, 0.1]
    mass_kg = 5.0
    position_m = [1.19, 0.0, 1.0]
    group = "arm"
    [[component]]
    name = "gripper"
    kind = "gripper"
    body = "flange"
    targets = ["part"]
    stroke_s = 0.001
    jaw_n = 2000.0
    close_signal = "close"
    holding_signal = "holding"
"#;

/// The drives by themselves: each joint alone, without gravity, moves as its setpoint does.
fn setpoints() -> String {
    let mut scene = "version = 1\ngravity_m_s2 = [0.0, 0.0, 0.0]\n".to_owned();
    for (name, ..) in LINKS {
        write!(
            scene,
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.1\nmass_kg = 1.0\n\
             collides = false\n\
             [[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"ground\"\nchild = \"{name}\"\n\
             axis = [0.0, 0.0, 1.0]\n\
             [[axis]]\nname = \"{name}\"\njoint = \"{name}\"\ndrive = \"position\"\ncommand_signal = \"to_{name}\"\n\
             speed_rad_s = 1.5\nacceleration_rad_s2 = 6.0\nposition_signal = \"at_{name}\"\n"
        )
        .expect("a text takes it");
    }
    scene
}

fn angles(bench: &Bench) -> [f64; 6] {
    LINKS.map(|(name, ..)| bench.read(&format!("at_{name}")))
}

#[test]
fn a_falling_arm_converges_by_the_fourth_power_of_the_step() {
    let scene = arm(false, true);
    let flange = |period_us: u64| {
        let mut bench = Bench::at_us(&scene, period_us);
        bench.run_us(1_000_000);
        bench.plant.poses().last().expect("a flange").position_m
    };
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    let exact = flange(250);
    let errors = [4_000, 2_000, 1_000].map(|period_us| apart(flange(period_us), exact));
    assert!(errors[2] < 1e-4, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((8.0..32.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn position_drives_follow_their_path_under_load() {
    const TARGETS: [[f64; 6]; 2] = [[1.0, -0.6, 0.9, 0.7, -0.8, 1.5], [-0.4, 0.5, -0.3, -1.0, 0.6, -2.0]];
    for (strong, grips) in [(true, false), (true, true), (false, false), (false, true)] {
        let (mut arm, mut drives) = (Bench::at_us(&arm(true, strong), 10_000), Bench::at_us(&setpoints(), 10_000));
        arm.command("close", grips);
        for target in TARGETS {
            for (k, (name, ..)) in LINKS.into_iter().enumerate() {
                arm.command(&format!("to_{name}"), target[k]);
                drives.command(&format!("to_{name}"), target[k]);
            }
            for k in 0..400 {
                arm.turn();
                drives.turn();
                assert!(k == 0 || arm.read::<bool>("holding") == grips);
                let off = (0..6).map(|i| (angles(&arm)[i] - angles(&drives)[i]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-3, "{strong} {grips} {k}: {off} rad on the way");
            }
            let rest = (0..6).map(|i| (angles(&arm)[i] - target[i]).abs()).fold(0.0, f64::max);
            assert!(rest < 1e-9, "{strong} {grips}: {rest} rad at rest");
        }
        let weight_nm: f64 = arm.read("torque_upper");
        assert!(weight_nm.abs() > 50.0, "{weight_nm} holds the arm");
    }
}

#[test]
fn a_drive_reports_the_weight_that_it_holds() {
    for period_us in [100, 1_000, 10_000] {
        let mut bench = Bench::at_us(&arm(true, true), period_us);
        let centre = |k: usize| LINKS[k].1 + 0.5 * LINKS[k].3;
        for (grips, part_kg) in [(false, 0.0), (true, 5.0)] {
            bench.command("close", grips);
            bench.run_us(100_000);
            // stretched out: the moment of all weights beyond the joint at 0.2 m, down about +y
            let moment: f64 = (1..6).map(|k| LINKS[k].4 * (centre(k) - 0.2)).sum();
            let moment_nm = -9.81 * (moment + part_kg * (1.19 - 0.2));
            let torque_nm: f64 = bench.read("torque_upper");
            assert!((torque_nm / moment_nm - 1.0).abs() < 1e-6, "{period_us} {grips}: {torque_nm} {moment_nm}");
        }
    }
}
