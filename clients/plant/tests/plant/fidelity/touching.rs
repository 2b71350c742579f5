//! What touches, and what passes close by.

use super::contacts::{FLOOR, pushed, slope};
use super::scenes::{G, bench, cube, joint, place, turned};
use super::{Line, curves};

const COULOMB: &str = "Coulomb";
/// Why a domino is inexact.
const EDGE: &str =
    "the engine lets friction act in the middle of the points of a contact, of which two are still in the air here";

pub(super) fn lines() -> Vec<Line> {
    let mut lines = pushes();
    lines.extend(edges());
    lines.extend(tables());
    lines.extend(rolls());
    lines.extend(hits());
    lines.extend(guides());
    lines
}

fn pushes() -> Vec<Line> {
    // the face has friction as all bodies have it
    let row = |what: &'static str, kg: f64| {
        let exact = (0.5 * (1158.0 - 0.5 * kg * G) / (5.0 + kg)).max(0.0);
        Line::new(what, (exact, "m/s"), COULOMB, pushed(kg, ""))
    };
    vec![
        row("1158 N push 50 kg on a floor: speed after 0.5 s", 50.0),
        row("the same with 100 kg", 100.0),
        row("the same with 150 kg", 150.0),
        row("the same with 230 kg", 230.0),
        row("the same with 240 kg, which friction holds", 240.0),
    ]
}

/// A fixed box from x = 0 on, whose top is at z = 0.
const LEDGE: &str = "[[body]]\nname = \"ledge\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [4.0, 1.0, 0.1]\nposition_m = [2.0, 0.0, -0.05]\n";

fn edges() -> Vec<Line> {
    let flies = |axis: usize| {
        move |step_us: u64| {
            let body = cube("a", [-0.2, 0.0, 0.055], 1.0, "velocity_m_s = [1.0, 0.0, 0.0]");
            let mut bench = bench(&format!("gravity_m_s2 = [0, 0, 0]\n{LEDGE}{body}"), step_us);
            bench.run_us(300_000);
            place(&bench, "a")[axis]
        }
    };
    let pushes = |step_us: u64| {
        let body = cube("a", [-0.2, 0.0, 0.055], 5.0, "");
        let fitting = "[[fitting]]\nname = \"f\"\njoint = \"j\"\nbalance_n = 50.0\n";
        let parts = format!("{LEDGE}{body}{}{fitting}", joint("j", "prismatic", "a", "[1, 0, 0]", ""));
        let mut bench = bench(&parts, step_us);
        bench.run_us(500_000);
        place(&bench, "a")[0]
    };
    vec![
        Line::new(
            "box at 1 m/s that clears an edge by 5 mm, after 0.3 s: height",
            (0.055, "m"),
            "it does not touch",
            flies(2),
        ),
        Line::new("the same: way", (0.1, "m"), "v t", flies(0)),
        Line::new(
            "guided box with 50 N on 5 kg that clears it by 5 mm, after 0.5 s: place",
            (1.05, "m"),
            "F t²/(2 m)",
            pushes,
        )
        .because("at 10 ms, in which it moves by more than its clearance when it passes the edge"),
    ]
}

/// The radius of a part, 0.3 m from the axis at the start, on a table after two seconds.
fn carried(drive: &'static str, command: f64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let parts = format!(
            "[[body]]\nname = \"table\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.5\nlength_m = 0.1\nmass_kg = 20.0\n\
             position_m = [0.0, 0.0, -0.05]\n{}{}{drive}",
            cube("a", [0.3, 0.0, 0.05], 0.3, ""),
            joint("j", "revolute", "table", "[0, 0, 1]", "")
        );
        let mut bench = bench(&parts, step_us);
        if command != 0.0 {
            bench.command("V", command);
        }
        bench.run_us(2_000_000);
        let [x, y, _] = place(&bench, "a");
        x.hypot(y)
    }
}

fn tables() -> Vec<Line> {
    let slow = "[[component]]\nname = \"m\"\nkind = \"turntable\"\njoint = \"j\"\nspeed_rad_s = 0.5\nrun = true\n";
    let fast = "[[component]]\nname = \"m\"\nkind = \"turntable\"\njoint = \"j\"\nspeed_rad_s = 2.0\nrun = true\n";
    let axis = "[[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"velocity\"\ncommand_signal = \"V\"\nspeed_rad_s = 5.0\nacceleration_rad_s2 = 4.0\n";
    let stays = "it does not slip";
    vec![
        Line::new("part on a turntable of 0.5 rad/s after 2 s: radius", (0.3, "m"), stays, carried(slow, 0.0)),
        Line::new("the same at 2 rad/s", (0.3, "m"), stays, carried(fast, 0.0)),
        Line::new("the same on a table that an `[[axis]]` turns, 1 rad/s", (0.3, "m"), stays, carried(axis, 1.0)),
    ]
}

/// A belt up a slope of 20° at 0.5 m/s, with a box put on it: its way up in so many seconds.
fn incline(friction: f64, time_us: u64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let (sin, cos) = libm::sincos(20.0_f64.to_radians());
        let tilt = format!("rpy_deg = [0.0, -20.0, 0.0]\nfriction = {friction:?}");
        let belt = format!(
            "[[body]]\nname = \"belt\"\nkind = \"kinematic\"\nshape = \"box\"\nsize_m = [20.0, 0.5, 0.1]\n{tilt}\n\
             position_m = [{:?}, 0.0, {:?}]\n[[axis]]\nname = \"m\"\nbelt = \"belt\"\ndirection = [{cos:?}, 0, {sin:?}]\ndrive = \"velocity\"\n\
             command_signal = \"V\"\nspeed_m_s = 1.0\nacceleration_m_s2 = 1e6\n",
            0.1 * sin,
            -0.1 * cos
        );
        let part =
            "[[body]]\nname = \"a\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\nmass_kg = 1.0\n";
        let mut bench = bench(&format!("{belt}{part}{tilt}\n"), step_us);
        bench.command("V", 0.5);
        bench.run_us(time_us);
        let [x, _, z] = place(&bench, "a");
        x * cos + z * sin
    }
}

fn rolls() -> Vec<Line> {
    let (sin, cos) = libm::sincos(20.0_f64.to_radians());
    let (up, down) = (G * (0.45 * cos - sin), G * (0.3 * cos - sin));
    let slips = |step_us: u64| {
        let ball = "[[body]]\nname = \"a\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.05\nmass_kg = 1.0\n\
                    position_m = [0.0, 0.0, 0.05]\nvelocity_m_s = [1.0, 0.0, 0.0]\n";
        let mut bench = bench(&format!("{FLOOR}{ball}"), step_us);
        bench.run_us(500_000);
        let before = place(&bench, "a")[0];
        bench.run_us(500_000);
        (place(&bench, "a")[0] - before) / 0.5
    };
    let rule = |keys: &'static str| {
        move |step_us: u64| {
            let keys = format!("velocity_m_s = [1.0, 0.0, 0.0]\n{keys}");
            let mut bench = bench(&format!("{FLOOR}{}", cube("a", [0.0, 0.0, 0.05], 2.0, &keys)), step_us);
            bench.run_us(1_200_000);
            place(&bench, "a")[0]
        }
    };
    vec![
        Line::new(
            "box put on a belt of 0.5 m/s up 20°, friction 0.45 (carried): way in 2 s",
            (1.0 - 0.125 / up, "m"),
            "v t - v²/(2 a)",
            incline(0.45, 2_000_000),
        ),
        Line::new(
            "the same with friction 0.3 (slides back): way in 2 s",
            (2.0 * down, "m"),
            COULOMB,
            incline(0.3, 2_000_000),
        ),
        Line::new(
            "cylinder that rolls down a ramp of 20°, way in 1 s",
            (G * sin / 3.0, "m"),
            "2/3 g sin α",
            slope(20.0, "friction = 0.8", "shape = \"cylinder\"\nradius_m = 0.05\nlength_m = 0.1\nmass_kg = 1.0", true),
        ),
        Line::new("ball that slips at 1 m/s until it rolls: velocity then", (5.0 / 7.0, "m/s"), "5/7 v", slips),
        Line::new(
            "box of friction 0.1 on a floor of 0.5, `least`, from 1 m/s: way",
            (1.0 / (0.2 * G), "m"),
            "v²/(2 µ g)",
            rule("friction = 0.1\nfriction_rule = \"least\""),
        ),
        Line::new(
            "box of friction 0.4 on a floor of 0.5, `product`, from 1 m/s: way",
            (1.0 / (0.4 * G), "m"),
            "v²/(2 µ g)",
            rule("friction = 0.4\nfriction_rule = \"product\""),
        ),
    ]
}

/// The velocity of a ball of 1 kg at rest that one of another mass hits at 1 m/s.
fn hit(kg: f64, restitution: f64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let ball = |name: &str, x: f64, v: f64, kg: f64| {
            format!(
                "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.05\nmass_kg = {kg:?}\nfriction = 0.0\n\
                 position_m = [{x:?}, 0.0, 0.0]\nrestitution = {restitution:?}\nvelocity_m_s = [{v:?}, 0.0, 0.0]\n"
            )
        };
        let parts = format!("gravity_m_s2 = [0, 0, 0]\n{}{}", ball("a", 0.0, 1.0, kg), ball("b", 0.3, 0.0, 1.0));
        let mut bench = bench(&parts, step_us);
        bench.run_us(500_000);
        let before = place(&bench, "b")[0];
        bench.run_us(200_000);
        (place(&bench, "b")[0] - before) / 0.2
    }
}

fn hits() -> Vec<Line> {
    // a plate that has been tilted by 10° about its lower edge falls on
    let half = [0.01_f64, 0.1_f64];
    let diagonal = half[0].hypot(half[1]);
    let (start, tilt) = (libm::atan2(half[0], half[1]), 10.0_f64.to_radians());
    let falls = move |step_us: u64| {
        let angle = tilt - start;
        let (x, z) = (diagonal * libm::sin(angle), diagonal * libm::cos(angle));
        let plate = format!(
            "[[body]]\nname = \"a\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.02, 0.1, 0.2]\nmass_kg = 0.5\nfriction = 1.0\n\
             position_m = [{x:?}, 0.0, {z:?}]\nrpy_deg = [0.0, 10.0, 0.0]\n"
        );
        let mut bench = bench(&format!("{FLOOR}{plate}"), step_us);
        bench.run_us(300_000);
        turned(&bench, "a", 1).to_degrees()
    };
    let inertia = (0.02 * 0.02 + 0.2 * 0.2) / 12.0 + diagonal * diagonal;
    let [end, _] =
        curves::runge_kutta([tilt - start, 0.0], 0.3, 10_000, |_, y| [y[1], G * diagonal * libm::sin(y[0]) / inertia]);
    let momentum = "momentum and restitution";
    vec![
        Line::new(
            "ball of 2 kg at 1 m/s that hits one of 1 kg, restitution 1: velocity of that",
            (4.0 / 3.0, "m/s"),
            momentum,
            hit(2.0, 1.0),
        ),
        Line::new("the same of 1 kg, restitution 0.5", (0.75, "m/s"), momentum, hit(1.0, 0.5)),
        Line::new("the same of 1 kg, restitution 0", (0.5, "m/s"), momentum, hit(1.0, 0.0)),
        Line::new(
            "domino of 200 x 20 mm that tips from 10°, its tilt after 0.3 s",
            ((end + start).to_degrees(), "°"),
            "own integration",
            falls,
        )
        .because(EDGE),
    ]
}

/// What the drive of a carriage of 5 kg says at 0.2 m/s over a rail that is so far below it.
fn rail(gap_m: f64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let motor = "[[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"velocity\"\ncommand_signal = \"V\"\nspeed_m_s = 1.0\n\
                     acceleration_m_s2 = 1.0\nforce_signal = \"Force\"\n";
        let parts = format!(
            "{FLOOR}{}{}{motor}",
            cube("a", [0.0, 0.0, 0.05 + gap_m], 5.0, ""),
            joint("j", "prismatic", "a", "[1, 0, 0]", "")
        );
        let mut bench = bench(&parts, step_us);
        bench.command("V", 0.2);
        bench.run_us(500_000);
        bench.read("Force")
    }
}

fn guides() -> Vec<Line> {
    let screwed = |step_us: u64| {
        let wheel = "[[body]]\nname = \"w\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.1\nlength_m = 0.05\nmass_kg = 2.0\n";
        let motor = "[[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"bidirectional\"\nforward_signal = \"Screw\"\nreverse_signal = \"Unscrew\"\n\
                     speed_rad_s = 10.0\nacceleration_rad_s2 = 100.0\ntorque_max_nm = 2.0\ntorque_signal = \"Torque\"\n";
        let hinge = joint("j", "revolute", "w", "[0, 0, 1]", "lower_rad = 0.0\nupper_rad = 12.0\ninitial_rad = 1.0");
        let mut bench = bench(&format!("{wheel}{hinge}{motor}"), step_us);
        bench.command("Unscrew", true);
        bench.run_us(500_000);
        bench.command("Unscrew", false);
        bench.run_us(500_000);
        bench.read("Torque")
    };
    vec![
        Line::new(
            "carriage that is guided 0.1 mm above a rail: force of its drive",
            (0.0, "N"),
            "it does not touch",
            rail(1e-4),
        ),
        Line::new("the same in touch with the rail", (0.0, "N"), "the guide carries it", rail(0.0)),
        Line::new("the same 0.1 mm in the rail", (0.0, "N"), "a guide that carries it", rail(-1e-4)),
        Line::new("drive that has come to a stop and is let go: torque", (0.0, "N·m"), "nothing asks for any", screwed),
    ]
}
