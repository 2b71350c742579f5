//! Sensors in a moving plant.

use crate::bench::Bench;

/// A flag on a horizontal slide, watched by everything that the format knows.
const SCENE: &str = r#"
    version = 1
    [[body]]
    name = "post"
    kind = "fixed"
    shape = "box"
    size_m = [0.1, 0.1, 0.1]
    position_m = [0.5, 1.0, 0.0]
    [[body]]
    name = "flag"
    kind = "dynamic"
    shape = "box"
    size_m = [0.1, 0.1, 0.1]
    mass_kg = 1.0
    [[joint]]
    name = "slide"
    kind = "prismatic"
    parent = "ground"
    child = "flag"
    axis = [1.0, 0.0, 0.0]
    [[axis]]
    name = "drive"
    joint = "slide"
    drive = "position"
    command_signal = "to"
    speed_m_s = 1.0
    acceleration_m_s2 = 10.0
    position_signal = "position"
    [[sensor]]
    name = "end"
    kind = "end_position"
    signal = "end"
    joint = "slide"
    from_m = 0.4
    to_m = 0.6
    hysteresis_m = 0.05
    [[sensor]]
    name = "barrier"
    kind = "proximity"
    signal = "barrier"
    point_m = [0.5, -1.0, 0.0]
    direction = [0.0, 2.0, 0.0]
    range_m = 1.2
    [[sensor]]
    name = "blind"
    kind = "proximity"
    signal = "blind"
    point_m = [0.5, -1.0, 0.0]
    direction = [0.0, 1.0, 0.0]
    range_m = 1.2
    targets = ["post"]
    [[sensor]]
    name = "feeler"
    kind = "proximity"
    signal = "feeler"
    body = "flag"
    point_m = [0.0, 0.0, 0.0]
    direction = [0.0, 1.0, 0.0]
    range_m = 1.0
"#;

/// Moves to a position and waits there.
fn go(bench: &mut Bench, to_m: f64) {
    bench.command("to", to_m);
    for _ in 0..200 {
        bench.turn();
    }
    assert!((bench.read::<f64>("position") - to_m).abs() < 1e-9);
}

#[test]
fn an_end_position_has_hysteresis_on_both_sides() {
    let mut bench = Bench::new(SCENE);
    for (to_m, seen) in [(0.38, false), (0.41, true), (0.36, true), (0.34, false), (0.36, false)] {
        go(&mut bench, to_m);
        assert_eq!(bench.read::<bool>("end"), seen, "{to_m}");
    }
    for (to_m, seen) in [(0.59, true), (0.64, true), (0.66, false), (0.64, false), (0.6 - 1e-6, true)] {
        go(&mut bench, to_m);
        assert_eq!(bench.read::<bool>("end"), seen, "{to_m}");
    }
}

#[test]
fn a_ray_sees_what_stands_in_it() {
    let mut bench = Bench::new(SCENE);
    // the flag is 0.1 m wide and the ray runs at 0.5 m
    for (to_m, seen) in [(0.449, false), (0.451, true), (0.549, true), (0.551, false)] {
        go(&mut bench, to_m);
        assert_eq!(bench.read::<bool>("barrier"), seen, "{to_m}");
        assert!(!bench.read::<bool>("blind"), "only the post is its target, and that is out of range");
    }
}

#[test]
fn a_sensor_moves_with_its_body_and_does_not_see_it() {
    let mut bench = Bench::new(SCENE);
    assert!(!bench.read::<bool>("feeler"));
    for (to_m, seen) in [(0.449, false), (0.451, true), (0.551, false)] {
        go(&mut bench, to_m);
        assert_eq!(bench.read::<bool>("feeler"), seen, "{to_m}");
    }
}

#[test]
fn sensors_are_right_before_the_first_turn() {
    let near = SCENE.replace("point_m = [0.5, -1.0, 0.0]", "point_m = [0.0, -1.0, 0.0]");
    let bench = Bench::new(&near.replace("from_m = 0.4", "from_m = -0.1"));
    assert!(bench.read::<bool>("barrier"));
    assert!(bench.read::<bool>("end"));
}
