//! Joints, springs, couplings.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Line;
use super::scenes::{G, bench, crossings, cube, joint, pendulum_s, place, turned, when};

const HIBBELER: &str = "Hibbeler, *Dynamics*";
const MESSAGE: &str = "d'Alembert";

/// Ten periods of 2 π/20 s, to the nearest 10 ms.
const TEN_PERIODS_US: u64 = 3_140_000;

pub(super) fn falls() -> Vec<Line> {
    let guided = |step_us| {
        let mut bench = bench(
            &format!("{}{}", cube("a", [0.0; 3], 2.0, ""), joint("j", "prismatic", "a", "[0, 0, -1]", "")),
            step_us,
        );
        bench.run_us(1_000_000);
        -place(&bench, "a")[2]
    };
    let free = |step_us| {
        let mut bench = bench(&cube("a", [0.0; 3], 2.0, ""), step_us);
        bench.run_us(1_000_000);
        -place(&bench, "a")[2]
    };
    let inclined = |step_us| {
        let fitting = "[[fitting]]\nname = \"f\"\njoint = \"j\"\nfriction_n = 5.0\n";
        let slope = joint("j", "prismatic", "a", "[0.8660254037844386, 0, -0.5]", "");
        let mut bench = bench(&format!("{}{slope}{fitting}", cube("a", [0.0; 3], 2.0, "")), step_us);
        bench.run_us(1_000_000);
        -place(&bench, "a")[2] / 0.5
    };
    let stopped = |step_us| {
        let fitting = "[[fitting]]\nname = \"f\"\njoint = \"j\"\nfriction_n = 3.0\n";
        let keys = "velocity_m_s = [2.0, 0.0, 0.0]";
        let mut bench = bench(
            &format!("{}{}{fitting}", cube("a", [0.0; 3], 2.0, keys), joint("j", "prismatic", "a", "[1, 0, 0]", "")),
            step_us,
        );
        bench.run_us(2_000_000);
        place(&bench, "a")[0]
    };
    vec![
        Line::new("fall on a vertical guide, way in 1 s", (0.5 * G, "m"), "g t²/2", guided),
        Line::new("free fall, way in 1 s", (0.5 * G, "m"), "g t²/2", free),
        Line::new(
            "slide down a guide of 30° against 5 N of friction, 2 kg, way in 1 s",
            (0.5 * (0.5 * G - 2.5), "m"),
            HIBBELER,
            inclined,
        ),
        Line::new("way until 3 N of friction stop 2 kg from 2 m/s", (4.0 / 3.0, "m"), "m v²/(2 F)", stopped),
    ]
}

/// Masses of 1 and 3 kg on a spring between them, 10 mm from where it is at rest.
pub(super) fn masses_on_a_spring(step_us: u64) -> crate::bench::Bench {
    let parts = format!(
        "{}{}{}[[joint]]\nname = \"k\"\nkind = \"prismatic\"\nparent = \"a\"\nchild = \"b\"\naxis = [1, 0, 0]\ninitial_m = 0.01\n\
         [[fitting]]\nname = \"f\"\njoint = \"k\"\nspring_n_m = 18000.0\n",
        cube("a", [0.0, 0.0, 0.0], 1.0, ""),
        cube("b", [1.0, 0.0, 0.0], 3.0, ""),
        joint("j", "prismatic", "a", "[1, 0, 0]", ""),
    );
    bench(&format!("gravity_m_s2 = [0, 0, 0]\n{parts}"), step_us)
}

fn two_masses(step_us: u64) -> f64 {
    let mut bench = masses_on_a_spring(step_us);
    let apart = |bench: &crate::bench::Bench| place(bench, "b")[0] - place(bench, "a")[0] - 0.99;
    20.0 / crossings(&mut bench, step_us, 21, apart)
}

pub(super) fn swings() -> Vec<Line> {
    // a thin bob at 1 m: the cube's own inertia counts
    let arm = 1.0 + 0.01 / 6.0;
    let period = |amplitude_rad: f64| {
        move |step_us: u64| {
            let (sin, cos) = libm::sincos(amplitude_rad);
            let bob =
                cube("a", [sin, 0.0, -cos], 1.0, &format!("rpy_deg = [0.0, {:?}, 0.0]", -amplitude_rad.to_degrees()));
            let hinge = joint("j", "revolute", "a", "[0, 1, 0]", "anchor_m = [0, 0, 0]");
            let mut bench = bench(&format!("{bob}{hinge}"), step_us);
            2.0 * when(&mut bench, step_us, 10.0, |bench| -place(bench, "a")[0]) * 2.0
        }
    };
    let sprung = |damping: f64, friction: f64| {
        move |step_us: u64| {
            let fitting = format!(
                "[[fitting]]\nname = \"f\"\njoint = \"j\"\nspring_n_m = 400.0\ndamping_n_s_m = {damping:?}\nfriction_n = {friction:?}\n"
            );
            let at = cube("a", [0.05, 0.0, 0.0], 1.0, "");
            let slide = joint("j", "prismatic", "a", "[1, 0, 0]", "initial_m = 0.05");
            let mut bench = bench(&format!("gravity_m_s2 = [0, 0, 0]\n{at}{slide}{fitting}"), step_us);
            bench.run_us(TEN_PERIODS_US);
            place(&bench, "a")[0]
        }
    };
    let frequency = (18_000.0_f64 / 0.75).sqrt() / (2.0 * PI);
    let t = 1e-6 * TEN_PERIODS_US as f64;
    let damped = 0.05 * libm::exp(-0.2 * t) * {
        let w = (400.0_f64 - 0.04).sqrt();
        libm::cos(w * t) + 0.2 / w * libm::sin(w * t)
    };
    vec![
        Line::new(
            "pendulum of 1 m, period at an amplitude of 5°",
            (pendulum_s(2.0 * PI * (arm / G).sqrt(), 5.0_f64.to_radians()), "s"),
            "elliptic integral",
            period(5.0_f64.to_radians()),
        ),
        Line::new(
            "pendulum of 1 m, period at an amplitude of 90°",
            (pendulum_s(2.0 * PI * (arm / G).sqrt(), FRAC_PI_2), "s"),
            "elliptic integral",
            period(FRAC_PI_2),
        ),
        Line::new(
            "spring and mass of 20 rad/s, from 50 mm, after 10 periods",
            (0.05 * libm::cos(20.0 * t), "m"),
            "x₀ cos ω t",
            sprung(0.0, 0.0),
        ),
        Line::new("the same with a damper of 0.4 N·s/m", (damped, "m"), HIBBELER, sprung(0.4, 0.0)),
        Line::new(
            "the same with 0.1 N of dry friction",
            (0.05 * libm::cos(20.0 * t) - 20.0 * 0.5e-3, "m"),
            "4 F/k less each period",
            sprung(0.0, 0.1),
        ),
        Line::new(
            "two masses of 1 and 3 kg and a spring, frequency over 20 swings",
            (frequency, "Hz"),
            "√(k/m_red)",
            two_masses,
        ),
    ]
}

fn atwood(step_us: u64) -> f64 {
    let parts = format!(
        "{}{}{}{}[[coupling]]\nname = \"rope\"\njoint = \"k\"\nof = [\"j\"]\nratio = [-1.0]\n",
        cube("a", [0.0; 3], 3.0, ""),
        cube("b", [1.0, 0.0, 0.0], 2.0, ""),
        joint("j", "prismatic", "a", "[0, 0, -1]", ""),
        joint("k", "prismatic", "b", "[0, 0, -1]", ""),
    );
    let mut bench = bench(&parts, step_us);
    bench.run_us(1_000_000);
    -place(&bench, "a")[2]
}

fn geared(step_us: u64) -> f64 {
    let wheel = |name: &str, x: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.1\nlength_m = 0.05\n\
             mass_kg = 2.0\nposition_m = [{x:?}, 0.0, 0.0]\n"
        )
    };
    let parts = format!(
        "{}{}{}{}[[coupling]]\nname = \"gear\"\njoint = \"j\"\nof = [\"k\"]\nratio = [3.0]\n\
         [[fitting]]\nname = \"weight\"\njoint = \"k\"\nbalance_nm = 0.3\n",
        wheel("a", 0.0),
        wheel("b", 1.0),
        joint("j", "revolute", "a", "[0, 0, 1]", ""),
        joint("k", "revolute", "b", "[0, 0, 1]", ""),
    );
    let mut bench = bench(&parts, step_us);
    bench.run_us(1_000_000);
    turned(&bench, "b", 2)
}

fn geneva(step_us: u64) -> f64 {
    // dwells for three quarters of a turn, and indexes by a quarter with a cycloid
    let points: Vec<String> = (0..=64)
        .map(|k| {
            let part = f64::from(k) / 64.0;
            let t = (4.0 * part - 3.0).max(0.0);
            format!("[{:?}, {:?}]", 2.0 * PI * part, FRAC_PI_2 * (t - libm::sin(2.0 * PI * t) / (2.0 * PI)))
        })
        .collect();
    let parts = format!(
        "{}{}{}{}[[coupling]]\nname = \"cam\"\njoint = \"k\"\nof = [\"j\"]\ncam = [{}]\ncam_repeats = true\n\
         [[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"velocity\"\ncommand_signal = \"V\"\nspeed_rad_s = 100.0\n\
         acceleration_rad_s2 = 1e6\n",
        cube("a", [0.0; 3], 1.0, ""),
        cube("b", [1.0, 0.0, 0.0], 1.0, ""),
        joint("j", "revolute", "a", "[0, 0, 1]", ""),
        joint("k", "revolute", "b", "[0, 0, 1]", ""),
        points.join(", ")
    );
    let mut bench = bench(&parts, step_us);
    bench.command("V", 2.0 * PI);
    bench.run_us(1_100_000);
    turned(&bench, "b", 2)
}

fn crank(step_us: u64) -> f64 {
    let rod = "[[body]]\nname = \"rod\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.3, 0.02, 0.02]\nmass_kg = 0.5\n\
               position_m = [0.25, 0.0, 0.0]\ncollides = false\n";
    let own = "collides = false";
    let parts = format!(
        "gravity_m_s2 = [0, 0, 0]\n{}{rod}{}{}{}\
         [[joint]]\nname = \"pin\"\nkind = \"revolute\"\nparent = \"crank\"\nchild = \"rod\"\naxis = [0, 0, 1]\nanchor_m = [0.1, 0, 0]\n\
         [[joint]]\nname = \"wrist\"\nkind = \"revolute\"\nparent = \"slider\"\nchild = \"rod\"\naxis = [0, 0, 1]\nanchor_m = [0.4, 0, 0]\n\
         [[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"velocity\"\ncommand_signal = \"V\"\nspeed_rad_s = 100.0\n\
         acceleration_rad_s2 = 1e3\n",
        cube("crank", [0.0; 3], 1.0, own),
        cube("slider", [0.4, 0.0, 0.0], 1.0, own),
        joint("j", "revolute", "crank", "[0, 0, 1]", ""),
        joint("s", "prismatic", "slider", "[1, 0, 0]", ""),
    );
    let mut bench = bench(&parts, step_us);
    bench.command("V", 5.0);
    bench.run_us(500_000);
    // where the slider is, for the angle that the crank has
    let angle = turned(&bench, "crank", 2);
    let (sin, cos) = libm::sincos(angle);
    place(&bench, "slider")[0] - (0.1 * cos + (0.09 - 0.01 * sin * sin).sqrt()) + 0.3
}

pub(super) fn couplings() -> Vec<Line> {
    let wheel_kg_m2 = 0.5 * 2.0 * 0.01;
    vec![
        Line::new("Atwood machine of 3 and 2 kg, way in 1 s", (0.5 * G / 5.0, "m"), MESSAGE, atwood),
        Line::new(
            "0.3 N·m on a gear 1:3 between two wheels, angle in 1 s",
            (0.5 * 0.3 / (10.0 * wheel_kg_m2), "rad"),
            MESSAGE,
            geared,
        ),
        Line::new("indexer (periodic cam) at 1 turn/s, angle after 1.1 s", (FRAC_PI_2, "rad"), "cycloid", geneva),
        Line::new(
            "slider-crank at 5 rad/s, 0.3 m and how far the slider is off its place",
            (0.3, "m"),
            "r cos φ + √(l² - r² sin² φ)",
            crank,
        ),
    ]
}
