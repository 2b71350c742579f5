//! A plant's state is a value: saved, restored, repeated, to the bit.

use std::fmt::Write as _;

use onescan_plant::Plant;
use onescan_server::client::{Client, StateError};
use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;

use crate::bench::{Bench, PERIOD};
use crate::shear::SHEAR;

/// A heap that falls together on a table which a drive tilts: contacts, friction, a revolute axis.
const HEAP: &str = r#"
    version = 1
    [[body]]
    name = "table"
    kind = "dynamic"
    shape = "box"
    size_m = [2.0, 2.0, 0.1]
    mass_kg = 50.0
    [[body]]
    name = "a"
    kind = "dynamic"
    shape = "box"
    size_m = [0.2, 0.2, 0.2]
    mass_kg = 3.0
    position_m = [0.0, 0.0, 0.2]
    [[body]]
    name = "b"
    kind = "dynamic"
    shape = "box"
    size_m = [0.2, 0.2, 0.2]
    density_kg_m3 = 400.0
    position_m = [0.05, 0.02, 0.45]
    rpy_deg = [10.0, 20.0, 30.0]
    [[body]]
    name = "c"
    kind = "dynamic"
    shape = "cylinder"
    radius_m = 0.1
    length_m = 0.3
    mass_kg = 2.0
    position_m = [-0.05, 0.0, 0.8]
    [[body]]
    name = "d"
    kind = "dynamic"
    shape = "capsule"
    radius_m = 0.05
    length_m = 0.3
    mass_kg = 2.0
    position_m = [0.0, 0.1, 1.1]
    rpy_deg = [80.0, 0.0, 0.0]
    [[joint]]
    name = "hinge"
    kind = "revolute"
    parent = "ground"
    child = "table"
    axis = [0.0, 1.0, 0.0]
    [[axis]]
    name = "tilt"
    joint = "hinge"
    drive = "velocity"
    command_signal = "tilt"
    speed_rad_s = 1.0
    acceleration_rad_s2 = 2.0
    position_signal = "angle"
    velocity_signal = "rate"
    [[sensor]]
    name = "gate"
    kind = "proximity"
    signal = "gate"
    point_m = [0.5, -1.0, 0.0]
    direction = [0.0, 1.0, 0.0]
    range_m = 2.0
"#;

/// What is commanded in turn `k`: a fixed pattern that no part of the plant knows.
fn command(bench: &mut Bench, k: usize) {
    if bench.inputs.len() == 8 {
        bench.command("tilt", if k % 40 < 25 { 0.6 } else { -0.8 });
    } else {
        for (index, input) in bench.inputs.iter_mut().enumerate() {
            *input = u8::from((k / 7 + index).is_multiple_of(3));
        }
    }
}

/// Outputs and state after every turn, the set-up first.
fn run(bench: &mut Bench, turns: usize) -> Vec<(Vec<u8>, Vec<u8>)> {
    let mut trace = vec![(bench.outputs.clone(), bench.plant.save().expect("a state"))];
    for k in 0..turns {
        command(bench, k);
        bench.turn();
        trace.push((bench.outputs.clone(), bench.plant.save().expect("a state")));
    }
    trace
}

/// Restores a new plant from every turn of a run and goes on for `horizon` turns.
fn restore_everywhere(scene: &str, turns: usize, horizon: usize) {
    let trace = run(&mut Bench::new(scene), turns);
    let mut bench = Bench::new(scene);
    for k in 0..turns {
        bench.plant.restore(&trace[k].1).expect("a state");
        assert!(bench.plant.save().expect("a state") == trace[k].1, "turn {k} is saved as it was restored");
        bench.outputs.clone_from(&trace[k].0);
        for (later, (outputs, state)) in trace.iter().enumerate().take(k + 1 + horizon).skip(k + 1) {
            command(&mut bench, later - 1);
            bench.turn();
            assert!(bench.outputs == *outputs, "outputs of turn {later} after a restore at {k}");
            assert!(later < k + horizon || bench.plant.save().expect("a state") == *state, "state of turn {later}");
        }
    }
}

#[test]
fn a_restored_shear_goes_on_to_the_bit() {
    restore_everywhere(SHEAR, 120, 120);
}

#[test]
fn a_restored_heap_goes_on_to_the_bit() {
    restore_everywhere(HEAP, 150, 20);
}

/// The bits of a run are the same on every machine and in every build; a change of them is a change
/// of the plant, to be described in the change log.
#[test]
fn a_run_is_the_same_everywhere() {
    let digest = |scene: &str| {
        let mut hasher = blake3::Hasher::new();
        for (outputs, _) in run(&mut Bench::new(scene), 300) {
            hasher.update(&outputs);
        }
        hasher.finalize().to_hex()[..16].to_owned()
    };
    assert_eq!([digest(SHEAR), digest(HEAP)], ["13230320f80b11a7", "8d93584ac34909c5"]);
}

#[test]
fn two_plants_are_one() {
    for scene in [SHEAR, HEAP] {
        assert!(run(&mut Bench::new(scene), 200) == run(&mut Bench::new(scene), 200));
    }
}

#[test]
fn a_reset_plant_is_a_new_one() {
    for scene in [SHEAR, HEAP] {
        let mut bench = Bench::new(scene);
        let first = run(&mut bench, 100);
        bench.set_up();
        assert!(run(&mut bench, 100) == first);
    }
}

#[test]
fn a_plant_that_was_never_set_up_can_be_restored() {
    let trace = run(&mut Bench::new(SHEAR), 10);
    let name = Bench::new(SHEAR).plant.join().name;
    let mut plant = Plant::parse(SHEAR, "scene.toml", name, PERIOD).expect("a scene");
    assert!(plant.save().is_err(), "it has no state yet");
    plant.restore(&trace[5].1).expect("a state");
    assert!(plant.save().expect("a state") == trace[5].1);
}

#[test]
fn a_state_of_another_plant_is_refused() {
    let state = Bench::new(HEAP).plant.save().expect("a state");
    let error = Bench::new(SHEAR).plant.restore(&state).expect_err("refused");
    assert!(error.to_string().contains("another scene"), "{error}");
}

/// Restores every state of a run, in an order that goes back and forth, into one plant that runs and
/// into a new one; both are then the same, and stay so.
#[test]
fn a_running_plant_takes_a_state_as_a_new_one_does() {
    for scene in [SHEAR, HEAP] {
        let trace = run(&mut Bench::new(scene), 120);
        let mut running = Bench::new(scene);
        run(&mut running, 90);
        for k in (0..120).map(|k| (k * 37) % 120) {
            let mut new = Bench::new(scene);
            for bench in [&mut running, &mut new] {
                bench.plant.restore(&trace[k].1).expect("a state");
                bench.outputs.clone_from(&trace[k].0);
            }
            for later in k..(k + 8).min(120) {
                command(&mut running, later);
                command(&mut new, later);
                running.turn();
                new.turn();
                assert!(running.outputs == trace[later + 1].0 && new.outputs == trace[later + 1].0, "{k} {later}");
            }
            assert!(running.plant.save() == new.plant.save(), "{k}");
        }
    }
}

/// The same scene with something else in it, and what a refusal says of it.
#[test]
fn a_refusal_says_what_differs() {
    let cases = [
        ("speed_rad_s = 1.0", "speed_rad_s = 1.5"),
        ("size_m = [2.0, 2.0, 0.1]", "size_m = [2.0, 2.0, 0.2]"),
        ("mass_kg = 50.0", "mass_kg = 51"),
        ("name = \"hinge\"", "name = \"pivot\""),
        ("version = 1", "version = 1\nsubsteps = 4"),
        ("range_m = 2.0", "range_m = 2.5\ntargets = [\"a\"]"),
        ("[[sensor]]", "[[component]]\nname = \"line\"\nkind = \"asynchronous_motor\"\n[[sensor]]"),
    ];
    let mut reported = String::new();
    let state = Bench::new(HEAP).plant.save().expect("a state");
    for (from, to) in cases {
        assert!(HEAP.contains(from), "{from}");
        let other = HEAP
            .replacen(from, to, 1)
            .replace("joint = \"hinge\"", if to.contains("pivot") { "joint = \"pivot\"" } else { "joint = \"hinge\"" });
        writeln!(reported, "{}", Bench::new(&other).plant.restore(&state).expect_err("refused"))
            .expect("a string grows");
    }
    let cylinder = |settings: &str| {
        let scene = "version = 1\n[[component]]\nname = \"clamp\"\nkind = \"pneumatic_cylinder\"\nstroke_m = 0.3\n";
        Bench::new(&format!("{scene}{settings}"))
    };
    let clamp = cylinder("extend_signal = \"Go\"\n").plant.save().expect("a state");
    for settings in ["moving_kg = 2\nextend_signal = \"Go\"\n", "extend_signal = \"Gone\"\n"] {
        let refused = cylinder(settings).plant.restore(&clamp).expect_err("refused");
        writeln!(reported, "{refused}").expect("a string grows");
    }
    let named = |name: &str| ClientName::new(name).expect("a name");
    let span = |ms| TimeSpan::from_millis(ms).expect("not zero");
    let plant = |name: &str, ms| Plant::parse(HEAP, "scene.toml", named(name), span(ms)).expect("a scene");
    for (name, ms, seed) in [("other", 10, 0), ("plant", 20, 0), ("plant", 10, 7)] {
        let mut other = plant(name, ms).seeded(seed);
        writeln!(reported, "{}", other.restore(&state).expect_err("refused")).expect("a string grows");
    }
    insta::assert_snapshot!(reported);
}

#[test]
fn comments_do_not_change_whose_state_it_is() {
    let state = Bench::new(SHEAR).plant.save().expect("a state");
    let commented = format!("# a comment\n{SHEAR}");
    Bench::new(&commented).plant.restore(&state).expect("the same plant");
}

#[test]
fn a_cut_or_damaged_state_is_refused() {
    let mut bench = Bench::new(SHEAR);
    let state = bench.plant.save().expect("a state");
    for length in (0..state.len()).step_by(7).chain([state.len() - 1]) {
        assert!(matches!(bench.plant.restore(&state[..length]), Err(StateError::Corrupt(_))), "{length}");
    }
    for at in (0..state.len()).step_by(11) {
        let mut damaged = state.clone();
        damaged[at] ^= 0x10;
        assert!(matches!(bench.plant.restore(&damaged), Err(StateError::Corrupt(_))), "{at}");
    }
    assert!(bench.plant.save().expect("a state") == state, "a refused state changes nothing");
}
