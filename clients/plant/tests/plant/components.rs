//! Components in a scene: wired, bound to bodies, disturbed, saved.

use std::fmt::Write as _;

use onescan_plant::{Plant, Scene};
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, PortLayout};

use crate::bench::{Bench, PERIOD};

/// A clamp on a slide, driven by air; its pressure goes through a transmitter and a raw signal.
const CLAMP: &str = r#"
version = 1
gravity_m_s2 = [0, 0, 0]

[[body]]
name = "jaw"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 5.0

[[joint]]
name = "slide"
kind = "prismatic"
parent = "ground"
child = "jaw"
axis = [1.0, 0.0, 0.0]
lower_m = 0.0
upper_m = 0.2

[[component]]
name = "clamp"
kind = "pneumatic_cylinder"
joint = "slide"
stroke_m = 0.2
moving_kg = 5
extend_signal = "Clamp"
extended_signal = "Clamped"
retracted_signal = "Open"
position_m_signal = "Way"

[[component]]
name = "gauge"
kind = "pressure_sensor"
pressure_bar_from = "clamp.cap_bar"
measured_bar_signal = "Pressure"
noise_bar = 0.02

[[component]]
name = "end"
kind = "limit_switch"
joint = "slide"
from = 0.15
contact_signal = "Half"

[[failure]]
component = "clamp"
mode = "no_supply"
signal = "Air_Lost"

[[failure]]
component = "clamp"
mode = "extended_dead"
from_s = 4.0

[[signal]]
name = "Pressure"
type = "INT"
range = [0.0, 10.0]
raw = [0, 27648]
delay_s = 0.05
jitter_s = 0.01
"#;

fn refusal(scene: &str) -> String {
    Scene::parse(scene, "plant.toml").map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

fn turns(bench: &mut Bench, count: u32) {
    for _ in 0..count {
        bench.turn();
    }
}

#[test]
fn a_cylinder_moves_the_body_of_its_joint() {
    let mut bench = Bench::new(CLAMP);
    assert!(bench.read::<bool>("Open") && !bench.read::<bool>("Clamped"));
    bench.command("Clamp", true);
    turns(&mut bench, 200);
    assert!(bench.read::<bool>("Clamped") && bench.read::<bool>("Half") && !bench.read::<bool>("Open"));
    let jaw = bench.plant.poses().find(|pose| pose.name == "jaw").expect("a jaw").position_m;
    // the drive of the joint follows the rod within what one period corrects
    assert!((jaw[0] - 0.2).abs() < 1e-4, "{jaw:?}");
    // the joint is measured from the poses of its bodies
    assert!((bench.read::<f64>("Way") - jaw[0]).abs() < 1e-15);
}

#[test]
fn a_raw_value_comes_scaled_and_late() {
    let mut bench = Bench::new(CLAMP);
    bench.command("Clamp", true);
    turns(&mut bench, 300);
    let raw = f64::from(bench.read::<i16>("Pressure"));
    // 6 bar of 10 in 27648 steps; five deviations of the noise
    assert!((raw / 27648.0 * 10.0 - 6.0).abs() < 0.1, "{raw}");
}

#[test]
fn a_failure_follows_its_signal_or_its_time() {
    let mut bench = Bench::new(CLAMP);
    bench.command("Clamp", true);
    turns(&mut bench, 200);
    assert!(bench.read::<bool>("Clamped"));
    turns(&mut bench, 200);
    assert!(!bench.read::<bool>("Clamped") && bench.read::<bool>("Half"), "the switch is dead from 4 s on");
    let mut bench = Bench::new(CLAMP);
    bench.command("Clamp", true);
    bench.command("Air_Lost", true);
    turns(&mut bench, 200);
    assert!(bench.read::<bool>("Open"));
}

#[test]
fn a_blocked_joint_blocks_the_cylinder() {
    let wall = "[[body]]\nname = \"wall\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 1.0, 1.0]\nposition_m = [0.2, 0.0, 0.0]\n";
    let mut bench = Bench::new(&CLAMP.replacen("[[joint]]", &format!("{wall}[[joint]]"), 1));
    bench.command("Clamp", true);
    turns(&mut bench, 300);
    let way: f64 = bench.read("Way");
    // the wall's face is at 0.15 m, the jaw's 0.05 m ahead; the contact gives by what 1 kN needs
    assert!((way - 0.1).abs() < 5e-3, "{way}");
}

#[test]
fn noise_and_jitter_follow_the_seed_and_nothing_else() {
    let run = |seed: u64| {
        let name = ClientName::new("plant").expect("a name");
        let mut plant = Plant::parse(CLAMP, "plant.toml", name, PERIOD).expect("a scene").seeded(seed);
        let (reads, writes) = (PortLayout::new(plant.join().reads), PortLayout::new(plant.join().writes));
        let (mut inputs, mut outputs) = (vec![0; reads.size()], vec![0; writes.size()]);
        plant.setup(&mut outputs).expect("a set-up");
        reads.slot::<bool>("Clamp").expect("a signal").set(&mut inputs, true);
        let mut trace = Vec::new();
        for k in 1..=100 {
            let t_v = (0..k).fold(onescan_server::time::VirtualTime::ZERO, |t, _| t + PERIOD);
            plant.turn(t_v, &inputs, &mut outputs).expect("a turn");
            trace.push(outputs.clone());
        }
        trace
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn a_saved_state_goes_on_to_the_bit() {
    let mut first = Bench::new(CLAMP);
    first.command("Clamp", true);
    turns(&mut first, 57);
    let state = first.plant.save().expect("a state");
    let mut second = Bench::new(CLAMP);
    second.plant.restore(&state).expect("the same plant");
    assert!(second.plant.save().expect("a state") == state);
    second.inputs.clone_from(&first.inputs);
    second.t_v = first.t_v;
    for k in 0..100 {
        first.turn();
        second.turn();
        assert!(first.outputs == second.outputs, "{k}");
    }
    assert!(first.plant.save().expect("a state") == second.plant.save().expect("a state"));
}

#[test]
fn mistakes_have_their_place_and_a_hint() {
    let cases = [
        ("stroke_m = 0.2", "stroke_mm = 200"),
        ("stroke_m = 0.2", "stroke = 0.2"),
        ("stroke_m = 0.2", "strok_m = 0.2"),
        ("stroke_m = 0.2", "stroke_m = 200"),
        ("stroke_m = 0.2", "stroke_m = \"200 mm\""),
        ("stroke_m = 0.2", "rod_m = 0.06"),
        ("stroke_m = 0.2", "valve = \"5/3\""),
        ("pneumatic_cylinder", "pneumatic_cilinder"),
        ("pneumatic_cylinder", "elevator"),
        ("joint = \"slide\"\nstroke", "joint = \"slid\"\nstroke"),
        ("joint = \"slide\"\nfrom", "from"),
        ("kind = \"prismatic\"", "kind = \"revolute\""),
        ("extend_signal", "extent_signal"),
        ("extend_signal = \"Clamp\"", "extend_signal = 3"),
        ("\"clamp.cap_bar\"", "\"clmp.cap_bar\""),
        ("\"clamp.cap_bar\"", "\"clamp.cab_bar\""),
        ("\"clamp.cap_bar\"", "\"clamp.extended\""),
        ("\"clamp.cap_bar\"", "\"clamp\""),
        ("name = \"gauge\"", "name = \"clamp\""),
        ("\"no_supply\"", "\"no_suply\""),
        ("\"no_supply\"", "\"tired\""),
        ("from_s = 4.0", "from_s = 4.0\nuntil_s = 3.0"),
        ("signal = \"Air_Lost\"", "signal = \"Air_Lost\"\nfrom_s = 1.0"),
        ("name = \"Pressure\"\ntype", "name = \"Presure\"\ntype"),
        ("type = \"INT\"", "type = \"STRING\""),
        ("raw = [0, 27648]\n", ""),
        ("raw = [0, 27648]", "raw = [27648, 0]"),
        (
            "[[component]]\nname = \"clamp\"",
            "[[axis]]\nname = \"a\"\njoint = \"slide\"\ndrive = \"velocity\"\ncommand_signal = \"c\"\nspeed_m_s = 1\nacceleration_m_s2 = 1\n[[component]]\nname = \"clamp\"",
        ),
    ];
    let mut reported = String::new();
    for (from, to) in cases {
        assert!(CLAMP.contains(from), "{from}");
        let refused = refusal(&CLAMP.replacen(from, to, 1));
        let written = to.lines().next_back().unwrap_or_default();
        writeln!(reported, "{written}\n  {}", refused.replace('\n', "\n  ")).expect("a string grows");
    }
    insta::assert_snapshot!(reported);
}
