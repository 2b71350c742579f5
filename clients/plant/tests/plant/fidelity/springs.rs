//! Springs, dampers, friction, brakes and stops of joints.

use super::scenes::{G, bench, cube, joint, place, turned};
use super::{Line, curves};

/// Ten periods of 2 π/20 s, to the nearest 10 ms.
const TEN_PERIODS_US: u64 = 3_140_000;
const HIBBELER: &str = "Hibbeler, *Dynamics*";

pub(super) fn lines() -> Vec<Line> {
    let mut lines = sprung();
    lines.extend(braked());
    lines.extend(falling());
    lines
}

/// Where 1 kg is that a fitting moves along x, from 50 mm, after ten periods of 20 rad/s.
fn from_50_mm(fitting: &'static str) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let at = cube("a", [0.05, 0.0, 0.0], 1.0, "");
        let slide = joint("j", "prismatic", "a", "[1, 0, 0]", "initial_m = 0.05");
        let text = format!("{at}{slide}[[fitting]]\nname = \"f\"\njoint = \"j\"\nspring_n_m = 400.0\n{fitting}\n");
        let mut bench = bench(&format!("gravity_m_s2 = [0, 0, 0]\n{text}"), step_us);
        if fitting.contains("Free") {
            bench.command("Free", true);
        }
        bench.run_us(TEN_PERIODS_US);
        place(&bench, "a")[0]
    }
}

/// The greatest distance from rest of 1 kg on a spring of 2000 rad/s, in the last of two tenths of a second, from 1 mm.
fn stiff(step_us: u64) -> f64 {
    let at = cube("a", [0.001, 0.0, 0.0], 1.0, "");
    let slide = joint("j", "prismatic", "a", "[1, 0, 0]", "initial_m = 0.001");
    let fitting = "[[fitting]]\nname = \"f\"\njoint = \"j\"\nspring_n_m = 4e6\nfriction_n = 0.001\n";
    let mut bench = bench(&format!("gravity_m_s2 = [0, 0, 0]\n{at}{slide}{fitting}"), step_us);
    bench.run_us(100_000);
    let mut most: f64 = 0.0;
    for _ in 0..100_000 / step_us {
        bench.turn();
        most = most.max(1e3 * place(&bench, "a")[0].abs());
    }
    most
}

/// The greatest distance of two masses from where their spring is at rest, in the last tenth of two seconds, from 10 mm.
fn two_masses(step_us: u64) -> f64 {
    let mut bench = super::mechanics::masses_on_a_spring(step_us);
    bench.run_us(1_500_000);
    let mut most: f64 = 0.0;
    for _ in 0..500_000 / step_us {
        bench.turn();
        most = most.max(1e3 * (place(&bench, "b")[0] - place(&bench, "a")[0] - 0.99).abs());
    }
    most
}

fn torsion(step_us: u64) -> f64 {
    let wheel = "[[body]]\nname = \"w\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.1\nlength_m = 0.05\nmass_kg = 2.0\n";
    let fitting = "[[fitting]]\nname = \"f\"\njoint = \"j\"\nspring_nm_rad = 4.0\n";
    let hinge = joint("j", "revolute", "w", "[0, 0, 1]", "initial_rad = 0.5");
    let mut bench = bench(&format!("{wheel}{hinge}{fitting}"), step_us);
    bench.run_us(TEN_PERIODS_US);
    0.5 + turned(&bench, "w", 2)
}

/// How far 2 kg have gone along an axis after a time, with a fitting.
fn fitted(axis: &'static str, fitting: &'static str, keys: &'static str, time_us: u64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let guide = joint("j", "prismatic", "a", axis, "");
        let fitting = format!("[[fitting]]\nname = \"f\"\njoint = \"j\"\n{fitting}\n");
        let mut bench = bench(&format!("{}{guide}{fitting}", cube("a", [0.0; 3], 2.0, keys)), step_us);
        bench.run_us(time_us);
        let [x, _, z] = place(&bench, "a");
        x + z
    }
}

fn sprung() -> Vec<Line> {
    let t = 1e-6 * TEN_PERIODS_US as f64;
    let swing = 0.05 * libm::cos(20.0 * t);
    let damped = |d: f64| {
        let w = (400.0 - d * d).sqrt();
        0.05 * libm::exp(-d * t) * (libm::cos(w * t) + d / w * libm::sin(w * t))
    };
    vec![
        Line::new(
            "1 kg on 400 N/m with 1e-6 N of friction, from 50 mm, after 10 periods",
            (swing - 20.0 * 0.5e-8, "m"),
            "4 F/k less each period",
            from_50_mm("friction_n = 1e-6"),
        ),
        Line::new(
            "the same with a brake of 100 N that is released",
            (swing, "m"),
            "x₀ cos ω t",
            from_50_mm("brake_n = 100.0\nrelease_signal = \"Free\""),
        ),
        Line::new(
            "the same with 0.4 N·s/m and 1e-6 N of friction",
            (damped(0.2), "m"),
            HIBBELER,
            from_50_mm("damping_n_s_m = 0.4\nfriction_n = 1e-6"),
        ),
        Line::new(
            "the same with 4 N·s/m (a tenth of critical)",
            (damped(2.0), "m"),
            HIBBELER,
            from_50_mm("damping_n_s_m = 4.0"),
        ),
        Line::new(
            "wheel of 0.01 kg·m² on 4 N·m/rad, from 0.5 rad, after 10 periods",
            (10.0 * swing, "rad"),
            "φ₀ cos ω t",
            torsion,
        ),
        Line::new(
            "spring of 2000 rad/s with 0.001 N of friction, from 1 mm: amplitude after 0.1 s",
            (1.0, "mm"),
            "energy",
            stiff,
        ),
        Line::new("two masses of 24.66 Hz, from 10 mm: amplitude after 1.5 s", (10.0, "mm"), "energy", two_masses),
        Line::new(
            "2 kg that hang on 1000 N/m with 40 N·s/m: how far down after 2 s",
            (2.0 * G / 1000.0 * (1.0 - curves::step_of_second_order(500.0_f64.sqrt(), 10.0, 2.0)), "m"),
            "m g/k",
            fitted("[0, 0, -1]", "spring_n_m = 1000.0\ndamping_n_s_m = 40.0", "", 2_000_000).negated(),
        ),
    ]
}

/// The same number the other way up.
trait Negated {
    fn negated(self) -> impl Fn(u64) -> f64;
}

impl<F: Fn(u64) -> f64> Negated for F {
    fn negated(self) -> impl Fn(u64) -> f64 {
        move |step_us| -self(step_us)
    }
}

fn braked() -> Vec<Line> {
    let hoist = |step_us: u64| {
        let fitting = "[[fitting]]\nname = \"f\"\njoint = \"j\"\nbrake_n = 3000.0\n";
        let load = cube("a", [0.0; 3], 100.0, "velocity_m_s = [0.0, 0.0, -1.0]");
        let mut bench = bench(&format!("{load}{}{fitting}", joint("j", "prismatic", "a", "[0, 0, 1]", "")), step_us);
        bench.run_us(500_000);
        -place(&bench, "a")[2]
    };
    let stops = |step_us: u64| {
        let wheel = "[[body]]\nname = \"w\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.1\nlength_m = 0.05\nmass_kg = 2.0\n";
        let hinge = joint("j", "revolute", "w", "[0, 0, 1]", "lower_rad = -1.0\nupper_rad = 30.0");
        let more = "[[fitting]]\nname = \"f\"\njoint = \"j\"\nbalance_nm = 0.5\n[[component]]\nname = \"e\"\nkind = \"axis_encoder\"\n\
                    joint = \"j\"\nposition_signal = \"Out\"\n";
        let mut bench = bench(&format!("{wheel}{hinge}{more}"), step_us);
        bench.run_us(1_500_000);
        bench.read("Out")
    };
    vec![
        Line::new(
            "gas spring of 30 N below 2 kg, way up in 1 s",
            (0.5 * (15.0 - G), "m"),
            HIBBELER,
            fitted("[0, 0, 1]", "balance_n = 30.0", "", 1_000_000),
        ),
        Line::new(
            "2 kg from 2 m/s in oil of 4 N·s/m, way in 1 s",
            (1.0 - libm::exp(-2.0), "m"),
            "m v/d (1 - exp(-d t/m))",
            fitted("[1, 0, 0]", "damping_n_s_m = 4.0", "velocity_m_s = [2.0, 0.0, 0.0]", 1_000_000),
        ),
        Line::new(
            "9 N on 2 kg against 10 N of friction at rest, 5 N in motion: way in 1 s",
            (0.0, "m"),
            "Coulomb",
            fitted("[1, 0, 0]", "friction_n = 5.0\nstiction_n = 10.0\nbalance_n = 9.0", "", 1_000_000),
        ),
        Line::new(
            "brake of 3000 N on a hoist with 100 kg, from 1 m/s down: way",
            (0.5 / (30.0 - G), "m"),
            HIBBELER,
            hoist,
        ),
        Line::new(
            "wheel with 0.5 N·m between stops 31 rad apart: where it comes to rest",
            (30.0, "rad"),
            "4.93 turns",
            stops,
        ),
    ]
}

/// Two bars of 1 m and 1 kg, let go from the horizontal: how low the middle of the second is after 0.5 s.
fn double_pendulum(step_us: u64) -> f64 {
    let bar = |name: &str, x_m: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [1.0, 0.05, 0.05]\nmass_kg = 1.0\n\
             position_m = [{x_m:?}, 0.0, 0.0]\ncollides = false\n"
        )
    };
    let elbow = "[[joint]]\nname = \"k\"\nkind = \"revolute\"\nparent = \"a\"\nchild = \"b\"\naxis = [0, 1, 0]\nanchor_m = [1, 0, 0]\n";
    let shoulder = joint("j", "revolute", "a", "[0, 1, 0]", "anchor_m = [0, 0, 0]");
    let mut bench = bench(&format!("{}{}{shoulder}{elbow}", bar("a", 0.5), bar("b", 1.5)), step_us);
    bench.run_us(500_000);
    -place(&bench, "b")[2]
}

/// The same by Lagrange's equations of two bars, in angles below the horizontal.
fn double_pendulum_ode() -> f64 {
    let own = (1.0 + 0.05 * 0.05) / 12.0;
    let rates = |state: &[f64; 4]| {
        let [a, b, u, w] = *state;
        let (sin, cos) = libm::sincos(a - b);
        let (m11, m12, m22) = (own + 0.25 + 1.0, 0.5 * cos, own + 0.25);
        let f1 = G * 1.5 * libm::cos(a) - 0.5 * sin * w * w;
        let f2 = G * 0.5 * libm::cos(b) + 0.5 * sin * u * u;
        let det = m11 * m22 - m12 * m12;
        [u, w, (m22 * f1 - m12 * f2) / det, (m11 * f2 - m12 * f1) / det]
    };
    let [a, b, ..] = curves::runge_kutta([0.0; 4], 0.5, 5_000, |_, state| rates(state));
    libm::sin(a) + 0.5 * libm::sin(b)
}

fn falling() -> Vec<Line> {
    let bar = |step_us: u64| {
        let body = "[[body]]\nname = \"a\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [1.0, 0.02, 0.02]\nmass_kg = 1.0\n\
                    position_m = [0.5, 0.0, 0.0]\n";
        let hinge = joint("j", "revolute", "a", "[0, 1, 0]", "anchor_m = [0, 0, 0]");
        let mut bench = bench(&format!("{body}{hinge}"), step_us);
        bench.run_us(500_000);
        turned(&bench, "a", 1)
    };
    let inertia = (1.0 + 0.02 * 0.02) / 12.0 + 0.25;
    let [angle, _] = curves::runge_kutta([0.0, 0.0], 0.5, 5_000, |_, y| [y[1], 0.5 * G * libm::cos(y[0]) / inertia]);
    vec![
        Line::new(
            "bar of 1 m that falls about its end from the horizontal, angle after 0.5 s",
            (angle, "rad"),
            "own integration",
            bar,
        ),
        Line::new(
            "double pendulum of two such bars, how low the second is after 0.5 s",
            (double_pendulum_ode(), "m"),
            "Lagrange, own integration",
            double_pendulum,
        ),
    ]
}
