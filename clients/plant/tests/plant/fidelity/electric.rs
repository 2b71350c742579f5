//! Motors and axes.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::Line;
use super::mechanisms::wheel;
use super::scenes::{bench, cube, joint, out_after, turns_until, when};

const KLOSS: &str = "Kloss";
const SIZING: &str = "drive sizing";

pub(super) fn lines() -> Vec<Line> {
    let mut lines = asynchronous();
    lines.extend(servos());
    lines.extend(turning());
    lines
}

/// An asynchronous motor of 50 N·m at a slip of 0.2 and 157.08 rad/s, with more keys.
fn motor(keys: &str) -> String {
    format!("[[component]]\nname = \"c\"\nkind = \"asynchronous_motor\"\nrun = true\n{keys}\n")
}

/// The slip at a torque in parts of the pull-out torque.
fn slip(part: f64) -> f64 {
    0.2 * (1.0 - (1.0 - part * part).sqrt()) / part
}

fn asynchronous() -> Vec<Line> {
    let synchronous = TAU * 25.0;
    let run_up = move |step_us: u64| {
        let mut bench = bench(&motor("ramp_s = 0.0\nvelocity_rad_s_signal = \"Out\""), step_us);
        when(&mut bench, step_us, 1.0, |bench| bench.read::<f64>("Out") - 0.95 * synchronous)
    };
    let shows = |keys: &'static str, time_us: u64| move |step_us: u64| out_after(&motor(keys), time_us, step_us);
    let integral = (1.0 - 0.05 * 0.05) / (2.0 * 0.2) + 0.2 * libm::log(20.0);
    let speeds_up = 0.05 * synchronous / 2.0;
    vec![
        Line::new(
            "asynchronous motor of 50 N·m and 0.05 kg·m² straight on line: to 95 % of 1500 1/min",
            (0.05 * synchronous / 100.0 * integral, "s"),
            "Kloss, integrated",
            run_up,
        ),
        Line::new(
            "the same motor at standstill: torque",
            (100.0 / (5.0 + 0.2), "N·m"),
            KLOSS,
            shows("ramp_s = 0.0\ninertia_kg_m2 = 10000.0\ntorque_nm_signal = \"Out\"", 100_000),
        ),
        Line::new(
            "the same with a load of 15 N·m: speed after 1 s",
            (synchronous * (1.0 - slip(0.3)), "rad/s"),
            KLOSS,
            shows("ramp_s = 0.0\nload_nm = 15.0\nvelocity_rad_s_signal = \"Out\"", 1_000_000),
        ),
        Line::new(
            "the same on a converter with a ramp of 2 s: speed after 1.5 s",
            (synchronous * (0.75 - slip(speeds_up / 50.0)), "rad/s"),
            KLOSS,
            shows("velocity_rad_s_signal = \"Out\"", 1_500_000),
        ),
    ]
}

/// The time that a servo axis of 2 m/s² takes to be in position.
fn servo(target_m: f64, keys: &'static str) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let parts = format!(
            "gravity_m_s2 = [0, 0, 0]\n{}{}[[component]]\nname = \"c\"\njoint = \"j\"\nkind = \"servo_axis\"\nenable = true\n\
             needs_homing = false\nfeed_forward_ratio = 1.0\nfriction_n = 0.0\nexecute_signal = \"Go\"\ntarget_m = {target_m:?}\n\
             lower_m = -0.1\nin_position_signal = \"There\"\n{keys}\n",
            cube("a", [0.0; 3], 20.0, ""),
            joint("j", "prismatic", "a", "[1, 0, 0]", "")
        );
        let mut bench = bench(&parts, step_us);
        bench.run_us(100_000);
        bench.command("Go", true);
        turns_until(&mut bench, step_us, |bench| bench.read("There"))
    }
}

fn following(step_us: u64) -> f64 {
    let parts = format!(
        "gravity_m_s2 = [0, 0, 0]\n{}{}[[component]]\nname = \"c\"\njoint = \"j\"\nkind = \"servo_axis\"\nenable = true\n\
         needs_homing = false\nfriction_n = 0.0\nexecute_signal = \"Go\"\ntarget_m = 0.8\nlower_m = -0.1\nfollowing_m_signal = \"Out\"\n",
        cube("a", [0.0; 3], 20.0, ""),
        joint("j", "prismatic", "a", "[1, 0, 0]", "")
    );
    let mut bench = bench(&parts, step_us);
    bench.run_us(100_000);
    bench.command("Go", true);
    bench.run_us(1_000_000);
    1e3 * bench.read::<f64>("Out")
}

fn servos() -> Vec<Line> {
    let jerk = "jerk_m_s3 = 20.0";
    vec![
        Line::new(
            "servo axis, 0.5 m at 0.5 m/s, 2 m/s² and 20 m/s³: in position",
            (1.35, "s"),
            "s/v + v/a + a/j (drive sizing)",
            servo(0.5, jerk),
        ),
        Line::new(
            "the same, 0.05 m without a limit of the jerk",
            (2.0 * (0.05_f64 / 2.0).sqrt(), "s"),
            "2 √(s/a) (drive sizing)",
            servo(0.05, "jerk_m_s3 = 0.0"),
        ),
        Line::new("the same, 0.5 m at 0.25 m/s", (2.125, "s"), SIZING, servo(0.5, "jerk_m_s3 = 0.0\nspeed_m_s = 0.25")),
        Line::new(
            "servo axis at 0.5 m/s with 50 1/s and no feed-forward: following error",
            (10.0, "mm"),
            "v/K_v",
            following,
        )
        .because("the set position is that of the end of a sub-step of at most 250 µs, the measured one that of its beginning"),
    ]
}

fn turning() -> Vec<Line> {
    let on_wheel = |component: &'static str, time_us: u64| {
        move |step_us: u64| {
            let parts = format!("{}[[component]]\nname = \"c\"\njoint = \"w\"\n{component}\n", wheel("w", 0.0));
            out_after(&parts, time_us, step_us)
        }
    };
    let station = |step_us: u64| {
        let parts = "[[component]]\nname = \"c\"\nkind = \"turntable\"\nstep_signal = \"Go\"\nbusy_signal = \"Busy\"\n";
        let mut bench = bench(parts, step_us);
        bench.command("Go", true);
        bench.turn();
        1e-6 * step_us as f64 + turns_until(&mut bench, step_us, |bench| !bench.read::<bool>("Busy"))
    };
    vec![
        Line::new(
            "torque drive with a current loop of 10 ms: torque after 10 ms of 0.5 N·m",
            (0.5 * (1.0 - libm::exp(-1.0)), "N·m"),
            "lag of first order",
            on_wheel(
                "kind = \"torque_drive\"\ncommand_nm = 0.5\ncurrent_loop_s = 0.01\ntorque_nm_signal = \"Out\"",
                10_000,
            ),
        ),
        Line::new(
            "spindle of 20 N·m and 0.01 kg·m²: speed after 0.3 s",
            (20.0 / 0.01 * 0.3 * 60.0 / TAU, "1/min"),
            "M t/J",
            on_wheel("kind = \"spindle\"\nrun = true\ncommand_1_min = 12000.0\nspeed_1_min_signal = \"Out\"", 300_000),
        ),
        Line::new(
            "turntable of 4 stations at 2 rad/s and 8 rad/s²: to the next",
            (FRAC_PI_2 / 2.0 + 0.25, "s"),
            "φ/ω + ω/α",
            station,
        ),
        Line::new(
            "conveyor of 0.5 m/s and 1 m/s²: way of the belt after 1 s",
            (0.375, "m"),
            "v t - v²/(2 a)",
            |step_us| {
                let parts = "[[body]]\nname = \"b\"\nkind = \"kinematic\"\nshape = \"box\"\nsize_m = [2, 0.5, 0.1]\n[[component]]\n\
                             name = \"c\"\nkind = \"conveyor\"\nbelt = \"b\"\ndirection = [1, 0, 0]\nrun = true\ntravel_m_signal = \"Out\"\n";
                out_after(parts, 1_000_000, step_us)
            },
        ),
    ]
}
