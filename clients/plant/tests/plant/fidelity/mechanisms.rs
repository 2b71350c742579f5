//! Gears, cams, screws, linkages.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::fmt::Write as _;

use super::scenes::{G, bench, cube, joint, pendulum_s, place, turned, when};
use super::{Line, linkage};
use crate::bench::Bench;

const MESSAGE: &str = "d'Alembert";

pub(super) fn lines() -> Vec<Line> {
    let mut lines = gears();
    lines.extend(cams());
    lines.extend(screw());
    lines.extend(belts());
    lines.extend(linkage::lines());
    lines
}

/// A wheel of 0.01 kg·m² about z on joint `name` at a place along x.
pub(super) fn wheel(name: &str, x: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.1\nlength_m = 0.05\nmass_kg = 2.0\n\
         position_m = [{x:?}, 0.0, 0.0]\ncollides = false\n{}",
        joint(name, "revolute", name, "[0, 0, 1]", "")
    )
}

/// A drive with a velocity of a joint, without ramps.
pub(super) fn drive(joint: &str, unit: &str, keys: &str) -> String {
    format!(
        "[[axis]]\nname = \"m_{joint}\"\njoint = \"{joint}\"\ndrive = \"velocity\"\ncommand_signal = \"V_{joint}\"\n\
         speed_{unit}_s = 100.0\nacceleration_{unit}_s2 = 1e6\n{keys}\n"
    )
}

fn couple(led: &str, of: &str, law: &str) -> String {
    format!("[[coupling]]\nname = \"c_{led}\"\njoint = \"{led}\"\nof = {of}\n{law}\n")
}

fn weight(joint: &str, key: &str, value: f64) -> String {
    format!("[[fitting]]\nname = \"f_{joint}\"\njoint = \"{joint}\"\n{key} = {value:?}\n")
}

fn run(parts: &str, commands: &[(&str, f64)], time_us: u64, step_us: u64) -> Bench {
    let mut bench = bench(parts, step_us);
    for (signal, value) in commands {
        bench.command(signal, *value);
    }
    bench.run_us(time_us);
    bench
}

fn gears() -> Vec<Line> {
    let pulley = |step_us: u64| {
        let mut parts = format!("{}{}", cube("a", [0.0; 3], 3.0, ""), cube("b", [1.0, 0.0, 0.0], 2.0, ""));
        parts += &joint("j", "prismatic", "a", "[0, 0, -1]", "");
        parts += &joint("k", "prismatic", "b", "[0, 0, -1]", "");
        parts +=
            &(wheel("p", 2.0) + &couple("k", "[\"j\"]", "ratio = [-1.0]") + &couple("p", "[\"j\"]", "ratio = [10.0]"));
        -place(&run(&parts, &[], 1_000_000, step_us), "a")[2]
    };
    let block = |step_us: u64| {
        let mut parts = format!("{}{}", cube("a", [0.0; 3], 4.0, ""), cube("b", [1.0, 0.0, 0.0], 1.0, ""));
        parts += &joint("j", "prismatic", "a", "[0, 0, -1]", "");
        parts += &joint("k", "prismatic", "b", "[0, 0, -1]", "");
        parts += &couple("j", "[\"k\"]", "ratio = [-0.5]");
        place(&run(&parts, &[], 1_000_000, step_us), "b")[2]
    };
    let rack = |step_us: u64| {
        let mut parts =
            wheel("w", 1.0) + &cube("a", [0.0; 3], 5.0, "") + &joint("j", "prismatic", "a", "[1, 0, 0]", "");
        parts += &(couple("j", "[\"w\"]", "ratio = [0.1]") + &weight("w", "balance_nm", 1.2));
        place(&run(&parts, &[], 1_000_000, step_us), "a")[0]
    };
    let differential = |step_us: u64| {
        let mut parts = wheel("a", 0.0) + &wheel("b", 1.0) + &wheel("c", 2.0);
        parts +=
            &(couple("c", "[\"a\", \"b\"]", "ratio = [0.5, 0.5]") + &drive("a", "rad", "") + &drive("b", "rad", ""));
        turned(&run(&parts, &[("V_a", 2.0), ("V_b", -1.0)], 1_000_000, step_us), "c", 2)
    };
    let geared = |step_us: u64| {
        let mut parts =
            cube("a", [1.0, 0.0, 0.0], 1.0, "") + &joint("j", "revolute", "a", "[0, 1, 0]", "anchor_m = [0, 0, 0]");
        parts += &(wheel("w", 3.0) + &couple("w", "[\"j\"]", "ratio = [3.0]"));
        let mut bench = bench(&parts, step_us);
        4.0 * when(&mut bench, step_us, 10.0, |bench| -place(bench, "a")[0])
    };
    let arm = 1.0 + 0.01 / 6.0;
    vec![
        Line::new(
            "Atwood machine of 3 and 2 kg over a pulley of 0.01 kg·m² and 0.1 m, way in 1 s",
            (0.5 * G / 6.0, "m"),
            MESSAGE,
            pulley,
        ),
        Line::new("1 kg that lifts 4 kg by a block of two ropes, way up in 1 s", (0.25 * G, "m"), MESSAGE, block),
        Line::new(
            "1.2 N·m on a pinion of 0.1 m and 0.01 kg·m² with a rack of 5 kg, way in 1 s",
            (1.0, "m"),
            MESSAGE,
            rack,
        ),
        Line::new(
            "differential between 2 and -1 rad/s, angle of the carrier after 1 s",
            (0.5, "rad"),
            "(φ₁ + φ₂)/2",
            differential,
        ),
        Line::new(
            "pendulum of 1 m on a gear 1:3 with a flywheel of 0.01 kg·m², period at 90°",
            (pendulum_s(TAU * ((arm + 0.09) / G).sqrt(), FRAC_PI_2), "s"),
            "elliptic integral",
            geared,
        ),
    ]
}

/// The angle of a Geneva wheel of four slots, from where the pin enters it, for a crank that is so far beyond the middle.
fn geneva_rad(crank_rad: f64) -> f64 {
    let ratio = libm::sin(FRAC_PI_4);
    let (sin, cos) = libm::sincos(crank_rad);
    libm::atan2(ratio * sin, 1.0 - ratio * cos) + FRAC_PI_4
}

/// A Geneva wheel as a cam of 65 points, of which 49 are of the quarter of a turn in which the pin is in a slot.
fn geneva(time_us: u64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let mut points = String::new();
        for k in 0..16 {
            write!(points, "[{:?}, 0.0], ", 1.5 * PI / 16.0 * f64::from(k)).expect("a text");
        }
        for k in 0..=48 {
            let crank = FRAC_PI_4 * (f64::from(k) / 24.0 - 1.0);
            write!(points, "[{:?}, {:?}], ", 1.75 * PI + crank, geneva_rad(crank)).expect("a text");
        }
        let mut parts = wheel("a", 0.0) + &wheel("b", 1.0) + &drive("a", "rad", "");
        parts += &couple("b", "[\"a\"]", &format!("cam = [{points}]\ncam_repeats = true"));
        let turned = turned(&run(&parts, &[("V_a", TAU)], time_us, step_us), "b", 2);
        if turned < 0.0 { turned + TAU } else { turned }
    }
}

fn cams() -> Vec<Line> {
    let crank = 0.05 * PI;
    let source = "Bickford, *Mechanisms for Intermittent Motion*";
    vec![
        Line::new(
            "Geneva wheel of 4 slots (cam of 65 points), 9° beyond its middle",
            (geneva_rad(crank), "rad"),
            source,
            geneva(900_000),
        ),
        Line::new(
            "the same in its second turn of the crank",
            (FRAC_PI_2 + geneva_rad(crank), "rad"),
            source,
            geneva(1_900_000),
        ),
        Line::new("the same at rest between", (FRAC_PI_2, "rad"), source, geneva(1_400_000)),
    ]
}

/// A screw of 10 mm with a play of 0.5 mm that moves 50 kg along an axis, with more for the slide.
fn screw_of(axis: &str, more: &str) -> String {
    wheel("s", 1.0)
        + &cube("a", [0.0; 3], 50.0, "")
        + &joint("j", "prismatic", "a", axis, "")
        + &couple("j", "[\"s\"]", "ratio = [0.0015915494309189536]\nbacklash_m = 0.0005")
        + &drive("s", "rad", "torque_signal = \"Torque\"")
        + more
}

fn screw() -> Vec<Line> {
    // ten turns in a second
    let command = [("V_s", 20.0 * PI)];
    let up = move |step_us: u64| place(&run(&screw_of("[0, 0, 1]", ""), &command, 1_000_000, step_us), "a")[2];
    let torque = move |step_us: u64| run(&screw_of("[0, 0, 1]", ""), &command, 1_000_000, step_us).read("Torque");
    let back = move |step_us: u64| {
        let more = weight("j", "friction_n", 20.0);
        let mut bench = run(&screw_of("[1, 0, 0]", &more), &command, 1_000_000, step_us);
        bench.command("V_s", -20.0 * PI);
        bench.run_us(500_000);
        place(&bench, "a")[0]
    };
    vec![
        Line::new(
            "screw of 10 mm with a play of 0.5 mm, 10 turns up with 50 kg: height",
            (0.1 - 0.000_25, "m"),
            "the lower flank carries",
            up,
        ),
        Line::new("the same: torque of the screw", (50.0 * G * 0.01 / TAU, "N·m"), "m g p/(2 π)", torque),
        Line::new(
            "the same level with friction, 10 turns forth and 5 back",
            (0.05 + 0.000_25, "m"),
            "the other flank carries",
            back,
        ),
    ]
}

fn belts() -> Vec<Line> {
    let clutch = |time_us: u64| {
        move |step_us: u64| {
            let mut parts = wheel("a", 0.0) + &wheel("b", 1.0) + &drive("a", "rad", "");
            parts += &(couple("b", "[\"a\"]", "ratio = [1.0]\nslip_nm = 0.2")
                + "[[component]]\nname = \"e\"\nkind = \"axis_encoder\"\njoint = \"b\"\nposition_signal = \"Out\"\n");
            run(&parts, &[("V_a", 20.0)], time_us, step_us).read("Out")
        }
    };
    let slip_n = 100.0 * (1.0 - libm::exp(-0.3 * PI));
    let capstan = move |step_us: u64| {
        let mut parts =
            wheel("w", 1.0) + &cube("a", [0.0; 3], 10.0, "") + &joint("j", "prismatic", "a", "[1, 0, 0]", "");
        parts += &(couple("j", "[\"w\"]", &format!("ratio = [0.1]\nslip_n = {slip_n:?}")) + &drive("w", "rad", ""));
        place(&run(&parts, &[("V_w", 50.0)], 500_000, step_us), "a")[0]
    };
    vec![
        Line::new(
            "clutch that slips at 0.2 N·m, from a wheel of 20 rad/s to one of 0.01 kg·m²: angle of that after 0.8 s",
            (6.4, "rad"),
            "M t²/(2 J)",
            clutch(800_000),
        ),
        Line::new(
            "the same after 2 s, when it does not slip any more",
            (30.0, "rad"),
            "M t²/(2 J), then ω t",
            clutch(2_000_000),
        ),
        Line::new(
            "flat belt of 100 N that slips on a pulley (µ = 0.3, half a turn) and pulls 10 kg: way in 0.5 s",
            (0.125 * slip_n / 10.0, "m"),
            "Euler-Eytelwein (capstan)",
            capstan,
        ),
    ]
}
