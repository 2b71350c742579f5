//! docs/fidelity.md: textbook and catalogue values beside those of the plant at three steps.
//!
//! `UPDATE_DOCS=1 cargo test -p onescan-plant --test plant fidelity` rewrites the page.

mod contacts;
mod drives;
mod mechanics;

use std::fmt::Write as _;
use std::path::Path;

use crate::bench::Bench;

/// Turns of 100 µs, 1 ms and 10 ms.
const STEPS_US: [u64; 3] = [100, 1_000, 10_000];
/// Standard gravity as scenes have it.
const G: f64 = 9.81;
/// A smaller part of the value is not shown as an error.
const SHOWN: f64 = 5e-5;

/// A line of the page.
struct Line {
    what: &'static str,
    unit: &'static str,
    exact: f64,
    source: &'static str,
    /// The plant's value in turns of so many microseconds.
    ours: Box<dyn Fn(u64) -> f64>,
}

impl Line {
    fn new(
        what: &'static str,
        (exact, unit): (f64, &'static str),
        source: &'static str,
        ours: impl Fn(u64) -> f64 + 'static,
    ) -> Self {
        Self { what, unit, exact, source, ours: Box::new(ours) }
    }

    fn cell(&self, step_us: u64) -> String {
        let ours = (self.ours)(step_us);
        let off = ours / self.exact - 1.0;
        if off.abs() < SHOWN { number(ours) } else { format!("{} ({:+.2} %)", number(ours), 100.0 * off) }
    }
}

/// The time from the first rising crossing of 0 to the one of this number.
fn crossings(bench: &mut Bench, step_us: u64, count: u32, value: impl Fn(&Bench) -> f64) -> f64 {
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

/// Five digits; what is a rounding beside other values of the page is 0.
fn number(value: f64) -> String {
    if value.abs() < 1e-6 {
        return "0".to_owned();
    }
    let whole = value.abs().log10().floor();
    let decimals = (4.0 - whole).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

/// A scene with bodies and what moves them.
fn scene(more: &str) -> String {
    format!("version = 1\n{more}")
}

/// A cube of 0.1 m at a place, with more keys.
fn cube(name: &str, [x, y, z]: [f64; 3], mass_kg: f64, keys: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\n\
         position_m = [{x:?}, {y:?}, {z:?}]\nmass_kg = {mass_kg:?}\n{keys}\n"
    )
}

fn joint(name: &str, kind: &str, child: &str, axis: &str, keys: &str) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\nkind = \"{kind}\"\nparent = \"ground\"\nchild = \"{child}\"\naxis = {axis}\n{keys}\n"
    )
}

fn bench(scene_text: &str, step_us: u64) -> Bench {
    Bench::at_us(&scene(scene_text), step_us)
}

/// Where a body is.
fn place(bench: &Bench, body: &str) -> [f64; 3] {
    bench.plant.poses().find(|pose| pose.name == body).expect("a body").position_m
}

/// How far a body has turned about z, or about the axis of this index.
fn turned(bench: &Bench, body: &str, axis: usize) -> f64 {
    let pose = bench.plant.poses().find(|pose| pose.name == body).expect("a body");
    2.0 * libm::atan2(pose.rotation_xyzw[axis], pose.rotation_xyzw[3])
}

/// The first moment at which something holds, between the two turns around it by a straight line of `value`.
fn when(bench: &mut Bench, step_us: u64, most_s: f64, value: impl Fn(&Bench) -> f64) -> f64 {
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

fn page() -> String {
    let mut page = String::from(
        "# Fidelity\n\nTextbook and catalogue values beside those of the plant, in turns of 100 µs, 1 ms and 10 ms with one \
         physics step\neach. A percentage is the error, where it is 0.005 % or more. A test computes this page and holds it \
         to date:\n`UPDATE_DOCS=1 cargo test -p onescan-plant --test plant fidelity` rewrites it. See also\n\
         [accuracy](plant.md#accuracy-and-cost).\n",
    );
    let parts = [
        ("Joints and springs", mechanics::lines()),
        ("Drives and fluids", drives::lines()),
        ("Contacts", contacts::lines()),
    ];
    for (title, lines) in parts {
        writeln!(page, "\n## {title}\n\n| what | exact | 100 µs | 1 ms | 10 ms | source |\n|---|---|---|---|---|---|")
            .expect("a text");
        for line in lines {
            let cells = STEPS_US.map(|step_us| line.cell(step_us)).join(" | ");
            let exact = format!("{} {}", number(line.exact), line.unit);
            writeln!(page, "| {} | {exact} | {cells} | {} |", line.what, line.source).expect("a text");
        }
    }
    page
}

#[test]
fn the_page_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/fidelity.md");
    let now = page();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&path, &now).expect("written");
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(written, now, "docs/fidelity.md: UPDATE_DOCS=1 rewrites it");
}
