//! Components that handle bodies: sources, belts, barriers, arms, sinks.

use onescan_server::client::{Client, ClientView, Parts};

use crate::bench::Bench;

/// Boxes come from a source onto a belt, pass a barrier, and leave through a sink at its end.
const LINE: &str = r#"
version = 1

[[body]]
name = "belt"
kind = "kinematic"
shape = "box"
size_m = [2.0, 0.4, 0.1]
position_m = [0.0, 0.0, -0.05]
friction = 1.0

[[body]]
name = "infeed"
kind = "fixed"
position_m = [-0.8, 0.0, 0.051]

[[body]]
name = "outfeed"
kind = "fixed"
shape = "box"
size_m = [0.1, 0.4, 0.4]
position_m = [0.9, 0.0, 0.2]
collides = false

[[body]]
name = "box_1"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 0.5
friction = 1.0

[[body]]
name = "box_2"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 0.5
friction = 1.0

[[component]]
name = "speed"
kind = "input_controller"
level_signal = "CONVEYOR_SPEED"

[[component]]
name = "conveyor"
kind = "conveyor"
belt = "belt"
direction = [1, 0, 0]
run_from = "speed.run"
fraction_from = "speed.fraction"
travel_m_signal = "Travel"

[[component]]
name = "source"
kind = "workpiece_source"
body = "infeed"
targets = ["box_1", "box_2"]
interval_s = 2.0
enable_signal = "Feed"
count_signal = "In"

[[component]]
name = "barrier"
kind = "light_barrier"
point_m = [0.0, -0.5, 0.05]
direction = [0, 1, 0]
targets = ["box_1", "box_2"]
count_signal = "Passed"

[[component]]
name = "sink"
kind = "workpiece_sink"
body = "outfeed"
targets = ["box_1", "box_2"]
count_signal = "Out"
"#;

/// An arm that turns and takes a box with it.
const ARM: &str = r#"
version = 1
gravity_m_s2 = [0, 0, 0]

[[body]]
name = "hand"
kind = "dynamic"
shape = "box"
size_m = [1.0, 0.1, 0.1]
mass_kg = 10.0
position_m = [0.5, 0.0, 0.0]
collides = false

[[body]]
name = "package"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 0.5
position_m = [0.95, 0.0, 0.09]

[[joint]]
name = "shoulder"
kind = "revolute"
parent = "ground"
child = "hand"
anchor_m = [0.0, 0.0, 0.0]
axis = [0, 0, 1]

[[component]]
name = "wheel"
kind = "turntable"
joint = "shoulder"
stations = 4
step_signal = "Step"
station_signal = "Station"

[[component]]
name = "arm"
kind = "arm"
body = "hand"
drop_signal = "Drop"
holding_signal = "Holding"
"#;

#[test]
fn boxes_come_pass_and_go_and_come_again() {
    let mut bench = Bench::new(LINE);
    bench.command("CONVEYOR_SPEED", 2_i32);
    bench.command("Feed", true);
    let mut most = 0;
    for _ in 0..3000 {
        bench.turn();
        let inside = bench.read::<i32>("In") - bench.read::<i32>("Out");
        most = most.max(inside);
        assert!((0..=2).contains(&inside), "two boxes are all that there are");
    }
    // one box each two seconds; 1.5 m at 0.5 m/s take each of them 3.3 s
    let (came, passed, gone) = (bench.read::<i32>("In"), bench.read::<i32>("Passed"), bench.read::<i32>("Out"));
    assert_eq!((came, most), (15, 2));
    assert!(gone >= 13 && (gone..=came).contains(&passed), "{came} {passed} {gone}");
}

#[test]
fn half_a_level_is_half_the_speed() {
    let mut bench = Bench::new(LINE);
    bench.command("CONVEYOR_SPEED", 1_i32);
    for _ in 0..200 {
        bench.turn();
    }
    // 0.25 m/s after a ramp of 0.25 s, and one turn for the wire from the controller
    let travel: f64 = bench.read("Travel");
    assert!((travel - (0.25 * 1.99 - 0.5 * 0.25 * 0.25)).abs() < 1e-12, "{travel}");
}

#[test]
fn an_arm_takes_a_package_along_until_it_drops_it() {
    let mut bench = Bench::new(ARM);
    let package = |bench: &Bench| bench.plant.poses().find(|pose| pose.name == "package").expect("there").position_m;
    bench.command("Step", true);
    for _ in 0..150 {
        bench.turn();
    }
    let held = package(&bench);
    assert!(bench.read::<bool>("Holding") && bench.read::<i32>("Station") == 1);
    // a quarter turn about z; joints give by some micrometres
    assert!(held[0].abs() < 1e-3 && (held[1] - 0.95).abs() < 1e-3, "{held:?}");
    bench.command("Drop", true);
    bench.turn();
    bench.command("Step", false);
    bench.turn();
    bench.command("Step", true);
    for _ in 0..150 {
        bench.turn();
    }
    let dropped = package(&bench);
    assert!(!bench.read::<bool>("Holding") && bench.read::<i32>("Station") == 2);
    assert!((dropped[1] - 0.95).abs() < 2e-2, "it stays where it was dropped: {dropped:?}");
}

#[test]
fn handling_goes_on_to_the_bit_from_a_saved_state() {
    use onescan_server::client::Client;
    for (scene, at) in [(LINE, 412), (ARM, 60)] {
        let run = |bench: &mut Bench| {
            for input in &mut bench.inputs {
                *input = 0;
            }
            if scene == LINE {
                bench.command("CONVEYOR_SPEED", 2_i32);
                bench.command("Feed", true);
            } else {
                bench.command("Step", true);
            }
            bench.turn();
        };
        let mut first = Bench::new(scene);
        (0..at).for_each(|_| run(&mut first));
        let mut second = Bench::new(scene);
        second.plant.restore(&first.plant.save().expect("a state")).expect("the same plant");
        second.t_v = first.t_v;
        for k in 0..300 {
            run(&mut first);
            run(&mut second);
            assert!(first.outputs == second.outputs, "{k}");
        }
        assert!(first.plant.save().expect("a state") == second.plant.save().expect("a state"));
    }
}

/// Who looks does not see what waits for its source, nor what a sink has taken.
#[test]
fn what_is_out_of_the_world_is_nowhere() {
    let mut bench = Bench::new(LINE);
    let there = |bench: &Bench| {
        let mut view = ClientView::default();
        bench.plant.show(Parts::POSES, &mut view);
        view.poses.iter().filter(|pose| pose.body.starts_with("box") && pose.position_m[0].is_finite()).count()
    };
    assert_eq!(there(&bench), 0);
    bench.command("CONVEYOR_SPEED", 2_i32);
    bench.command("Feed", true);
    for _ in 0..100 {
        bench.turn();
    }
    assert_eq!(there(&bench), 1);
    bench.command("Feed", false);
    for _ in 0..4000 {
        bench.turn();
    }
    assert_eq!((there(&bench), bench.read::<i32>("Out")), (0, 1));
}
