//! Scenes as text, and what is read off their benches.

use crate::bench::Bench;

/// Standard gravity as scenes have it.
pub(super) const G: f64 = 9.81;

/// A cube of 0.1 m at a place, with more keys.
pub(super) fn cube(name: &str, [x, y, z]: [f64; 3], mass_kg: f64, keys: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\n\
         position_m = [{x:?}, {y:?}, {z:?}]\nmass_kg = {mass_kg:?}\n{keys}\n"
    )
}

pub(super) fn joint(name: &str, kind: &str, child: &str, axis: &str, keys: &str) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\nkind = \"{kind}\"\nparent = \"ground\"\nchild = \"{child}\"\naxis = {axis}\n{keys}\n"
    )
}

/// The bench of a scene with bodies and what moves them.
pub(super) fn bench(parts: &str, step_us: u64) -> Bench {
    Bench::at_us(&format!("version = 1\n{parts}"), step_us)
}

/// What a scene writes to `Out` after a time.
pub(super) fn out_after(parts: &str, time_us: u64, step_us: u64) -> f64 {
    let mut bench = bench(parts, step_us);
    bench.run_us(time_us);
    bench.read("Out")
}

/// Where a body is.
pub(super) fn place(bench: &Bench, body: &str) -> [f64; 3] {
    bench.plant.poses().find(|pose| pose.name == body).expect("a body").position_m
}

/// How far a body has turned about x, y or z.
pub(super) fn turned(bench: &Bench, body: &str, axis: usize) -> f64 {
    let pose = bench.plant.poses().find(|pose| pose.name == body).expect("a body");
    2.0 * libm::atan2(pose.rotation_xyzw[axis], pose.rotation_xyzw[3])
}

/// The first moment at which a value rises to 0, between the two turns around it by a straight line.
pub(super) fn when(bench: &mut Bench, step_us: u64, most_s: f64, value: impl Fn(&Bench) -> f64) -> f64 {
    let step_s = 1e-6 * step_us as f64;
    let mut before = value(bench);
    for turn in 0..(most_s / step_s) as u64 {
        bench.turn();
        let now = value(bench);
        if before < 0.0 && now >= 0.0 {
            return step_s * (turn as f64 + before / (before - now));
        }
        before = now;
    }
    f64::NAN
}

/// The time from the first rising crossing of 0 to the one of this number.
pub(super) fn crossings(bench: &mut Bench, step_us: u64, count: u32, value: impl Fn(&Bench) -> f64) -> f64 {
    let step_s = 1e-6 * step_us as f64;
    let (mut before, mut first, mut found) = (value(bench), f64::NAN, 0);
    for turn in 0..100_000 {
        bench.turn();
        let now = value(bench);
        if before < 0.0 && now >= 0.0 {
            let at = step_s * (f64::from(turn) + before / (before - now));
            found += 1;
            if found == 1 {
                first = at;
            }
            if found == count {
                return at - first;
            }
        }
        before = now;
    }
    f64::NAN
}

/// The time of so many turns as a value needs to become true.
pub(super) fn turns_until(bench: &mut Bench, step_us: u64, there: impl Fn(&Bench) -> bool) -> f64 {
    let mut turns = 0_u32;
    while !there(bench) && turns < 100_000 {
        bench.turn();
        turns += 1;
    }
    f64::from(turns) * 1e-6 * step_us as f64
}

/// The period of a pendulum from an amplitude, by the mean of arithmetic and geometric means.
pub(super) fn pendulum_s(small_s: f64, amplitude_rad: f64) -> f64 {
    let (mut a, mut b) = (1.0, libm::cos(0.5 * amplitude_rad));
    for _ in 0..20 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    small_s / a
}
