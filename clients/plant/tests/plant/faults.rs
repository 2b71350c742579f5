//! What a user reads who made a mistake in a scene file.

use std::fmt::Write as _;

use onescan_plant::Scene;

/// A small right scene; each case breaks it in its own way.
const RIGHT: &str = r#"version = 1

[[body]]
name = "base"
kind = "fixed"

[[body]]
name = "cart"
kind = "dynamic"
shape = "box"
size_m = [0.4, 0.2, 0.1]
mass_kg = 12.0

[[joint]]
name = "rail"
kind = "prismatic"
parent = "base"
child = "cart"
axis = [1.0, 0.0, 0.0]
lower_m = -1.0
upper_m = 1.0

[[axis]]
name = "drive"
joint = "rail"
drive = "bidirectional"
forward_signal = "forth"
reverse_signal = "back"
speed_m_s = 0.5
acceleration_m_s2 = 2.0
position_signal = "position"

[[sensor]]
name = "end"
kind = "end_position"
signal = "at_end"
joint = "rail"
from_m = 0.9

[[sensor]]
name = "eye"
kind = "proximity"
signal = "seen"
point_m = [0.0, 0.0, 1.0]
direction = [0.0, 0.0, -1.0]
range_m = 1.5
targets = ["cart"]
"#;

/// What is written instead of what.
const CASES: &[(&str, &str, &str)] = &[
    ("not TOML", "version = 1", "version = "),
    ("no version", "version = 1\n", ""),
    ("a newer version", "version = 1", "version = 2"),
    ("an unknown table", "[[sensor]]\nname = \"eye\"", "[[sensors]]\nname = \"eye\""),
    ("an unknown key", "mass_kg", "mas_kg"),
    ("an unknown kind", "\"dynamic\"", "\"dynamik\""),
    ("a wrong type", "mass_kg = 12.0", "mass_kg = \"12 kg\""),
    ("too few components", "[0.4, 0.2, 0.1]", "[0.4, 0.2]"),
    ("a missing key", "name = \"cart\"\n", ""),
    ("no name", "name = \"rail\"\n", ""),
    ("a doubled body", "name = \"cart\"", "name = \"base\""),
    ("a doubled sensor", "name = \"eye\"", "name = \"end\""),
    ("a reserved name", "name = \"base\"", "name = \"ground\""),
    ("an unknown body", "child = \"cart\"", "child = \"crat\""),
    ("an unknown parent", "parent = \"base\"", "parent = \"gruond\""),
    ("an unknown joint", "joint = \"rail\"\ndrive", "joint = \"rial\"\ndrive"),
    ("an unknown target", "[\"cart\"]", "[\"cart\", \"trolley\"]"),
    ("a negative mass", "12.0", "-12.0"),
    ("a mass that is not a number", "12.0", "nan"),
    ("an infinite size", "[0.4, 0.2, 0.1]", "[0.4, inf, 0.1]"),
    ("no mass", "mass_kg = 12.0", ""),
    ("two masses", "mass_kg = 12.0", "mass_kg = 12.0\ndensity_kg_m3 = 1.0"),
    ("no shape", "shape = \"box\"", ""),
    ("a measure of another shape", "shape = \"box\"", "shape = \"sphere\""),
    ("no direction", "axis = [1.0, 0.0, 0.0]", "axis = [0.0, 0.0, 0.0]"),
    ("no axis", "axis = [1.0, 0.0, 0.0]", ""),
    ("an oblique slot", "kind = \"prismatic\"", "kind = \"slot\"\nslide = [1.0, 1.0, 0.0]"),
    ("limits upside down", "upper_m = 1.0", "upper_m = -2.0"),
    ("a start outside of the limits", "upper_m = 1.0", "upper_m = 1.0\ninitial_m = 3.0"),
    ("a joint with itself", "parent = \"base\"", "parent = \"cart\""),
    ("an immovable joint", "kind = \"dynamic\"", "kind = \"kinematic\""),
    ("the wrong unit", "speed_m_s", "speed_rad_s"),
    ("no speed", "speed_m_s = 0.5\n", ""),
    ("no command", "reverse_signal = \"back\"\n", ""),
    ("a command of another drive", "\"bidirectional\"", "\"velocity\""),
    ("an axis without a motor", "kind = \"prismatic\"", "kind = \"ball\""),
    ("an axis that drives nothing", "joint = \"rail\"\ndrive", "drive"),
    ("a belt that is not a belt", "joint = \"rail\"\ndrive", "belt = \"cart\"\ndirection = [1, 0, 0]\ndrive"),
    ("a belt without a direction", "joint = \"rail\"\ndrive", "belt = \"cart\"\ndrive"),
    ("a bad signal name", "\"at_end\"", "\"at end\""),
    ("a signal written twice", "\"seen\"", "\"position\""),
    ("a signal read and written", "\"seen\"", "\"forth\""),
    ("no substeps", "version = 1", "version = 1\nsubsteps = 0"),
    ("an empty range", "from_m = 0.9", ""),
    ("a key of the other sensor", "range_m = 1.5", "range_m = 1.5\nfrom_m = 1.0"),
];

fn refusal(scene: &str) -> String {
    match Scene::parse(scene, "scene.toml") {
        Ok(_) => "accepted".to_owned(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn the_right_scene_is_accepted() {
    assert_eq!(refusal(RIGHT), "accepted");
}

#[test]
fn every_fault_has_its_place_and_a_hint_where_one_helps() {
    let mut reported = String::new();
    for (title, from, to) in CASES {
        assert!(RIGHT.contains(from), "{title}");
        let refused = refusal(&RIGHT.replacen(from, to, 1));
        writeln!(reported, "{title}\n  {}", refused.replace('\n', "\n  ")).expect("a string grows");
    }
    insta::assert_snapshot!(reported);
}

#[test]
fn a_joint_that_two_axes_drive_names_the_first() {
    let axis = RIGHT.split("\n\n").find(|table| table.starts_with("[[axis]]")).expect("an axis");
    let second = axis.replace("\"drive\"", "\"other\"").replace("\"position\"", "\"position_2\"");
    let refused = refusal(&format!("{RIGHT}\n{second}\n"));
    insta::assert_snapshot!(refused, @"scene.toml:51:9: joint `rail` is driven twice; first by axis `drive`");
}

#[test]
fn a_command_may_be_read_twice_but_as_one_type() {
    let second = r#"
[[body]]
name = "tool"
kind = "dynamic"
shape = "sphere"
radius_m = 0.1
mass_kg = 1.0
[[joint]]
name = "spindle"
kind = "revolute"
parent = "cart"
child = "tool"
axis = [0.0, 0.0, 1.0]
[[axis]]
name = "turn"
joint = "spindle"
drive = "velocity"
command_signal = "rate"
speed_rad_s = 10.0
acceleration_rad_s2 = 100.0
"#;
    let scene = format!("{RIGHT}{second}");
    assert_eq!(refusal(&scene), "accepted");
    assert_eq!(refusal(&scene.replace("\"back\"", "\"forth\"")), "accepted");
    insta::assert_snapshot!(refusal(&scene.replace("\"rate\"", "\"forth\"")), @"scene.toml:65:18: signal `forth` is read both as BOOL and as a number, or as two number types");
}

#[test]
fn all_faults_of_a_scene_are_reported_at_once() {
    let scene =
        RIGHT.replace("12.0", "-1.0").replace("0.5", "0.0").replace("targets = [\"cart\"]", "targets = [\"cat\"]");
    insta::assert_snapshot!(refusal(&scene), @r"
    scene.toml:12:11: `mass_kg` must be a number from 1e-6 to 1e9, not -1
    scene.toml:29:13: `speed_m_s` must be a number above 0, up to 1e9, not 0
    scene.toml:47:12: no body `cat` in this scene (did you mean `cart`?)
    ");
}
