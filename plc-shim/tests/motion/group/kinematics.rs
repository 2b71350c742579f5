//! Axes to coordinates and back; moves of a SCARA and of a six-joint arm.

use std::sync::OnceLock;

use onescan_iec_run::Application;
use proptest::prelude::*;

use super::bench::{BLENDING_PREVIOUS, CORNER_DISTANCE, GroupState, apart, line, off_line, six, standby, state, trace};
use crate::bench::Bench;

/// Forward from `J`, and back from there to the answer that is nearest to `Near`.
const PROGRAM: &str = "PROGRAM P
    VAR
        A : AXIS_REF;
        G : AXES_GROUP_REF;
        J, Near, Back, There : ONESCAN_SIX;
        Place, Again : ONESCAN_PLACE;
        Found : WORD;
    END_VAR
    ONESCAN_Forward(AxesGroup := G, Joints := J, Place := Place);
    Back := Near;
    Found := ONESCAN_Backward(AxesGroup := G, Place := Place, Joints := Back);
    ONESCAN_Forward(AxesGroup := G, Joints := Back, Place := Again);
END_PROGRAM";

fn application() -> &'static Application {
    static APPLICATION: OnceLock<Application> = OnceLock::new();
    APPLICATION.get_or_init(|| {
        Application::from_sources([("kinematics.st", PROGRAM)]).unwrap_or_else(|found| panic!("{found}"))
    })
}

const SCARA: [(&str, f64); 3] = [("Kind", 1.0), ("L1", 0.4), ("L2", 0.3)];
const ARM: [(&str, f64); 7] =
    [("Kind", 2.0), ("A1", 0.15), ("D1", 0.45), ("A2", 0.6), ("A3", 0.1), ("D4", 0.62), ("D6", 0.1)];

fn set_kinematics(bench: &mut Bench, prefix: &str, values: &[(&str, f64)]) {
    for (name, value) in values {
        let path = format!("{prefix}.{name}");
        if *name == "Kind" { bench.set_int(&path, *value as i64) } else { bench.set_real(&path, *value) }
    }
}

fn solved(kinematics: &[(&str, f64)], joints: [f64; 6], near: [f64; 6]) -> Bench {
    let mut bench = Bench::on(application());
    set_kinematics(&mut bench, "G.Kinematics", kinematics);
    six(&mut bench, "J", &joints);
    six(&mut bench, "Near", &near);
    bench.scan();
    bench
}

fn read(bench: &Bench, path: &str, count: usize) -> Vec<f64> {
    (1..=count).map(|k| bench.real(&format!("{path}[{k}]"))).collect()
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The turns are the same: a quaternion and its negative mean one.
fn turned_alike(bench: &Bench) -> bool {
    let dot: f64 = (0..4).map(|k| bench.real(&format!("Place.Q[{k}]")) * bench.real(&format!("Again.Q[{k}]"))).sum();
    (dot.abs() - 1.0).abs() < 1e-11
}

/// Transformation matrices one after the other, as a textbook has them.
fn textbook(joints: &[f64; 6]) -> [f64; 3] {
    let [_, (_, a1), (_, d1), (_, a2), (_, a3), (_, d4), (_, d6)] = ARM;
    let about_y =
        |angle: f64, [x, y, z]: [f64; 3]| [x * angle.cos() + z * angle.sin(), y, z * angle.cos() - x * angle.sin()];
    let about_x =
        |angle: f64, [x, y, z]: [f64; 3]| [x, y * angle.cos() - z * angle.sin(), y * angle.sin() + z * angle.cos()];
    let about_z =
        |angle: f64, [x, y, z]: [f64; 3]| [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos(), z];
    let tool = about_y(joints[4], about_x(joints[5], [d6, 0.0, 0.0]));
    let wrist = about_x(joints[3], tool);
    let elbow = about_y(joints[2], [wrist[0] + d4, wrist[1], wrist[2] + a3]);
    let shoulder = about_y(joints[1], [elbow[0], elbow[1], elbow[2] + a2]);
    about_z(joints[0], [shoulder[0] + a1, shoulder[1], shoulder[2] + d1])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn an_arm_comes_back_to_its_own_joints(
        joints in prop::array::uniform6(-3.0..3.0_f64),
        off in prop::array::uniform6(-0.02..0.02_f64),
    ) {
        // Off the singular places: wrist, elbow, and the shoulder above the foot.
        prop_assume!(joints[4].sin().abs() > 0.2);
        let bend = joints[2] + 0.62_f64.atan2(0.1);
        prop_assume!(bend.sin().abs() > 0.2);
        let lean = joints[1] + joints[2];
        let away = 0.15 + 0.6 * joints[1].sin() + 0.1 * lean.sin() + 0.62 * lean.cos();
        prop_assume!(away.abs() > 0.2);
        let near = [0, 1, 2, 3, 4, 5].map(|k| joints[k] + off[k]);
        let bench = solved(&ARM, joints, near);
        prop_assert_eq!(bench.int("Found") & 0xffff, 0);
        let back = read(&bench, "Back", 6);
        prop_assert!(far(&back, &joints) < 1e-9, "{:?} {:?}", back, joints);
        prop_assert!(far(&read(&bench, "Place.C", 3), &textbook(&joints)) < 1e-12);
    }

    #[test]
    fn wherever_an_arm_comes_from_it_puts_the_tool_to_the_same_place(
        joints in prop::array::uniform6(-3.0..3.0_f64),
        near in prop::array::uniform6(-3.0..3.0_f64),
    ) {
        let bench = solved(&ARM, joints, near);
        // The lower half is the error.
        if bench.int("Found") % 0x1_0000 == 0 {
            prop_assert!(far(&read(&bench, "Again.C", 3), &read(&bench, "Place.C", 3)) < 1e-9);
            prop_assert!(turned_alike(&bench));
        }
    }

    #[test]
    fn a_scara_comes_back_to_its_own_joints(joints in prop::array::uniform4(-3.0..3.0_f64), off in -0.02..0.02_f64) {
        prop_assume!(joints[1].sin().abs() > 0.05);
        let joints = [joints[0], joints[1], joints[2], joints[3], 0.0, 0.0];
        let bench = solved(&SCARA, joints, joints.map(|each| if each == 0.0 { 0.0 } else { each + off }));
        prop_assert_eq!(bench.int("Found") & 0xffff, 0);
        prop_assert!(far(&read(&bench, "Back", 4), &joints[..4]) < 1e-9);
        let [a, b] = [joints[0], joints[0] + joints[1]];
        let place = read(&bench, "Place.C", 2);
        prop_assert!(far(&place, &[0.4 * a.cos() + 0.3 * b.cos(), 0.4 * a.sin() + 0.3 * b.sin()]) < 1e-12);
    }
}

/// A group with this kinematics and its axes at these positions.
fn robot(kinematics: &[(&str, f64)], axes: usize, joints: &[f64]) -> Bench {
    let mut bench = standby(axes);
    for k in 1..=axes {
        for (limit, value) in [("MaxVelocity", 3.0), ("MaxAcceleration", 30.0), ("MaxDeceleration", 30.0)] {
            bench.set_real(&format!("A[{k}].{limit}"), value);
        }
    }
    set_kinematics(&mut bench, "Kin.KinTransform", kinematics);
    bench.set("Kin.Execute", true);
    bench.scan();
    assert!(bench.get("Kin.Done"));
    line(&mut bench, "Direct", joints, &[("CoordSystem", 0.0)]);
    trace(&mut bench, "Direct.Done");
    bench
}

fn tool(bench: &Bench) -> [f64; 6] {
    [1, 2, 3, 4, 5, 6].map(|k| bench.real(&format!("ReadPosition.Position[{k}]")))
}

/// Scans until `output`; places of the tool, and the greatest velocity of an axis.
fn moved(bench: &mut Bench, axes: usize, output: &str) -> (Vec<[f64; 6]>, f64) {
    let (mut places, mut fastest) = (Vec::new(), 0.0_f64);
    for _ in 0..20_000 {
        bench.scan();
        places.push(tool(bench));
        for k in 1..=axes {
            fastest = fastest.max(bench.real(&format!("A[{k}].SetVelocity")).abs());
        }
        if bench.get(output) {
            bench.scan();
            return (places, fastest);
        }
    }
    panic!("{output} stays FALSE");
}

#[test]
fn a_scara_moves_in_lines_and_arcs() {
    let mut bench = robot(&SCARA, 4, &[0.3, 1.2, 0.1, 0.0]);
    bench.set_int("ReadPosition.CoordSystem", 1);
    bench.scan();
    let start = tool(&bench);
    let goal = [0.1, 0.5, 0.2, 1.0];
    line(&mut bench, "Linear", &goal, &[("Velocity", 0.5), ("CoordSystem", 1.0)]);
    let (places, _) = moved(&mut bench, 4, "Linear.Done");
    let three = |at: &[f64]| [at[0], at[1], at[2]];
    for at in &places {
        assert!(off_line(three(at), three(&start), three(&goal)) < 1e-12);
    }
    assert!(far(&tool(&bench), &[0.1, 0.5, 0.2, 1.0, 0.0, 0.0]) < 1e-12);
    six(&mut bench, "Circular.AuxPoint", &[0.0, 0.4, 0.2]);
    six(&mut bench, "Circular.EndPoint", &[0.1, 0.3, 0.2, 1.0]);
    bench.start("Circular", &[("Velocity", 0.3), ("CoordSystem", 1.0)]);
    let (places, _) = moved(&mut bench, 4, "Circular.Done");
    assert!(places.iter().all(|at| ((at[0] - 0.1).hypot(at[1] - 0.4) - 0.1).abs() < 1e-9));
    // Beyond its arms, and through the place where it is straight.
    line(&mut bench, "Linear2", &[0.8, 0.0, 0.2], &[("Velocity", 0.5), ("CoordSystem", 1.0)]);
    bench.scan();
    assert_eq!(bench.int("Linear2.ErrorID"), 0x29);
}

/// Out of a place where the flange points down: one line with a turn, a curve, another one.
#[test]
fn an_arm_moves_its_tool_in_lines_and_around_corners_while_it_turns() {
    let mut bench = robot(&ARM, 6, &[0.2, 0.3, 0.4, 0.1, 0.9, -0.2]);
    bench.set_int("ReadPosition.CoordSystem", 1);
    bench.scan();
    let start = tool(&bench);
    let corner = [0.6, 0.3, 0.5, 3.0, 0.1, 0.4];
    let goal = [0.7, -0.3, 0.4, 3.1, -0.1, 0.2];
    let values =
        [("Velocity", 0.4), ("Acceleration", 2.0), ("Deceleration", 2.0), ("Jerk", 30.0), ("CoordSystem", 1.0)];
    line(&mut bench, "Linear", &corner, &values);
    bench.scan();
    assert_eq!(bench.int("Linear.ErrorID"), 0);
    six(&mut bench, "Linear2.TransitionParameter", &[0.1]);
    let blended = [&values[..], &[("BufferMode", BLENDING_PREVIOUS), ("TransitionMode", CORNER_DISTANCE)]].concat();
    line(&mut bench, "Linear2", &goal, &blended);
    let (places, fastest) = moved(&mut bench, 6, "Linear2.Done");
    let three = |at: &[f64]| [at[0], at[1], at[2]];
    let corner3 = three(&corner);
    let mut inside = 0;
    for at in &places {
        if apart(three(at), corner3) > 0.1 + 1e-9 {
            let off = off_line(three(at), three(&start), corner3).min(off_line(three(at), corner3, three(&goal)));
            assert!(off < 1e-9, "{at:?} is {off} m off");
        } else {
            inside += 1;
        }
    }
    assert!(inside > 20 && fastest <= 3.0 * 1.02, "{inside} {fastest}");
    assert!(far(&tool(&bench), &goal) < 1e-9, "{:?}", tool(&bench));
}

#[test]
fn an_arm_reports_what_it_cannot_reach_and_singular_ways() {
    let mut bench = robot(&ARM, 6, &[0.0, 0.3, 0.4, 0.0, 0.9, 0.0]);
    for (goal, expected) in
        [([1.8, 0.0, 0.5, 3.0, 0.0, 0.0], 0x29), ([0.0, 0.0, 1.0, std::f64::consts::PI, 0.0, 0.0], 0x2a)]
    {
        line(&mut bench, "Linear", &goal, &[("Velocity", 0.4), ("CoordSystem", 1.0)]);
        bench.scan();
        let found = bench.int("Linear.ErrorID");
        assert!(bench.get("Linear.Error") && (found == expected || found == 0x29), "{goal:?}: {found:#x}");
        assert_eq!(state(&bench), GroupState::Standby);
        bench.set("Linear.Execute", false);
        bench.scan();
    }
    // From a straight wrist no line begins, but a direct move does.
    line(&mut bench, "DirectRelative", &[0.0, 0.0, 0.0, 0.0, -0.9, 0.0], &[("CoordSystem", 0.0)]);
    trace(&mut bench, "DirectRelative.Done");
    line(&mut bench, "Relative", &[0.0, 0.0, -0.1], &[("Velocity", 0.1), ("CoordSystem", 1.0)]);
    bench.scan();
    assert_eq!(bench.int("Relative.ErrorID"), 0x2a);
}
