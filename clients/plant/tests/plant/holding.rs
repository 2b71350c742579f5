//! What holders hold, and what they lose: by force, friction and acceleration of what they really carry.

use crate::bench::Bench;

/// A holder at an axis above a box on a table; at the set-up it touches the box.
fn lift(kg: f64, acceleration_m_s2: f64, holder: &str) -> String {
    format!(
        r#"
version = 1
[[body]]
name = "table"
kind = "fixed"
shape = "box"
size_m = [2.0, 2.0, 0.1]
position_m = [0.0, 0.0, -0.05]
[[body]]
name = "box"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.2]
position_m = [0.0, 0.0, 0.1]
mass_kg = {kg}
[[body]]
name = "hand"
kind = "dynamic"
shape = "box"
size_m = [0.04, 0.04, 0.04]
position_m = [0.0, 0.0, 0.21]
mass_kg = 5.0
collides = false
[[joint]]
name = "up"
kind = "prismatic"
parent = "ground"
child = "hand"
axis = [0, 0, 1]
[[axis]]
name = "lift"
joint = "up"
drive = "position"
command_signal = "Height"
position_signal = "Height_Is"
speed_m_s = 1.0
acceleration_m_s2 = {acceleration_m_s2}
[[component]]
name = "holder"
body = "hand"
targets = ["box"]
holding_signal = "Holding"
load_n_signal = "Load"
{holder}
"#
    )
}

/// 40 mm and 0.8 bar: 100.5 N.
const CUP: &str = "kind = \"vacuum_cup\"\non = true\ndirection = [0, 0, -1]\n";
/// 2 · 0.25 · 200 N = 100 N.
const JAWS: &str = "kind = \"gripper\"\nclose = true\njaw_n = 200\nfriction = 0.25\ndirection = [0, 1, 0]\n";
const ARM: &str = "kind = \"arm\"\ndrop = false\nforce_n = 100\n";

/// Waits, lifts by half a metre, and says whether the box came along; and the greatest load on the way.
fn comes_along(kg: f64, acceleration_m_s2: f64, holder: &str, period_us: u64) -> (bool, f64) {
    let mut bench = Bench::at_us(&lift(kg, acceleration_m_s2, holder), period_us);
    let turns = |seconds: u64| seconds * 1_000_000 / period_us;
    (0..turns(1)).for_each(|_| bench.turn());
    bench.command("Height", 0.5);
    let mut most_n = 0.0_f64;
    for _ in 0..turns(3) {
        bench.turn();
        most_n = most_n.max(bench.read("Load"));
    }
    let height: f64 = bench.read("Height_Is");
    assert!((height - 0.5).abs() < 0.02, "the axis arrives: {height}");
    let z = bench.plant.poses().find(|pose| pose.name == "box").expect("there").position_m[2];
    assert_eq!(bench.read::<bool>("Holding"), z > 0.3, "{z}");
    (z > 0.3, most_n)
}

#[test]
fn a_hundred_newtons_hold_two_kilograms_and_lose_fifty_at_any_step() {
    for holder in [CUP, JAWS, ARM] {
        for period_us in [1_000, 10_000] {
            let (held, most_n) = comes_along(2.0, 0.5, holder, period_us);
            assert!(held, "{holder}");
            // m (g + a); the drive comes close to its ramps
            assert!((most_n - 2.0 * (9.81 + 0.5)).abs() < 1.5, "{holder}: {most_n}");
            assert!(!comes_along(50.0, 0.5, holder, period_us).0, "{holder}");
            assert!(!comes_along(800.0, 0.5, holder, period_us).0, "{holder}");
        }
    }
}

#[test]
fn a_move_that_is_too_fast_loses_the_part() {
    for holder in [CUP, JAWS, ARM] {
        for period_us in [1_000, 10_000] {
            assert!(comes_along(8.0, 0.5, holder, period_us).0, "8 kg ask for 82.5 N: {holder}");
            assert!(!comes_along(8.0, 5.0, holder, period_us).0, "8 kg ask for 118.5 N: {holder}");
        }
    }
}
