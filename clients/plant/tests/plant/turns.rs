//! Stops of revolute joints that are a turn or more apart.

use crate::bench::Bench;

/// A wheel on a stand, with stops at these angles and a drive of 2 N·m.
fn wheel(stand: &str, stops: &str) -> String {
    format!(
        r#"
version = 1
gravity_m_s2 = [0, 0, 0]
[[body]]
name = "stand"
{stand}
shape = "box"
size_m = [0.2, 0.2, 0.2]
[[body]]
name = "wheel"
kind = "dynamic"
shape = "cylinder"
radius_m = 0.1
length_m = 0.05
mass_kg = 2.0
position_m = [0.0, 0.0, 0.3]
[[joint]]
name = "j"
kind = "revolute"
parent = "stand"
child = "wheel"
axis = [0, 0, 1]
{stops}
[[axis]]
name = "m"
joint = "j"
drive = "velocity"
command_signal = "V"
position_signal = "At"
speed_rad_s = 20.0
acceleration_rad_s2 = 100.0
torque_max_nm = 2.0
"#
    )
}

/// Where the wheel is after two seconds one way, and after three more the other way.
fn there_and_back(scene: &str, step_us: u64) -> [f64; 2] {
    let mut bench = Bench::at_us(scene, step_us);
    bench.command("V", 20.0);
    bench.run_us(2_000_000);
    let there = bench.read("At");
    bench.command("V", -20.0);
    bench.run_us(3_000_000);
    [there, bench.read("At")]
}

#[test]
fn a_joint_counts_its_turns_to_its_stops() {
    let stops = "lower_rad = -10.0\nupper_rad = 20.0";
    for step_us in [1_000, 10_000] {
        let [there, back] = there_and_back(&wheel("kind = \"fixed\"", stops), step_us);
        assert!((there - 20.0).abs() < 1e-9 && (back + 10.0).abs() < 1e-9, "{step_us}: {there} {back}");
    }
}

#[test]
fn one_stop_leaves_the_other_way_free() {
    let [there, back] = there_and_back(&wheel("kind = \"fixed\"", "lower_rad = -10.0"), 10_000);
    assert!(there > 35.0 && (back + 10.0).abs() < 1e-9, "{there} {back}");
}

/// A stand that nothing holds makes the engine move the joint, which sees no turns.
#[test]
fn the_engine_gets_the_stop_that_is_near() {
    let stops = "lower_rad = -10.0\nupper_rad = 20.0";
    for step_us in [1_000, 10_000] {
        let stand = "kind = \"dynamic\"\nmass_kg = 100000.0";
        let [there, back] = there_and_back(&wheel(stand, stops), step_us);
        assert!((there - 20.0).abs() < 1e-2 && (back + 10.0).abs() < 1e-2, "{step_us}: {there} {back}");
    }
}
