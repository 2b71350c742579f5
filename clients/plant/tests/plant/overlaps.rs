//! Bodies that are in each other at the start.

use onescan_plant::Scene;

/// A carriage over a fixed rail whose top is at z = 0, with more keys of the carriage, and more tables.
fn scene(height_m: f64, carriage: &str, more: &str) -> Scene {
    let text = format!(
        r#"
version = 1
[[body]]
name = "rail"
kind = "fixed"
shape = "box"
size_m = [2.0, 0.2, 0.1]
position_m = [0.0, 0.0, -0.05]
[[body]]
name = "carriage"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.1]
mass_kg = 5.0
position_m = [0.0, 0.0, {z:?}]
{carriage}
{more}
"#,
        z = height_m + 0.05
    );
    Scene::parse(&text, "plant.toml").unwrap_or_else(|error| panic!("{error}"))
}

const SLIDE: &str = r#"
[[joint]]
name = "slide"
kind = "prismatic"
parent = "ground"
child = "carriage"
axis = [1.0, 0.0, 0.0]
"#;

#[test]
fn what_is_in_another_body_is_named_with_its_depth() {
    let found = scene(-1e-4, "", SLIDE).overlaps();
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].bodies, ["rail", "carriage"]);
    assert!((found[0].depth_m - 1e-4).abs() < 1e-12, "{found:?}");
    assert_eq!(found[0].to_string(), "`rail` and `carriage` overlap by 0.100 mm");
}

#[test]
fn what_touches_is_not_in_each_other() {
    for height_m in [0.1, 1e-4, 0.0, -9e-7] {
        assert_eq!(scene(height_m, "", SLIDE).overlaps(), [], "{height_m}");
    }
}

#[test]
fn what_does_not_collide_does_not_count() {
    assert_eq!(scene(-0.01, "collides = false", SLIDE).overlaps(), []);
    let on_rail = SLIDE.replace("\"ground\"", "\"rail\"");
    assert_eq!(scene(-0.01, "", &on_rail).overlaps(), [], "a joint keeps them apart");
    let collides = format!("{on_rail}contacts = true\n");
    assert_eq!(scene(-0.01, "", &collides).overlaps().len(), 1);
    let second = "[[body]]\nname = \"wall\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\n";
    let belt = second.replace("wall", "belt").replace("fixed", "kinematic");
    assert_eq!(scene(1.0, "", &format!("{second}{belt}")).overlaps(), [], "no force moves any of them");
}

#[test]
fn workpieces_that_wait_do_not_count() {
    let more = |source: &str| {
        format!(
            "[[body]]\nname = \"can[0..2]\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.05\nmass_kg = 0.1\n\
             position_m = [0.0, 0.0, -5.0]\n{source}"
        )
    };
    let source = "[[component]]\nname = \"source\"\nkind = \"workpiece_source\"\nbody = \"rail\"\n\
                  targets = [\"can[0..2]\"]\nrelease_signal = \"Release\"\n";
    assert_eq!(scene(1.0, "", &more(source)).overlaps(), []);
    let found = scene(1.0, "", &more("")).overlaps();
    let names: Vec<_> = found.iter().map(|overlap| overlap.bodies.join(" ")).collect();
    assert_eq!(names, ["can[0] can[1]", "can[0] can[2]", "can[1] can[2]"]);
}

#[test]
fn of_several_shapes_the_deepest_counts() {
    let foot = "[[shape]]\nname = \"foot\"\nbody = \"carriage\"\nshape = \"box\"\nsize_m = [0.05, 0.05, 0.05]\n\
                mass_kg = 0.1\nposition_m = [0.0, 0.0, 0.02]\n";
    let found = scene(-0.001, "", foot).overlaps();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0].depth_m - 0.005).abs() < 1e-9, "{found:?}");
}
