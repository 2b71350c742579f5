//! Coulomb's law in contacts in which a mechanism takes part: a face on a guide pushes a box along a floor.

use crate::bench::Bench;

const G: f64 = 9.81;
const PUSH_N: f64 = 1158.0;

/// A box on a floor with friction 0.5, and a face of 5 kg on a guide at half of its height.
fn scene(mass_kg: f64, face: &str) -> String {
    format!(
        r#"
version = 1
[[body]]
name = "floor"
kind = "fixed"
shape = "box"
size_m = [40.0, 4.0, 0.2]
position_m = [0.0, 0.0, -0.1]
[[body]]
name = "load"
kind = "dynamic"
shape = "box"
size_m = [0.4, 0.4, 0.4]
mass_kg = {mass_kg:?}
position_m = [0.25, 0.0, 0.2]
[[body]]
name = "face"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 5.0
position_m = [0.0, 0.0, 0.2]
{face}
[[joint]]
name = "guide"
kind = "prismatic"
parent = "ground"
child = "face"
axis = [1.0, 0.0, 0.0]
[[fitting]]
name = "push"
joint = "guide"
balance_n = {PUSH_N:?}
"#
    )
}

/// How far the box has gone after half a second, and how high it is.
fn pushed(mass_kg: f64, face: &str, step_us: u64) -> [f64; 2] {
    let mut bench = Bench::at_us(&scene(mass_kg, face), step_us);
    bench.run_us(500_000);
    let [x, _, z] = bench.plant.poses().find(|pose| pose.name == "load").expect("a box").position_m;
    [x - 0.25, z - 0.2]
}

#[test]
fn a_face_with_friction_carries_no_weight_that_stands_on_a_floor() {
    for step_us in [100, 1_000, 10_000] {
        for mass_kg in [50.0, 100.0, 150.0, 200.0, 230.0, 240.0] {
            for face in ["", "friction = 0.0\nfriction_rule = \"least\""] {
                let exact = f64::max(0.0, PUSH_N - 0.5 * mass_kg * G) / (mass_kg + 5.0) * 0.125;
                let [way, height] = pushed(mass_kg, face, step_us);
                // the velocity at the end of a step counts for all of it, and friction foresees the weight to a part
                // of a million
                let off = exact * 2.0 * step_us as f64 * 1e-6 / 0.5 + 1e-5;
                assert!((way - exact).abs() <= off, "{step_us} µs, {mass_kg} kg: {way} m in place of {exact} m");
                assert!(height.abs() < 1e-7, "{step_us} µs, {mass_kg} kg: {height}");
            }
        }
    }
}

/// Two jaws on guides press on a box of 5 kg with 200 N each, above nothing.
const JAWS: &str = r#"
version = 1
[[body]]
name = "part"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 5.0
[[body]]
name = "left"
kind = "dynamic"
shape = "box"
size_m = [0.02, 0.1, 0.1]
mass_kg = 1.0
position_m = [-0.06, 0.0, 0.0]
[[body]]
name = "right"
kind = "dynamic"
shape = "box"
size_m = [0.02, 0.1, 0.1]
mass_kg = 1.0
position_m = [0.06, 0.0, 0.0]
[[joint]]
name = "a"
kind = "prismatic"
parent = "ground"
child = "left"
axis = [1.0, 0.0, 0.0]
[[joint]]
name = "b"
kind = "prismatic"
parent = "ground"
child = "right"
axis = [1.0, 0.0, 0.0]
[[fitting]]
name = "fa"
joint = "a"
balance_n = 200.0
[[fitting]]
name = "fb"
joint = "b"
balance_n = -200.0
"#;

#[test]
fn what_jaws_hold_does_not_creep() {
    for step_us in [1_000, 10_000] {
        let mut bench = Bench::at_us(JAWS, step_us);
        bench.run_us(10_000_000);
        let [x, y, z] = bench.plant.poses().find(|pose| pose.name == "part").expect("a part").position_m;
        assert!(x.abs() < 1e-6 && y.abs() < 1e-6, "{step_us} µs: {x} {y}");
        assert!(z.abs() < 1e-6, "{step_us} µs: {z}");
    }
}

/// A press of 50 kN on a plate of 5 kg that lies on the ground.
const PRESS: &str = r#"
version = 1
[[body]]
name = "anvil"
kind = "fixed"
shape = "box"
size_m = [1.0, 1.0, 0.2]
position_m = [0.0, 0.0, -0.1]
[[body]]
name = "plate"
kind = "dynamic"
shape = "box"
size_m = [0.3, 0.3, 0.02]
mass_kg = 5.0
position_m = [0.0, 0.0, 0.01]
[[body]]
name = "ram"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.2]
mass_kg = 50.0
position_m = [0.0, 0.0, 0.12]
[[joint]]
name = "slide"
kind = "prismatic"
parent = "ground"
child = "ram"
axis = [0.0, 0.0, -1.0]
[[fitting]]
name = "force"
joint = "slide"
balance_n = 50000.0
"#;

#[test]
fn what_a_press_holds_does_not_sink_in() {
    for step_us in [100, 1_000, 10_000] {
        let mut bench = Bench::at_us(PRESS, step_us);
        bench.run_us(200_000);
        let z = |name: &str| bench.plant.poses().find(|pose| pose.name == name).expect("a body").position_m[2];
        let [sunk, pressed] = [0.01 - z("plate"), 0.12 - z("ram")];
        // 10 nm each, as a share of both of what is made up for
        assert!((0.0..3e-8).contains(&sunk) && (0.0..6e-8).contains(&pressed), "{step_us} µs: {sunk} {pressed}");
    }
}
