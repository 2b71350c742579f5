//! Linkages: closed loops of joints, which the engine moves.

use super::scenes::{G, bench, cube, joint, place, turned};
use super::{Line, curves};
use crate::fidelity::mechanisms::drive;

/// The pivots of a four-bar: both on the ground, both ends of the coupler at the start.
const GROUND: [[f64; 2]; 2] = [[0.0, 0.0], [0.4, 0.0]];
const CRANK_M: f64 = 0.15;
const COUPLER_M: f64 = 0.4;
const ROCKER_M: f64 = 0.3;
/// Where the crank begins, above x.
const START_RAD: f64 = 1.2;
/// Kilograms of the three bars.
const BARS_KG: [f64; 3] = [1.0, 2.0, 1.5];
const THICK_M: f64 = 0.02;

/// Both ends of the coupler for an angle of the crank.
fn ends(crank_rad: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = libm::sincos(crank_rad);
    let b = [CRANK_M * cos, CRANK_M * sin];
    let to = [GROUND[1][0] - b[0], GROUND[1][1] - b[1]];
    let d = to[0].hypot(to[1]);
    let along = (COUPLER_M * COUPLER_M - ROCKER_M * ROCKER_M + d * d) / (2.0 * d);
    let across = (COUPLER_M * COUPLER_M - along * along).sqrt();
    [b, [b[0] + (along * to[0] - across * to[1]) / d, b[1] + (along * to[1] + across * to[0]) / d]]
}

/// The three bars for an angle of the crank.
fn bars(crank_rad: f64) -> [[[f64; 2]; 2]; 3] {
    let [b, c] = ends(crank_rad);
    [[GROUND[0], b], [b, c], [GROUND[1], c]]
}

/// What the four-bar resists with for an angle of its crank, and its potential energy.
fn inertia_and_height(crank_rad: f64) -> (f64, f64) {
    let apart = 1e-5;
    let (before, after, now) = (bars(crank_rad - apart), bars(crank_rad + apart), bars(crank_rad));
    let middle = |[a, b]: [[f64; 2]; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let heading = |[a, b]: [[f64; 2]; 2]| libm::atan2(b[1] - a[1], b[0] - a[0]);
    let (mut inertia, mut energy) = (0.0, 0.0);
    for (k, kg) in BARS_KG.into_iter().enumerate() {
        let length = (now[k][1][0] - now[k][0][0]).hypot(now[k][1][1] - now[k][0][1]);
        let own = kg * (length * length + THICK_M * THICK_M) / 12.0;
        let (from, to) = (middle(before[k]), middle(after[k]));
        let per = |difference: f64| difference / (2.0 * apart);
        let moved = per(to[0] - from[0]).hypot(per(to[1] - from[1]));
        let turned = per(heading(after[k]) - heading(before[k]));
        inertia += kg * moved * moved + own * turned * turned;
        energy += kg * G * middle(now[k])[1];
    }
    (inertia, energy)
}

/// The crank's angle after a time, by the equation of one freedom.
fn four_bar_ode(time_s: f64) -> f64 {
    let apart = 1e-4;
    let rates = |y: &[f64; 2]| {
        let ((below, low), (above, high)) = (inertia_and_height(y[0] - apart), inertia_and_height(y[0] + apart));
        let (slope, force) = ((above - below) / (2.0 * apart), (high - low) / (2.0 * apart));
        [y[1], -(0.5 * slope * y[1] * y[1] + force) / inertia_and_height(y[0]).0]
    };
    let angle = curves::runge_kutta([START_RAD, 0.0], time_s, 2_000, |_, y| rates(y))[0];
    // as it is read off where the crank is
    libm::atan2(libm::sin(angle), libm::cos(angle))
}

fn four_bar(time_us: u64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let bar = |name: &str, [a, b]: [[f64; 2]; 2], kg: f64| {
            let (x, z) = (b[0] - a[0], b[1] - a[1]);
            format!(
                "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [{:?}, {THICK_M}, {THICK_M}]\n\
                 mass_kg = {kg:?}\nposition_m = [{:?}, 0.0, {:?}]\nrpy_deg = [0.0, {:?}, 0.0]\ncollides = false\n",
                x.hypot(z),
                0.5 * (a[0] + b[0]),
                0.5 * (a[1] + b[1]),
                -libm::atan2(z, x).to_degrees()
            )
        };
        let pin = |name: &str, parent: &str, child: &str, at: [f64; 2]| {
            format!(
                "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"{parent}\"\nchild = \"{child}\"\naxis = [0, 1, 0]\n\
                 anchor_m = [{:?}, 0.0, {:?}]\n",
                at[0], at[1]
            )
        };
        let [crank, coupler, rocker] = bars(START_RAD);
        let parts = bar("crank", crank, BARS_KG[0])
            + &bar("coupler", coupler, BARS_KG[1])
            + &bar("rocker", rocker, BARS_KG[2])
            + &pin("p1", "ground", "crank", GROUND[0])
            + &pin("p2", "crank", "coupler", coupler[0])
            + &pin("p3", "ground", "rocker", GROUND[1])
            + &pin("p4", "rocker", "coupler", coupler[1]);
        let mut bench = bench(&parts, step_us);
        bench.run_us(time_us);
        let [x, _, z] = place(&bench, "crank");
        libm::atan2(z, x)
    }
}

/// A crank of 0.1 m that moves a yoke of 1 kg along x, against 10 N, at 1 rad/s for a second.
fn yoke(step_us: u64) -> crate::bench::Bench {
    let own = "collides = false";
    let parts = format!(
        "gravity_m_s2 = [0, 0, 0]\n{}{}{}{}{}\
         [[joint]]\nname = \"pin\"\nkind = \"slot\"\nparent = \"yoke\"\nchild = \"crank\"\naxis = [0, 0, 1]\nslide = [0, 1, 0]\n\
         anchor_m = [0.1, 0, 0]\n[[fitting]]\nname = \"f\"\njoint = \"s\"\nbalance_n = -10.0\n",
        cube("crank", [0.0; 3], 1.0, own),
        cube("yoke", [0.1, 0.0, 0.0], 1.0, own),
        joint("j", "revolute", "crank", "[0, 0, 1]", ""),
        joint("s", "prismatic", "yoke", "[1, 0, 0]", ""),
        drive("j", "rad", "torque_signal = \"Torque\""),
    );
    let mut bench = bench(&parts, step_us);
    bench.command("V_j", 1.0);
    bench.run_us(1_000_000);
    bench
}

fn fast_crank(step_us: u64) -> f64 {
    let rod = "[[body]]\nname = \"rod\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.3, 0.02, 0.02]\nmass_kg = 0.5\n\
               position_m = [0.25, 0.0, 0.0]\ncollides = false\n";
    let own = "collides = false";
    let parts = format!(
        "gravity_m_s2 = [0, 0, 0]\n{}{rod}{}{}{}{}\
         [[joint]]\nname = \"pin\"\nkind = \"revolute\"\nparent = \"crank\"\nchild = \"rod\"\naxis = [0, 0, 1]\nanchor_m = [0.1, 0, 0]\n\
         [[joint]]\nname = \"wrist\"\nkind = \"revolute\"\nparent = \"slider\"\nchild = \"rod\"\naxis = [0, 0, 1]\nanchor_m = [0.4, 0, 0]\n",
        cube("crank", [0.0; 3], 1.0, own),
        cube("slider", [0.4, 0.0, 0.0], 1.0, own),
        joint("j", "revolute", "crank", "[0, 0, 1]", ""),
        joint("s", "prismatic", "slider", "[1, 0, 0]", ""),
        drive("j", "rad", ""),
    );
    let mut bench = bench(&parts, step_us);
    bench.command("V_j", 10.0);
    bench.run_us(200_000);
    turned(&bench, "crank", 2)
}

pub(super) fn lines() -> Vec<Line> {
    let (sin, cos) = libm::sincos(1.0);
    let place_of = |step_us: u64| place(&yoke(step_us), "yoke")[0];
    let torque = |step_us: u64| yoke(step_us).read("Torque");
    vec![
        Line::new("slider-crank at 10 rad/s, angle of the crank after 0.2 s", (2.0, "rad"), "ω t", fast_crank),
        Line::new("scotch yoke of 0.1 m at 1 rad/s, place after 1 s", (0.1 * cos, "m"), "r cos φ", place_of),
        Line::new(
            "the same: torque of the crank against 10 N on 1 kg",
            ((0.1 * cos - 10.0) * 0.1 * sin, "N·m"),
            "virtual work",
            torque,
        ),
        Line::new(
            "four-bar (0.15, 0.4, 0.3, 0.4 m) that falls: angle of the crank after 0.3 s",
            (four_bar_ode(0.3), "rad"),
            "one freedom, own integration",
            four_bar(300_000),
        ),
        Line::new(
            "the same after 0.6 s",
            (four_bar_ode(0.6), "rad"),
            "one freedom, own integration",
            four_bar(600_000),
        ),
    ]
}
