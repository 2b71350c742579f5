//! Forces and torques of drives that move arms and loads.

use super::Line;
use super::mechanisms::drive;
use super::scenes::{G, bench, cube, joint};

const LAGRANGE: &str = "Lagrange (Craig, *Robotics*, ch. 6)";

pub(super) fn lines() -> Vec<Line> {
    let mut lines = arms();
    lines.extend(boom());
    lines.extend(held());
    lines
}

/// A link of an arm along x, with its middle there.
fn link(name: &str, x: f64, length: f64, kg: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [{length:?}, 0.06, 0.06]\nmass_kg = {kg:?}\n\
         position_m = [{x:?}, 0.0, 0.0]\ncollides = false\n"
    )
}

/// An arm of 0.4 m with 4 kg and 0.3 m with 3 kg, and 1 kg at its tip; both joints turn about an axis.
fn arm(axis: &str, axes: &str) -> String {
    let elbow = format!(
        "[[joint]]\nname = \"k\"\nkind = \"revolute\"\nparent = \"upper\"\nchild = \"lower\"\naxis = {axis}\nanchor_m = [0.4, 0, 0]\n"
    );
    let flange = "[[joint]]\nname = \"flange\"\nkind = \"fixed\"\nparent = \"lower\"\nchild = \"load\"\n";
    link("upper", 0.2, 0.4, 4.0)
        + &link("lower", 0.55, 0.3, 3.0)
        + &cube("load", [0.7, 0.0, 0.0], 1.0, "collides = false")
        + &joint("j", "revolute", "upper", axis, "anchor_m = [0, 0, 0]")
        + &elbow
        + flange
        + axes
}

/// Both torques of that arm at these angles from straight, velocities and accelerations; its joints stand upright.
fn torques(elbow_rad: f64, [u, w]: [f64; 2], [a, b]: [f64; 2]) -> [f64; 2] {
    let own = |length: f64, kg: f64| kg * (length * length + 0.06 * 0.06) / 12.0;
    let (i1, i2, load) = (own(0.4, 4.0), own(0.3, 3.0), 0.1 * 0.1 / 6.0);
    let (sin, cos) = libm::sincos(elbow_rad);
    let far = i2 + 3.0 * 0.15 * 0.15 + load + 0.3 * 0.3;
    let between = 0.4 * (3.0 * 0.15 + 0.3);
    let m11 = i1 + 4.0 * 0.2 * 0.2 + 0.4 * 0.4 * 4.0 + far + 2.0 * between * cos;
    let m12 = far + between * cos;
    let coriolis = between * sin;
    [m11 * a + m12 * b - coriolis * (2.0 * u * w + w * w), m12 * a + far * b + coriolis * u * u]
}

fn ramp(joint: &str) -> String {
    format!(
        "[[axis]]\nname = \"m_{joint}\"\njoint = \"{joint}\"\ndrive = \"velocity\"\ncommand_signal = \"V_{joint}\"\nspeed_rad_s = 100.0\n\
         acceleration_rad_s2 = 4.0\ntorque_signal = \"M_{joint}\"\n"
    )
}

fn hold(joint: &str) -> String {
    format!(
        "[[axis]]\nname = \"m_{joint}\"\njoint = \"{joint}\"\ndrive = \"position\"\ncommand_signal = \"V_{joint}\"\nspeed_rad_s = 1.0\n\
         acceleration_rad_s2 = 1.0\ntorque_signal = \"M_{joint}\"\n"
    )
}

fn arms() -> Vec<Line> {
    let scara = |signal: &'static str| {
        move |step_us: u64| {
            let mut bench = bench(&arm("[0, 0, 1]", &(ramp("j") + &ramp("k"))), step_us);
            bench.command("V_j", 50.0);
            bench.command("V_k", 50.0);
            bench.run_us(100_000);
            bench.read(signal)
        }
    };
    let stands = |signal: &'static str| {
        move |step_us: u64| {
            let mut bench = bench(&arm("[0, -1, 0]", &(hold("j") + &hold("k"))), step_us);
            bench.run_us(200_000);
            bench.read(signal)
        }
    };
    // 4 rad/s² for 0.1 s
    let [shoulder, elbow] = torques(0.02, [0.4, 0.4], [4.0, 4.0]);
    vec![
        Line::new(
            "SCARA with 1 kg, both axes with 4 rad/s²: torque of the first after 0.1 s",
            (shoulder, "N·m"),
            LAGRANGE,
            scara("M_j"),
        ),
        Line::new("the same: torque of the second", (elbow, "N·m"), LAGRANGE, scara("M_k")),
        Line::new(
            "the same arm upright, held level: torque of the shoulder",
            (G * (4.0 * 0.2 + 3.0 * 0.55 + 0.7), "N·m"),
            "Σ m g x",
            stands("M_j"),
        ),
        Line::new("the same: torque of the elbow", (G * (3.0 * 0.15 + 0.3), "N·m"), "Σ m g x", stands("M_k")),
    ]
}

/// A boom at 2 rad/s, on which a slider of 3 kg goes out with 0.2 m/s from 0.5 m; what a drive says after 0.5 s.
fn on_boom(signal: &'static str) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let slide =
            "[[joint]]\nname = \"s\"\nkind = \"prismatic\"\nparent = \"boom\"\nchild = \"slider\"\naxis = [1, 0, 0]\n";
        let parts = link("boom", 0.0, 0.4, 2.0)
            + &cube("slider", [0.5, 0.0, 0.0], 3.0, "collides = false")
            + &joint("t", "revolute", "boom", "[0, 0, 1]", "")
            + slide
            + &drive("t", "rad", "torque_signal = \"Torque\"")
            + &drive("s", "m", "force_signal = \"Force\"");
        let mut bench = bench(&format!("gravity_m_s2 = [0, 0, 0]\n{parts}"), step_us);
        bench.command("V_t", 2.0);
        bench.command("V_s", 0.2);
        bench.run_us(500_000);
        bench.read(signal)
    }
}

fn boom() -> Vec<Line> {
    vec![
        Line::new(
            "slider of 3 kg that goes out at 0.2 m/s on a boom of 2 rad/s, 0.6 m from its axis: torque",
            (2.0 * 3.0 * 0.6 * 0.2 * 2.0, "N·m"),
            "Coriolis, 2 m r v ω",
            on_boom("Torque"),
        ),
        Line::new("the same: force of the slider's drive", (-3.0 * 4.0 * 0.6, "N"), "m ω² r", on_boom("Force")),
    ]
}

/// A hand of 5 kg with a box of 4 kg or 2 kg that it grips, along an axis with 4 m/s²; what a signal says meanwhile.
fn gripped(axis: &'static str, kg: f64, holder: &'static str, signal: &'static str) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let motor = "[[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"velocity\"\ncommand_signal = \"V\"\nspeed_m_s = 10.0\n\
                     acceleration_m_s2 = 4.0\nforce_signal = \"Force\"\n";
        let grip = format!(
            "[[component]]\nname = \"h\"\nbody = \"hand\"\ntargets = [\"box\"]\nload_n_signal = \"Load\"\n{holder}\n"
        );
        let parts = cube("hand", [0.0; 3], 5.0, "collides = false")
            + &cube("box", [0.0, 0.0, -0.09], kg, "")
            + "[[body]]\nname = \"table\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [1.0, 1.0, 0.1]\nposition_m = [0.0, 0.0, -0.19]\nfriction = 0.0\n"
            + &joint("j", "prismatic", "hand", axis, "")
            + motor
            + &grip;
        let mut bench = bench(&parts, step_us);
        bench.run_us(1_000_000);
        bench.command("V", 10.0);
        bench.run_us(300_000);
        bench.read(signal)
    }
}

fn held() -> Vec<Line> {
    let jaws = "kind = \"gripper\"\nclose = true\njaw_n = 1000";
    let cup = "kind = \"vacuum_cup\"\non = true\ndiameter_m = 0.06\ndirection = [0, 0, -1]";
    vec![
        Line::new(
            "hand of 5 kg with a gripped box of 4 kg, up with 4 m/s²: force of its drive",
            (9.0 * (G + 4.0), "N"),
            "m (g + a)",
            gripped("[0, 0, 1]", 4.0, jaws, "Force"),
        ),
        Line::new(
            "the same: what the grip has to hold",
            (4.0 * (G + 4.0), "N"),
            "m (g + a)",
            gripped("[0, 0, 1]", 4.0, jaws, "Load"),
        ),
        Line::new(
            "vacuum cup with 2 kg, up with 4 m/s²: what it has to hold",
            (2.0 * (G + 4.0), "N"),
            "m (g + a)",
            gripped("[0, 0, 1]", 2.0, cup, "Load"),
        ),
    ]
}
