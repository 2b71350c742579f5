//! What scenes ask for beyond what the plant can carry.

use std::fmt::Write as _;

use onescan_plant::{Excess, Scene};
use onescan_server::time::TimeSpan;

fn scene(more: &str) -> Scene {
    let text = format!("version = 1\ngravity_m_s2 = [0.0, 0.0, 0.0]\n{more}");
    Scene::parse(&text, "plant.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn excesses(more: &str, period_us: u64) -> Vec<Excess> {
    scene(more).excesses(TimeSpan::from_micros(period_us).expect("not zero"))
}

fn said(more: &str, period_us: u64) -> Vec<String> {
    excesses(more, period_us).iter().map(ToString::to_string).collect()
}

/// Two masses of 1 and 3 kg, one on the other, with a spring of 3 N/m·rad²/s² between them.
fn two_masses(spring: f64, damping: f64) -> String {
    let body = |name: &str, x: f64, kg: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\n\
             position_m = [{x:?}, 0.0, 0.0]\nmass_kg = {kg:?}\n"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"prismatic\"\nparent = \"{parent}\"\nchild = \"{child}\"\n\
             axis = [1, 0, 0]\n"
        )
    };
    format!(
        "{}{}{}{}[[fitting]]\nname = \"bar\"\njoint = \"second\"\nspring_n_m = {spring:?}\ndamping_n_s_m = {damping:?}\n",
        body("a", 0.0, 1.0),
        body("b", 1.0, 3.0),
        joint("first", "ground", "a"),
        joint("second", "a", "b")
    )
}

#[test]
fn a_spring_that_swings_within_three_steps_is_named_with_the_step_that_would_do() {
    // of 0.75 kg, their reduced mass: 400 rad/s, 63.66 Hz, a third of whose time is 5.24 ms
    let bar = two_masses(0.75 * 400.0 * 400.0, 0.0);
    let found = excesses(&bar, 10_000);
    let [Excess::Swing { fitting, joint, hz, step_s }] = &found[..] else { panic!("{found:?}") };
    assert_eq!((fitting.as_str(), joint.as_str(), *step_s), ("bar", "second", 0.005));
    assert!((hz - 400.0 / std::f64::consts::TAU).abs() < 1e-9, "{hz}");
    assert_eq!(
        said(&bar, 10_000),
        ["the spring of `bar` on joint `second` swings with 63.7 Hz, which takes a physics step of 5 ms"]
    );
    assert!(said(&bar, 5_000).is_empty() && said(&bar, 1_000).is_empty());
    let finer = format!("substeps = 2\n{bar}");
    assert!(said(&finer, 10_000).is_empty(), "substeps make the step finer");
}

#[test]
fn a_damper_that_is_faster_than_a_third_of_a_step_is_named() {
    // 0.75 kg / 300 N s/m: 2.5 ms
    let bar = two_masses(0.0, 300.0);
    let wanted =
        "the damping of `bar` on joint `second` has a time constant of 2.500 ms, which takes a physics step of 5 ms";
    assert_eq!(said(&bar, 10_000), [wanted]);
    assert!(said(&bar, 5_000).is_empty());
    // critical damping at 1000 rad/s: it fades with 1 ms
    let critical = two_masses(0.75e6, 1500.0);
    assert!(said(&critical, 10_000)[0].contains("time constant of 1.000 ms"), "{:?}", said(&critical, 10_000));
}

#[test]
fn a_drive_that_holds_a_joint_and_a_coupling_make_it_heavier() {
    let axis = "[[axis]]\nname = \"x\"\njoint = \"first\"\ndrive = \"position\"\ncommand_signal = \"C\"\n\
                speed_m_s = 1.0\nacceleration_m_s2 = 1.0\n";
    // 3 kg in place of 0.75: 200 rad/s
    let bar = two_masses(0.75 * 400.0 * 400.0, 0.0);
    let held = format!("{bar}{axis}");
    assert!(said(&held, 20_000)[0].contains("swings with 31.8 Hz"), "{:?}", said(&held, 20_000));
    // the first goes as the second does, and b so moves by 2 m where a moves by 1: 1 + 3·4 = 13 kg
    let geared = format!("{bar}[[coupling]]\nname = \"gear\"\njoint = \"first\"\nof = [\"second\"]\nratio = [1.0]\n");
    let found = excesses(&geared, 50_000);
    let [Excess::Swing { hz, .. }] = &found[..] else { panic!("{found:?}") };
    assert!((hz * std::f64::consts::TAU - (120_000.0_f64 / 13.0).sqrt()).abs() < 1e-9, "{hz}");
}

#[test]
fn masses_that_touch_or_are_joined_are_compared() {
    let pair = |light: f64, gap: f64| {
        let body = |name: &str, z: f64, kg: f64| {
            format!(
                "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\n\
                 position_m = [0.0, 0.0, {z:?}]\nmass_kg = {kg:?}\n"
            )
        };
        format!("{}{}", body("pallet", 0.0, 500.0), body("label", 0.1 + gap, light))
    };
    let wanted = "`pallet` has 50000 times the mass of `label`, which touches it or is joined to it";
    assert_eq!(said(&pair(0.01, 0.0), 10_000), [wanted]);
    assert!(said(&pair(0.06, 0.0), 10_000).is_empty());
    assert!(said(&pair(0.01, 0.5), 10_000).is_empty(), "they are apart");
    let joint =
        "[[joint]]\nname = \"slide\"\nkind = \"prismatic\"\nparent = \"pallet\"\nchild = \"label\"\naxis = [0, 0, 1]\n";
    assert_eq!(said(&format!("{}{joint}", pair(0.01, 0.5)), 10_000), [wanted]);
}

/// A mesh as a ball of so many points.
fn ball(points: usize) -> String {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let mut text = String::new();
    for k in 0..points {
        let z = 1.0 - 2.0 * (k as f64 + 0.5) / points as f64;
        let (r, turned) = ((1.0 - z * z).sqrt(), golden * k as f64);
        writeln!(text, "v {} {} {z}", r * turned.cos(), r * turned.sin()).expect("a text");
    }
    for k in 3..=points {
        writeln!(text, "f {} {} {k}", k - 2, k - 1).expect("a text");
    }
    text
}

#[test]
fn a_hull_of_many_points_is_named_where_it_collides() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("ball.obj"), ball(1500)).expect("written");
    let found = |keys: &str| {
        let text = format!(
            "version = 1\n[[body]]\nname = \"ball\"\nkind = \"dynamic\"\nshape = \"mesh\"\nmesh = \"ball.obj\"\n\
             mass_kg = 1.0\n{keys}\n"
        );
        let within = onescan_base::regular::Within::places(vec![folder.path().to_path_buf()]);
        let file = folder.path().join("plant.toml").display().to_string();
        let scene = Scene::parse_with(&text, &file, &[], &within).unwrap_or_else(|error| panic!("{error}"));
        scene.excesses(TimeSpan::from_millis(10).expect("not zero"))
    };
    assert_eq!(found("").iter().map(ToString::to_string).collect::<Vec<_>>(), ["the hull of `ball` has 1500 points"]);
    assert_eq!(found("collides = false"), []);
}
