//! Parameters that change while the plant runs: the component keeps its state, and what it is built with stays.

use onescan_plant::{ParameterRefused, Plant, Scene};
use onescan_server::client::{Client, ClientOperation};

use crate::bench::Bench;

/// A tank that is filled, a belt, a door on a joint and one without.
const CELL: &str = r#"
version = 1
[[body]]
name = "belt"
kind = "kinematic"
shape = "box"
size_m = [4.0, 0.4, 0.1]
[[body]]
name = "rod"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 2.0
position_m = [0.0, 3.0, 1.0]
[[joint]]
name = "slide"
kind = "prismatic"
parent = "ground"
child = "rod"
axis = [1, 0, 0]
[[component]]
name = "conveyor"
kind = "conveyor"
belt = "belt"
direction = [1, 0, 0]
speed_m_s = 0.5
acceleration_m_s2 = 100.0
run_signal = "Run"
velocity_m_s_signal = "Speed"
travel_m_signal = "Travel"
[[component]]
name = "tank"
kind = "tank"
pump_signal = "Pump"
level_m_signal = "Level"
[[component]]
name = "door"
kind = "pneumatic_cylinder"
stroke_m = 0.3
extend_signal = "Open"
position_m_signal = "Door"
[[component]]
name = "bolt"
kind = "pneumatic_cylinder"
joint = "slide"
stroke_m = 0.2
extend_signal = "Open"
[[component]]
name = "gate"
kind = "gate"
function = "and"
inputs = 3
in_1_signal = "Run"
in_3_signal = "Open"
out_signal = "Both"
"#;

fn running() -> Bench {
    let mut bench = Bench::new(CELL);
    bench.command("Run", true);
    bench.command("Open", true);
    bench.command("Pump", 1.0);
    (0..50).for_each(|_| bench.turn());
    bench
}

fn speed(bench: &mut Bench) -> f64 {
    (0..5).for_each(|_| bench.turn());
    bench.read("Speed")
}

#[test]
fn a_component_goes_on_from_its_state_with_another_value() {
    let mut bench = running();
    let (travel, level) = (bench.read::<f64>("Travel"), bench.read::<f64>("Level"));
    bench.plant.change_parameter("conveyor", "speed_m_s", "0.2").expect("a number");
    bench.plant.change_parameter("tank", "area_m2", "10").expect("a number");
    assert_eq!(speed(&mut bench), 0.2);
    assert!((bench.read::<f64>("Travel") - travel - 0.2 * 0.05).abs() < 0.01, "from where it was");
    assert!((bench.read::<f64>("Level") - level) < 0.01, "a level rises slowly in a wide tank");
    bench.plant.change_parameter("conveyor", "speed_m_s", "0.7").expect("a number");
    assert_eq!(speed(&mut bench), 0.7, "the last value counts");
    bench.plant.restore_parameter("conveyor", "speed_m_s").expect("it has changed");
    assert_eq!(speed(&mut bench), 0.5);
    bench.set_up();
    bench.command("Run", true);
    assert_eq!(speed(&mut bench), 0.5, "a set-up forgets what has changed");
}

#[test]
fn a_state_has_what_has_changed() {
    let (mut one, mut other) = (running(), running());
    let healthy = one.plant.save().expect("a state");
    one.plant.change_parameter("conveyor", "speed_m_s", "0.2").expect("a number");
    one.turn();
    let changed = one.plant.save().expect("a state");
    assert!(changed != healthy);
    other.plant.restore(&changed).expect("the same plant");
    other.t_v = one.t_v;
    other.inputs.clone_from(&one.inputs);
    for _ in 0..20 {
        one.turn();
        other.turn();
        assert_eq!(one.outputs, other.outputs);
    }
    assert!(one.plant.save() == other.plant.save());
    // and the healthy state has not
    other.plant.restore(&healthy).expect("the same plant");
    assert_eq!(speed(&mut other), 0.5);
    assert!(matches!(other.plant.restore_parameter("conveyor", "speed_m_s"), Err(ParameterRefused::Unchanged { .. })));
}

#[test]
fn a_change_at_the_set_up_is_the_scene_with_that_value() {
    let slow = CELL.replace("speed_m_s = 0.5", "speed_m_s = 0.2");
    let mut by_scene = Bench::new(&slow);
    let mut by_hand = Bench::new(CELL);
    let change = ClientOperation::ChangeParameter {
        component: "conveyor".to_owned(),
        parameter: "speed_m_s".to_owned(),
        value: "0.2".to_owned(),
    };
    by_hand.plant.begin(&[change], &mut by_hand.outputs).expect("a set-up");
    for bench in [&mut by_scene, &mut by_hand] {
        bench.command("Run", true);
    }
    for _ in 0..100 {
        by_scene.turn();
        by_hand.turn();
        assert_eq!(by_scene.outputs, by_hand.outputs);
    }
}

#[test]
fn what_cannot_change_is_refused_by_name_and_changes_nothing() {
    let scene = Scene::parse(CELL, "scene.toml").expect("a scene");
    let mut bench = running();
    let before = bench.plant.save().expect("a state");
    let refused = |plant: &mut Plant, component: &str, parameter: &str, value: &str| {
        let refused = plant.change_parameter(component, parameter, value).expect_err("refused").to_string();
        let checked = scene.check_parameter(component, parameter, value).expect_err("refused").to_string();
        assert_eq!(refused, checked, "before a run in the same words");
        refused
    };
    let wrong = [
        ("conveyer", "speed_m_s", "1"),
        ("conveyor", "speed", "1"),
        ("conveyor", "speed_m_s", "fast"),
        ("conveyor", "speed_m_s", "-1e9"),
        ("tank", "initial_m", "0.5"),
        ("bolt", "stroke_m", "0.1"),
        ("gate", "inputs", "2"),
    ];
    let reported: Vec<String> = wrong
        .iter()
        .map(|(component, parameter, value)| refused(&mut bench.plant, component, parameter, value))
        .collect();
    insta::assert_snapshot!(reported.join("\n"));
    assert!(bench.plant.save() == Ok(before));
    // without a joint nobody else has stops
    bench.plant.change_parameter("door", "stroke_m", "0.1").expect("a number");
    let unset = Plant::parse(CELL, "scene.toml", bench.plant.join().name, crate::bench::PERIOD)
        .map(|mut plant| plant.change_parameter("door", "stroke_m", "0.1").expect_err("refused").to_string());
    insta::assert_snapshot!(unset.expect("a scene"), @"component `door` cannot change before the set-up");
}
