//! Bodies that touch.

use super::Line;
use super::scenes::{G, bench, cube, joint, place, when};

const COULOMB: &str = "Coulomb";

pub(super) const FLOOR: &str = "[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [40.0, 4.0, 0.2]\n\
                     position_m = [0.0, 0.0, -0.1]\n";

pub(super) fn lines() -> Vec<Line> {
    let mut lines = slides();
    lines.extend(carries());
    lines
}

/// A floor that slopes by an angle down along x, with something on it, 0.05 m above, which may lie on its side, after a
/// second: its way.
pub(super) fn slope(angle_deg: f64, keys: &'static str, body: &'static str, lies: bool) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        let tilt = format!("rpy_deg = [0.0, {angle_deg:?}, 0.0]");
        let own = if lies { tilt.replace("[0.0,", "[90.0,") } else { tilt.clone() };
        let floor = format!(
            "[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [40.0, 4.0, 0.2]\n\
             position_m = [{:?}, 0.0, {:?}]\n{tilt}\n{keys}\n",
            -0.15 * sin,
            -0.15 * cos
        );
        let mut bench =
            bench(&format!("{floor}[[body]]\nname = \"a\"\nkind = \"dynamic\"\n{body}\n{own}\n{keys}\n"), step_us);
        bench.run_us(1_000_000);
        let [x, _, z] = place(&bench, "a");
        x * cos - z * sin
    }
}

fn slides() -> Vec<Line> {
    let stops = |step_us: u64| {
        let mut bench =
            bench(&format!("{FLOOR}{}", cube("a", [0.0, 0.0, 0.05], 2.0, "velocity_m_s = [2.0, 0.0, 0.0]")), step_us);
        bench.run_us(1_000_000);
        place(&bench, "a")[0]
    };
    let bounces = |step_us: u64| {
        let floor = FLOOR.replace("kind = \"fixed\"", "kind = \"fixed\"\nrestitution = 0.8");
        let ball = "[[body]]\nname = \"a\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.05\nmass_kg = 1.0\n\
                    position_m = [0.0, 0.0, 1.05]\nrestitution = 0.8\n";
        let mut bench = bench(&format!("{floor}{ball}"), step_us);
        bench.run_us(500_000);
        let mut highest: f64 = 0.0;
        for _ in 0..500_000 / step_us {
            bench.turn();
            highest = highest.max(place(&bench, "a")[2] - 0.05);
        }
        highest
    };
    let hits = |step_us: u64| {
        let ball = |name: &str, x: f64, v: f64| {
            format!(
                "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.05\nmass_kg = 1.0\n\
                 position_m = [{x:?}, 0.0, 0.0]\nrestitution = 1.0\nfriction = 0.0\nvelocity_m_s = [{v:?}, 0.0, 0.0]\n"
            )
        };
        let mut bench =
            bench(&format!("gravity_m_s2 = [0, 0, 0]\n{}{}", ball("a", 0.0, 1.0), ball("b", 0.6, 0.0)), step_us);
        bench.run_us(1_000_000);
        let before = place(&bench, "b")[0];
        bench.run_us(500_000);
        (place(&bench, "b")[0] - before) / 0.5
    };
    let (sin, cos) = libm::sincos(20.0_f64.to_radians());
    vec![
        Line::new("box on a floor from 2 m/s, friction 0.5: way", (4.0 / G, "m"), "v²/(2 µ g)", stops),
        Line::new(
            "box down a ramp of 20°, friction 0.2, way in 1 s",
            (0.5 * G * (sin - 0.2 * cos), "m"),
            COULOMB,
            slope(20.0, "friction = 0.2", "shape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\nmass_kg = 1.0", false),
        ),
        Line::new(
            "ball that rolls down a ramp of 20°, way in 1 s",
            (0.5 * 5.0 / 7.0 * G * sin, "m"),
            "5/7 g sin α",
            slope(20.0, "friction = 0.8", "shape = \"sphere\"\nradius_m = 0.05\nmass_kg = 1.0", false),
        ),
        Line::new("ball from 1 m, restitution 0.8: height after the bounce", (0.64, "m"), "e² h", bounces),
        Line::new(
            "ball at 1 m/s that hits an equal one, restitution 1: velocity of that",
            (1.0, "m/s"),
            "momentum and energy",
            hits,
        ),
    ]
}

/// The speed of a box of so many kilograms that a guided face with 1158 N has pushed for 0.5 s.
pub(super) fn pushed(kg: f64, face: &'static str) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let parts = format!(
            "{FLOOR}[[body]]\nname = \"load\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.4, 0.4, 0.4]\nmass_kg = {kg:?}\n\
             position_m = [0.25, 0.0, 0.2]\n{}{}[[fitting]]\nname = \"f\"\njoint = \"j\"\nbalance_n = 1158.0\n",
            cube("face", [0.0, 0.0, 0.2], 5.0, face),
            joint("j", "prismatic", "face", "[1, 0, 0]", "")
        );
        let mut bench = bench(&parts, step_us);
        bench.run_us(490_000);
        let before = place(&bench, "load")[0];
        bench.run_us(20_000);
        (place(&bench, "load")[0] - before) / 0.02
    }
}

fn carries() -> Vec<Line> {
    let carried = |step_us: u64| {
        let belt = "[[body]]\nname = \"belt\"\nkind = \"kinematic\"\nshape = \"box\"\nsize_m = [10.0, 0.5, 0.1]\n\
                    position_m = [0.0, 0.0, -0.05]\n[[axis]]\nname = \"m\"\nbelt = \"belt\"\ndirection = [1, 0, 0]\n\
                    drive = \"velocity\"\ncommand_signal = \"V\"\nspeed_m_s = 1.0\nacceleration_m_s2 = 1e6\n";
        let mut bench = bench(&format!("{belt}{}", cube("a", [0.0, 0.0, 0.05], 1.0, "")), step_us);
        bench.command("V", 0.5);
        bench.run_us(1_000_000);
        place(&bench, "a")[0]
    };
    let stacked = |step_us: u64| {
        let boxes: String =
            (0..5).map(|k| cube(&format!("b{k}"), [0.0, 0.0, 0.05 + 0.1 * f64::from(k)], 5.0, "")).collect();
        let mut bench = bench(&format!("{FLOOR}{boxes}"), step_us);
        bench.run_us(1_000_000);
        place(&bench, "b4")[2] + 0.05
    };
    let table = |step_us: u64| {
        let parts = format!(
            "[[body]]\nname = \"table\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.5\nlength_m = 0.1\nmass_kg = 20.0\n\
             position_m = [0.0, 0.0, -0.05]\n{}{}[[component]]\nname = \"m\"\nkind = \"turntable\"\njoint = \"j\"\n\
             speed_rad_s = 1.0\nrun = true\n",
            cube("a", [0.3, 0.0, 0.05], 0.3, ""),
            joint("j", "revolute", "table", "[0, 0, 1]", "")
        );
        let mut bench = bench(&parts, step_us);
        bench.run_us(2_000_000);
        let [x, y, _] = place(&bench, "a");
        x.hypot(y)
    };
    let falls = |step_us: u64| {
        let mut bench = bench(&format!("{FLOOR}{}", cube("a", [0.0, 0.0, 1.05], 1.0, "")), step_us);
        when(&mut bench, step_us, 2.0, |bench| 0.06 - place(bench, "a")[2])
    };
    let way = 0.5 - 0.25 / (2.0 * 0.5 * G);
    vec![
        Line::new("box put on a belt of 0.5 m/s, friction 0.5: way in 1 s", (way, "m"), "v t - v²/(2 µ g)", carried),
        Line::new("top of a stack of 5 boxes of 5 kg after 1 s", (0.5, "m"), "5 · 0.1 m", stacked),
        Line::new("part on a turntable of 1 rad/s after 2 s: radius", (0.3, "m"), "it does not slip", table),
        Line::new(
            "box that falls to a floor: time of the first 0.99 m",
            ((2.0 * 0.99 / G).sqrt(), "s"),
            "√(2 h/g)",
            falls,
        ),
        Line::new(
            "1158 N push 200 kg on a floor by a face without friction: speed after 0.5 s",
            (0.5 * (1158.0 - 100.0 * G) / 205.0, "m/s"),
            COULOMB,
            pushed(200.0, "friction = 0.0\nfriction_rule = \"least\""),
        ),
        Line::new(
            "the same by a face with friction 0.5",
            (0.5 * (1158.0 - 100.0 * G) / 205.0, "m/s"),
            COULOMB,
            pushed(200.0, ""),
        ),
    ]
}
