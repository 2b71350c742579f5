//! Bodies whose shapes are meshes from files.

use onescan_plant::{Plant, SceneError};
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, PortLayout};
use onescan_server::time::VirtualTime;

use crate::bench::PERIOD;

/// A cube with edges of 100 mm.
const CUBE: &str = "v -50 -50 -50\nv 50 -50 -50\nv 50 50 -50\nv -50 50 -50\nv -50 -50 50\nv 50 -50 50\nv 50 50 50\n\
    v -50 50 50\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A trough that a convex hull would close: two slopes that meet in the middle, 2 m long.
const TROUGH: &str =
    "v -1 -1 1\nv 1 -1 1\nv 1 0 0\nv -1 0 0\nv 1 1 1\nv -1 1 1\nv 0 0 -1\nf 1 2 3 4\nf 4 3 5 6\nf 4 3 7\n";

const SCENE: &str = r#"
version = 1

[[body]]
name = "trough"
kind = "fixed"
shape = "mesh"
mesh = "trough.obj"
hull = false

[[body]]
name = "part"
kind = "dynamic"
shape = "mesh"
mesh = "cube.obj"
unit_m = 0.001
mass_kg = 2.0
position_m = [0.0, 0.3, 1.2]
friction = 0.0
"#;

fn plant(scene: &str) -> Result<Plant, SceneError> {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("cube.obj", CUBE);
    write("trough.obj", TROUGH);
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("plant.toml", scene);
    Plant::load(&folder.path().join("plant.toml"), ClientName::new("plant").expect("a name"), PERIOD)
}

fn turned(plant: &mut Plant, turns: u64) -> [f64; 3] {
    for k in 1..=turns {
        plant.turn(VirtualTime::from_nanos(k * 10_000_000), &[], &mut []).expect("a turn");
    }
    plant.poses().nth(1).expect("the part").position_m
}

#[test]
fn a_part_slides_to_the_bottom_of_a_trough() {
    let mut plant = plant(SCENE).expect("a scene");
    assert_eq!(PortLayout::new(plant.join().writes).size(), 0);
    plant.setup(&mut []).expect("a set-up");
    let [x, y, z] = turned(&mut plant, 1);
    // one step of free fall in eight iterations: g dt² (8 + 1)/(2·8); nothing reaches the part yet
    assert!(
        x.abs() < 1e-12 && (y - 0.3).abs() < 1e-12 && (z - (1.2 - 9.81e-4 * 9.0 / 16.0)).abs() < 1e-12,
        "{x} {y} {z}"
    );
    // inside of what a hull would fill, between both slopes
    let [_, y, z] = turned(&mut plant, 1000);
    assert!(y.abs() < 1.0 && (0.05..0.95).contains(&z), "{y} {z}");
}

/// The cube from a file falls, tumbles and slides as the box of the scene does, and goes on from a
/// saved state to the bit.
#[test]
fn a_hull_is_a_body_like_any_other() {
    let mut first = plant(SCENE).expect("a scene");
    first.setup(&mut []).expect("a set-up");
    turned(&mut first, 60);
    let mut second = plant(SCENE).expect("a scene");
    second.restore(&first.save().expect("a state")).expect("the same plant");
    assert_eq!(turned(&mut first, 200), turned(&mut second, 200));
    assert_eq!(first.save().expect("a state"), second.save().expect("a state"));
}

#[test]
fn what_is_wrong_with_a_mesh_is_reported_with_its_line() {
    let cases = [
        ("mesh = \"cube.obj\"", "mesh = \"none.stl\"", ":15:8: mesh `none.stl` cannot be read: "),
        (
            "mesh = \"cube.obj\"",
            "mesh = \"cube.step\"",
            ":15:8: mesh `cube.step` is not a mesh that this program reads: `.stl`, `.obj`, `.dae`, `.gltf` or `.glb`",
        ),
        ("mesh = \"cube.obj\"", "mesh = \"flat.obj\"", ":15:8: mesh `flat.obj` is flat, and no body"),
        ("mesh = \"cube.obj\"\n", "", ":14:9: mesh `part` needs `mesh`"),
        (
            "unit_m = 0.001",
            "unit_m = 1000.0",
            ":15:8: mesh `cube.obj` has a corner more than 10000 m away: `unit_m` is the file's unit, 0.001 for mm",
        ),
        ("unit_m = 0.001", "unit_mm = 1.0", ":16:1: unknown key `unit_mm` (did you mean `unit_m`?)"),
        (
            "unit_m = 0.001",
            "hull = false",
            ":16:8: mesh `part` is of a dynamic body and needs its hull: only what no force moves can be a mere surface",
        ),
        ("unit_m = 0.001", "size_m = [1, 1, 1]", ":16:10: mesh `part` has no `size_m`"),
        (
            "shape = \"mesh\"\nmesh = \"trough.obj\"",
            "shape = \"sphere\"\nradius_m = 1.0",
            ":9:8: sphere `trough` has no `hull`",
        ),
    ];
    for (right, wrong, reported) in cases {
        assert!(SCENE.contains(right), "{right}");
        let said = plant(&SCENE.replacen(right, wrong, 1)).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(said.contains(reported), "{reported}\n{said}");
    }
}
