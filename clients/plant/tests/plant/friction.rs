//! How the friction of two bodies becomes one: a box that slides down a slope.

use crate::bench::Bench;

const G: f64 = 9.81;
/// Of the slope.
const ANGLE_DEG: f64 = 20.0;

/// How far a box slides down the slope in a second, m.
fn slid(top: &str, box_keys: &str, slope_keys: &str) -> f64 {
    let scene = format!(
        r#"
version = 1
{top}
[[body]]
name = "slope"
kind = "fixed"
shape = "box"
size_m = [40.0, 2.0, 0.2]
rpy_deg = [0.0, {ANGLE_DEG}, 0.0]
{slope_keys}
[[body]]
name = "box"
kind = "dynamic"
shape = "box"
size_m = [0.4, 0.4, 0.2]
mass_kg = 1.0
position_m = [{x}, 0.0, {z}]
rpy_deg = [0.0, {ANGLE_DEG}, 0.0]
{box_keys}
"#,
        x = 0.2 * libm::sin(ANGLE_DEG.to_radians()),
        z = 0.2 * libm::cos(ANGLE_DEG.to_radians()),
    );
    let mut bench = Bench::new(&scene);
    let x = |bench: &Bench| bench.plant.poses().find(|pose| pose.name == "box").expect("there").position_m[0];
    let start = x(&bench);
    (0..100).for_each(|_| bench.turn());
    (x(&bench) - start) / libm::cos(ANGLE_DEG.to_radians())
}

/// `g (sin α - µ cos α) t²/2`, or nothing where the friction holds.
fn exact(friction: f64) -> f64 {
    let (sin, cos) = libm::sincos(ANGLE_DEG.to_radians());
    (0.5 * G * (sin - friction * cos)).max(0.0)
}

#[test]
fn ice_on_rubber_is_what_the_rule_says() {
    let (ice, rubber) = ("friction = 0.02", "friction = 1.0");
    let with = |rule: &str| format!("{ice}\nfriction_rule = \"{rule}\"");
    // the mean, 0.51, holds the box at 20°, of which the tangent is 0.36
    assert!(slid("", ice, rubber) < 1e-3);
    assert!(slid("", &with("greatest"), rubber) < 1e-3);
    for slides in
        [slid("", &with("least"), rubber), slid("", rubber, &with("least")), slid("", &with("product"), rubber)]
    {
        // first order in the step of 10 ms
        assert!((slides / exact(0.02) - 1.0).abs() < 0.02, "{slides} {}", exact(0.02));
    }
    assert!((slid("", &with("product"), "friction = 0.5") / exact(0.01) - 1.0).abs() < 0.02);
}

#[test]
fn of_two_rules_the_later_holds_and_the_scene_has_one_for_all() {
    let (ice, rubber) = ("friction = 0.02\n", "friction = 1.0\n");
    let for_all = "friction_rule = \"least\"";
    assert!((slid(for_all, ice, rubber) / exact(0.02) - 1.0).abs() < 0.02);
    assert!(slid(for_all, ice, &format!("{rubber}friction_rule = \"greatest\"")) < 1e-3);
    let least_and_product = slid(for_all, "friction = 0.5", "friction = 0.5\nfriction_rule = \"product\"");
    assert!((least_and_product / exact(0.25) - 1.0).abs() < 0.02, "{least_and_product}");
}
