//! Failures that are switched while the plant runs, beside those of the scene.

use onescan_plant::{FailureRefused, Placement, Plant, Scene};
use onescan_server::client::Client;
use onescan_server::signal::ClientName;

use crate::bench::{Bench, PERIOD};

/// A door that air moves, its light barrier, a belt with a box and a gripper over it.
const CELL: &str = r#"
version = 1
[[body]]
name = "belt"
kind = "kinematic"
shape = "box"
size_m = [4.0, 0.4, 0.1]
friction = 1.0
[[body]]
name = "box"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.2]
mass_kg = 2.0
friction = 1.0
position_m = [-1.5, 0.0, 0.15]
[[component]]
name = "conveyor"
kind = "conveyor"
belt = "belt"
direction = [1, 0, 0]
speed_m_s = 0.5
run_signal = "Run"
velocity_m_s_signal = "Speed"
travel_m_signal = "Travel"
[[component]]
name = "door"
kind = "pneumatic_cylinder"
stroke_m = 0.3
extend_signal = "Open"
position_m_signal = "Door"
extended_signal = "Opened"
[[component]]
name = "eye"
kind = "light_barrier"
point_m = [-1.0, -1.0, 0.15]
direction = [0, 1, 0]
range_m = 2.0
targets = ["box"]
detected_signal = "Box_Here"
[[component]]
name = "gauge"
kind = "pressure_sensor"
pressure_bar_from = "door.cap_bar"
measured_bar_signal = "Pressure"
noise_bar = 0.02
[[signal]]
name = "Pressure"
type = "INT"
range = [0.0, 10.0]
raw = [0, 27648]
delay_s = 0.05
jitter_s = 0.01
"#;

const MODES: &[(&str, &str)] =
    &[("conveyor", "slipping"), ("door", "no_supply"), ("eye", "dirty"), ("gauge", "frozen")];

fn command(bench: &mut Bench, turn: u64) {
    bench.command("Run", turn % 150 < 120);
    bench.command("Open", turn % 90 < 45);
}

/// A digest of all outputs of so many turns, the set-up's first; `before` acts just before each turn.
fn digest(bench: &mut Bench, turns: u64, mut before: impl FnMut(&mut Plant, u64)) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&bench.outputs);
    for turn in 1..=turns {
        command(bench, turn);
        before(&mut bench.plant, turn);
        bench.turn();
        hasher.update(&bench.outputs);
    }
    hasher.finalize()
}

fn scheduled((component, mode): (&str, &str), from_s: f64, until_s: f64) -> String {
    format!(
        "{CELL}[[failure]]\ncomponent = \"{component}\"\nmode = \"{mode}\"\nfrom_s = {from_s}\nuntil_s = {until_s}\n"
    )
}

#[test]
fn a_failure_by_hand_is_one_of_the_scene() {
    let healthy = digest(&mut Bench::new(CELL), 300, |_, _| {});
    for &(component, mode) in MODES {
        let mut by_scene = Bench::new(&scheduled((component, mode), 0.7, 1.9));
        let wanted = digest(&mut by_scene, 300, |_, _| {});
        assert_ne!(wanted, healthy, "{component} {mode}");
        let mut by_hand = Bench::new(CELL);
        let given = digest(&mut by_hand, 300, |plant, turn| match turn {
            70 => plant.fail(component, mode).expect("a mode of the component"),
            190 => plant.repair(component, mode).expect("it has failed"),
            _ => (),
        });
        assert_eq!(given, wanted, "{component} {mode}");
        assert!(by_hand.plant.save() == by_scene.plant.save(), "{component} {mode}: the end is the same state");
    }
}

#[test]
fn a_failure_from_the_set_up_is_one_of_the_scene() {
    for &(component, mode) in MODES {
        let wanted = digest(&mut Bench::new(&scheduled((component, mode), 0.0, 100.0)), 100, |_, _| {});
        let mut bench = Bench::new(CELL);
        let failing = [(component.to_owned(), mode.to_owned())];
        bench.outputs.fill(0);
        bench.plant.set_up(&failing, &mut bench.outputs).expect("a set-up");
        assert_eq!(digest(&mut bench, 100, |_, _| {}), wanted, "{component} {mode}");
    }
}

#[test]
fn a_mode_is_on_while_scene_or_hand_say_so() {
    let mut bench = Bench::new(&scheduled(("conveyor", "torn"), 0.0, 0.5));
    bench.command("Run", true);
    bench.plant.fail("conveyor", "torn").expect("a mode");
    bench.plant.fail("conveyor", "torn").expect("a mode that is on stays on");
    (0..60).for_each(|_| bench.turn());
    assert_eq!(bench.read::<f64>("Travel"), 0.0, "torn by hand after the scene's switch");
    bench.plant.repair("conveyor", "torn").expect("it has failed");
    (0..60).for_each(|_| bench.turn());
    assert!(bench.read::<f64>("Travel") > 0.0);
    bench.set_up();
    bench.plant.fail("conveyor", "torn").expect("a mode");
    bench.plant.repair("conveyor", "torn").expect("it has failed");
    (0..40).for_each(|_| bench.turn());
    assert_eq!(bench.read::<f64>("Travel"), 0.0, "a repair does not end what the scene says");
}

#[test]
fn a_state_goes_into_the_same_plant_whatever_has_failed() {
    let mut healthy = Bench::new(CELL);
    let _ = digest(&mut healthy, 100, |_, _| {});
    let state = healthy.plant.save().expect("a state");
    let failing = |plant: &mut Plant, turn| {
        if turn == 50 {
            plant.fail("door", "no_supply").expect("a mode");
        }
    };
    let mut failed = Bench::new(CELL);
    let _ = digest(&mut failed, 100, failing);
    let failed_state = failed.plant.save().expect("a state");
    assert!(state != failed_state);

    // the failed plant is healthy with the healthy one's state, and the reverse
    failed.plant.restore(&state).expect("the same plant");
    healthy.plant.restore(&failed_state).expect("the same plant");
    assert!(failed.plant.save() == Ok(state.clone()) && healthy.plant.save() == Ok(failed_state));
    assert!(matches!(failed.plant.repair("door", "no_supply"), Err(FailureRefused::NotFailed { .. })));
    healthy.plant.repair("door", "no_supply").expect("it has failed");

    // a scene with a failure is the same plant too
    let mut scheduled = Bench::new(&scheduled(("eye", "dirty"), 5.0, 6.0));
    scheduled.plant.restore(&state).expect("the same plant");
    assert!(scheduled.plant.save() == Ok(state));
}

#[test]
fn what_cannot_fail_is_refused_in_the_words_of_a_scene() {
    let scene = Scene::parse(CELL, "scene.toml").expect("a scene");
    let mut plant = Bench::new(CELL).plant;
    let wrong = [("dor", "no_supply"), ("press", "no_supply"), ("door", "no_suply"), ("conveyor", "burst")];
    for (component, mode) in wrong {
        let refused = plant.fail(component, mode).expect_err("refused").to_string();
        assert_eq!(plant.repair(component, mode).expect_err("refused").to_string(), refused);
        assert_eq!(scene.check_failure(component, mode).expect_err("refused").to_string(), refused);
        let written = Scene::parse(&scheduled((component, mode), 0.0, 1.0), "scene.toml").expect_err("refused");
        assert_eq!(written.faults().len(), 1);
        assert!(written.to_string().ends_with(&refused), "{written}\n{refused}");
        let failing = [(component.to_owned(), mode.to_owned())];
        let mut outputs = vec![0; Bench::new(CELL).outputs.len()];
        assert_eq!(plant.set_up(&failing, &mut outputs).expect_err("refused").to_string(), refused);
    }
    insta::assert_snapshot!(plant.fail("conveyor", "burst").expect_err("refused"), @"component `conveyor` has no failure mode `burst` (it may be `torn`, `slipping`)");
    insta::assert_snapshot!(plant.fail("dor", "torn").expect_err("refused"), @"no component `dor` in this scene (did you mean `door`?)");
    insta::assert_snapshot!(plant.repair("door", "no_supply").expect_err("refused"), @"component `door` has not been made to fail by `no_supply`, so it cannot be repaired");
    let name = ClientName::new("plant").expect("a name");
    let mut new = Plant::new(scene, name, PERIOD);
    insta::assert_snapshot!(new.fail("door", "no_supply").expect_err("refused"), @"component `door` cannot fail or be repaired before the set-up");
}

#[test]
fn poses_are_copied_without_names() {
    let mut bench = Bench::new(CELL);
    let mut poses = vec![Placement { position_m: [9.0; 3], rotation_xyzw: [0.0; 4] }; 7];
    for _ in 0..10 {
        bench.turn();
        bench.plant.write_poses(&mut poses);
        let named: Vec<_> = bench.plant.poses().collect();
        assert_eq!(named.iter().map(|pose| pose.name).collect::<Vec<_>>(), ["belt", "box"]);
        let bare = named.iter().map(|pose| (pose.position_m, pose.rotation_xyzw));
        assert!(bare.eq(poses.iter().map(|pose| (pose.position_m, pose.rotation_xyzw))));
    }
}
