//! Linkages: closed loops of joints, driven and not.

use super::Line;
use super::scenes::{bench, cube, joint, place, turned};
use crate::fidelity::mechanisms::drive;
use crate::four_bar::FourBar;

const LINKAGE: FourBar = FourBar { crank_m: 0.15, coupler_m: 0.4, rocker_m: 0.3, apart_m: 0.4, start_rad: 1.2 };

/// The angle of its crank after a time.
fn four_bar(time_us: u64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let mut bench = bench(&LINKAGE.parts(), step_us);
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
            (LINKAGE.falls(0.3), "rad"),
            "one freedom, own integration",
            four_bar(300_000),
        ),
        Line::new(
            "the same after 0.6 s",
            (LINKAGE.falls(0.6), "rad"),
            "one freedom, own integration",
            four_bar(600_000),
        ),
    ]
}
