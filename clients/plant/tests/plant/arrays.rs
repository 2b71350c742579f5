//! Tables that are arrays, bodies of several shapes, and bodies that should never meet.

use onescan_plant::Scene;

use crate::bench::Bench;

/// Six posts around a mast, a row of three boxes, a wheel whose arm carries two sensors.
const YARD: &str = r#"
version = 1

[[body]]
name = "post[0..5]"
kind = "fixed"
position_m = [3.0, 0.0, 1.0]
rpy_deg = [0, 0, 10]
turn_about_m = [1.0, 0.0, 7.0]

[[body]]
name = "box[2..4]"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 1.0
position_m = [0.0, 5.0, 0.0]
step_m = [0.5, 0.0, 0.1]

[[body]]
name = "wheel"
kind = "dynamic"
shape = "sphere"
radius_m = 0.1
mass_kg = 5.0
collides = false

[[shape]]
name = "tip[0..1]"
body = "wheel"
shape = "box"
size_m = [0.1, 0.1, 0.1]
position_m = [1.0, 0.0, 0.0]
turn_about_m = [0.0, 0.0, 0.0]
mass_kg = 1.0

[[body]]
name = "mark"
kind = "fixed"
shape = "box"
size_m = [0.2, 0.2, 0.2]
position_m = [-1.0, 0.0, 0.0]
collides = false

[[joint]]
name = "shaft"
kind = "revolute"
parent = "ground"
child = "wheel"
axis = [0, 0, 1]

[[component]]
name = "feeler[0..1]"
kind = "contact_sensor"
body = "wheel"
shape = "tip[i]"
targets = ["mark"]
power_signal = "AT[i]"

[[component]]
name = "monitor"
kind = "collision_monitor"
targets = ["box[2..4]"]
collisions_signal = "Collisions"

[[failure]]
component = "feeler[0..1]"
mode = "stuck"
signal = "Stuck[i]"
"#;

fn refusal(scene: &str) -> String {
    Scene::parse(scene, "plant.toml").map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

#[test]
fn copies_are_placed_in_a_row_or_around_a_point() {
    let bench = Bench::new(YARD);
    let scene = bench.plant.scene();
    let body = |name: &str| scene.bodies.iter().find(|body| body.name == name).expect("a copy");
    assert_eq!((body("post[0]").position_m, body("post[0]").rpy_deg), ([3.0, 0.0, 1.0], [0.0, 0.0, 10.0]));
    let [x, y, z] = body("post[1]").position_m;
    let sine = 0.75_f64.sqrt();
    assert!(
        (x - 2.0).abs() < 1e-15 && (y - 2.0 * sine).abs() < 1e-15 && z == 1.0,
        "60 degrees about the mast: {x} {y}"
    );
    assert_eq!(body("post[3]").rpy_deg, [0.0, 0.0, 190.0]);
    assert_eq!(body("box[4]").position_m, [1.0, 5.0, 0.2]);
}

#[test]
fn a_shape_moves_with_its_body_and_is_felt_by_itself() {
    let mut bench = Bench::new(YARD);
    assert_eq!((bench.read::<bool>("AT[0]"), bench.read::<bool>("AT[1]")), (false, true), "tip 1 is half a turn on");
    bench.command("Stuck[0]", true);
    bench.turn();
    assert!(bench.read::<bool>("AT[0]"), "each copy has its own switch");
}

/// Two plates, each with a sensor that looks at it from 1 m above.
const LOOKED_AT: &str = r#"
version = 1
[[body]]
name = "plate[0..1]"
kind = "fixed"
shape = "box"
size_m = [0.1, 0.2, 0.1]
position_m = [1.0, 0.0, -0.05]
step_m = [0.5, 0.0, -0.2]
[[component]]
name = "eye[0..1]"
kind = "laser_distance"
body = "ground"
point_m = [1.0, 0.0, 1.0]
direction = [0.0, 0.0, -1.0]
distance_m_signal = "Far[i]"
targets = ["plate[0..1]"]
step_m = [0.5, 0.0, 0.0]
"#;

fn seen_m(scene: &str) -> [f64; 2] {
    let mut bench = Bench::new(scene);
    (0..100).for_each(|_| bench.turn());
    ["Far[0]", "Far[1]"].map(|signal| bench.read(signal))
}

#[test]
fn the_points_of_components_move_with_their_copies() {
    let [one, other] = seen_m(LOOKED_AT);
    assert!((one - 1.0).abs() < 0.01 && (other - 1.2).abs() < 0.01, "{one} {other}");
    // half a turn on, looking at each plate from outside along x
    let around = "turn_about_m = [0.0, 0.0, 0.0]";
    let ring = LOOKED_AT
        .replace("step_m = [0.5, 0.0, -0.2]", around)
        .replace("step_m = [0.5, 0.0, 0.0]", around)
        .replace("point_m = [1.0, 0.0, 1.0]", "point_m = [2.0, 0.0, -0.05]")
        .replace("direction = [0.0, 0.0, -1.0]", "direction = [-1.0, 0.0, 0.0]");
    let [one, other] = seen_m(&ring);
    assert!((one - 0.95).abs() < 0.01 && (other - 0.95).abs() < 0.01, "{one} {other}");
}

#[test]
fn a_component_without_a_point_has_no_place() {
    let scene = YARD.replace("name = \"monitor\"", "name = \"monitor\"\nstep_m = [1.0, 0.0, 0.0]");
    assert!(refusal(&scene).contains("`step_m`"), "{}", refusal(&scene));
}

#[test]
fn what_is_fixed_may_be_among_those_that_should_not_meet() {
    let floor = "[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [9, 9, 0.1]\nposition_m = [0, 5, -0.2]\n";
    let scene = format!("{YARD}{floor}").replace("targets = [\"box[2..4]\"]", "targets = [\"box[2..4]\", \"floor\"]");
    let mut bench = Bench::new(&scene);
    (0..200).for_each(|_| bench.turn());
    assert_eq!(bench.read::<i32>("Collisions"), 3, "each box on the floor");
}

#[test]
fn bodies_that_meet_are_counted_once_a_contact() {
    // the boxes fall onto a floor that does not count, the last one onto the first
    let floor = "[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [9, 9, 0.1]\nposition_m = [0, 5, -0.2]\n";
    let apart = format!("{YARD}{floor}");
    let mut bench = Bench::new(&apart);
    (0..200).for_each(|_| bench.turn());
    assert_eq!(bench.read::<i32>("Collisions"), 0);
    let mut bench = Bench::new(&apart.replace("step_m = [0.5, 0.0, 0.1]", "step_m = [0.0, 0.0, 0.2]"));
    (0..200).for_each(|_| bench.turn());
    assert_eq!(bench.read::<i32>("Collisions"), 2, "three in a pile touch twice");
}

#[test]
fn what_is_wrong_with_an_array_or_a_shape_is_reported() {
    let faults = [
        (
            "name = \"box[2..4]\"",
            "name = \"box[4..2]\"",
            "plant.toml:12:8: `box[4..2]` counts down: write the lower index first",
        ),
        (
            "targets = [\"box[2..4]\"]",
            "targets = [\"box[2..5]\"]",
            "plant.toml:63:11: no body `box[5]` in this scene (did you mean `box[2]`?)",
        ),
        (
            "shape = \"tip[i]\"",
            "shape = \"tap[i]\"",
            "plant.toml:56:9: no shape `tap[0]` in this scene (did you mean `tip[0]`?)",
        ),
        (
            "body = \"wheel\"\nshape = \"tip[i]\"",
            "body = \"mark\"\nshape = \"tip[i]\"",
            "plant.toml:56:9: shape `tip[0]` is none of body `mark`",
        ),
        (
            "name = \"post[0..5]\"",
            "name = \"post[0..5][0..1]\"",
            "plant.toml:5:8: `post[0..5][0..1]` has two ranges, where `[i]` could mean either",
        ),
        (
            "mass_kg = 1.0\n\n[[body]]\nname = \"mark\"",
            "radius_m = 1.0\n\n[[body]]\nname = \"mark\"",
            "plant.toml:35:12: box `tip[0]` has no `radius_m`",
        ),
        (
            "step_m = [0.5, 0.0, 0.1]",
            "step_m = [0.5, 0.0, 0.1]\nturn_about_m = [0, 0, 0]",
            "plant.toml:18:10: an array that is turned about a point has no `step_m`",
        ),
        (
            "turn_about_m = [0.0, 0.0, 0.0]",
            "turn_about = [0.0, 0.0, 0.0]",
            "plant.toml:34:1: unknown key `turn_about` (did you mean `turn_about_m`?)",
        ),
    ];
    for (right, wrong, reported) in faults {
        assert!(YARD.contains(right), "{right}");
        let said = refusal(&YARD.replacen(right, wrong, 1));
        assert!(said.lines().any(|line| line == reported), "{reported}\n{said}");
    }
}
