//! Parts of a cell in one scene, against closed forms: what protects it, what stops, lifts, weighs, reads and stores.

use onescan_plant::Plant;
use onescan_server::client::Client;
use onescan_server::signal::ClientName;

use crate::bench::{Bench, PERIOD};

const CELL: &str = r#"
version = 1

[[body]]
name = "belt"
kind = "kinematic"
shape = "box"
size_m = [4.0, 0.3, 0.1]
position_m = [0.0, 0.0, -0.05]
friction = 1.0
group = "line"

[[body]]
name = "pin"
kind = "dynamic"
shape = "box"
size_m = [0.02, 0.1, 0.06]
mass_kg = 0.5
position_m = [0.31, 0.0, 0.03]
group = "line"

[[joint]]
name = "pin_way"
kind = "prismatic"
parent = "ground"
child = "pin"
axis = [0, 0, 1]
initial_m = 0.07

[[body]]
name = "box_a"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 0.5
position_m = [-0.4, 0.0, 0.05]
friction = 1.0

[[body]]
name = "field"
kind = "fixed"
shape = "box"
size_m = [0.1, 0.3, 0.1]
position_m = [0.25, 0.0, 0.1]
collides = false

[[body]]
name = "later"
kind = "fixed"
shape = "box"
size_m = [0.3, 0.3, 0.1]
position_m = [0.9, 0.0, 0.1]
collides = false

[[body]]
name = "scale"
kind = "fixed"
shape = "box"
size_m = [0.4, 0.4, 0.1]
position_m = [0.0, 3.0, 0.0]

[[body]]
name = "lower"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.1]
mass_kg = 2.5
position_m = [0.0, 3.0, 0.1]

[[body]]
name = "upper"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 1.25
position_m = [0.02, 3.01, 0.2]

[[body]]
name = "platform"
kind = "dynamic"
shape = "box"
size_m = [1.0, 0.6, 0.05]
mass_kg = 100.0
position_m = [0.0, 6.0, 0.2]

[[joint]]
name = "table_way"
kind = "prismatic"
parent = "ground"
child = "platform"
axis = [0, 0, 1]

[[body]]
name = "mast"
kind = "dynamic"
shape = "box"
size_m = [0.4, 0.4, 4.0]
mass_kg = 800.0
position_m = [0.0, 12.0, 2.0]
collides = false

[[body]]
name = "carriage"
kind = "dynamic"
shape = "box"
size_m = [0.4, 0.6, 0.2]
mass_kg = 200.0
position_m = [0.0, 12.0, 0.5]
collides = false

[[body]]
name = "tine"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.8, 0.05]
mass_kg = 50.0
position_m = [0.0, 12.0, 0.65]
collides = false

[[joint]]
name = "aisle"
kind = "prismatic"
parent = "ground"
child = "mast"
axis = [1, 0, 0]

[[joint]]
name = "column"
kind = "prismatic"
parent = "mast"
child = "carriage"
axis = [0, 0, 1]

[[joint]]
name = "reach"
kind = "prismatic"
parent = "carriage"
child = "tine"
axis = [0, 1, 0]

[[component]]
name = "conveyor"
kind = "conveyor"
belt = "belt"
direction = [1, 0, 0]
run_signal = "Run"

[[component]]
name = "stopper"
kind = "stopper"
joint = "pin_way"
stroke_m = 0.07
lower_signal = "Lower"
raised_signal = "Raised"
lowered_signal = "Lowered"
position_m_signal = "Pin"

[[component]]
name = "box_at"
kind = "pose_sensor"
body = "box_a"
x_m_signal = "Box"

[[component]]
name = "reader"
kind = "barcode_reader"
body = "field"
targets = ["upper", "box_a"]
first_code = 500
trigger_signal = "Read"
good_signal = "Good"
code_signal = "Code"

[[component]]
name = "writer"
kind = "rfid_head"
body = "field"
targets = ["box_a"]
write_signal = "Write"
data = 4711
done_signal = "Written"

[[component]]
name = "teller"
kind = "rfid_head"
body = "later"
targets = ["upper", "box_a"]
read_signal = "Ask"
present_signal = "There"
done_signal = "Known"
data_read_signal = "Tag"

[[component]]
name = "weight"
kind = "weighing_cell"
body = "scale"
targets = ["lower", "upper"]
tare_signal = "Tare"
gross_kg_signal = "Gross"
net_kg_signal = "Net"
stable_signal = "Stable"

[[component]]
name = "table"
kind = "lift_table"
joint = "table_way"
up_signal = "Up"
down_signal = "Down"
height_m_signal = "Height"
overload_signal = "Overload"

[[component]]
name = "curtain"
kind = "light_curtain"
point_m = [0.0, 5.0, 0.01]
direction = [0, 1, 0]
along = [0, 0.3, 1]
targets = ["platform"]
beams = 32
pitch_m = 0.04
beam_m = 0.0
range_m = 2.0
ossd_1_signal = "Free"
interrupted_signal = "Dark"

[[component]]
name = "feeder"
kind = "rack_feeder"
travel = "aisle"
lift = "column"
fork = "reach"
target_x_signal = "Column"
target_y_signal = "Row"
execute_signal = "Go"
fork_left_signal = "Left"
in_position_signal = "In_Place"
fork_left_out_signal = "Left_Out"
error_signal = "Feeder_Error"
x_m_signal = "X"
y_m_signal = "Y"

[[component]]
name = "hands"
kind = "two_hand_station"
left_signal = "Left_Hand"
right_signal = "Right_Hand"
valid_signal = "Valid"

[[component]]
name = "mode"
kind = "key_switch"
position_signal = "Mode"
key = true
at_1_signal = "Automatic"

[[component]]
name = "tower"
kind = "stack_light"
green_signal = "Run"
red_flash_signal = "Lower"
green_lit_signal = "Green"
red_lit_signal = "Red"
"#;

fn turns(bench: &mut Bench, count: u32) {
    for _ in 0..count {
        bench.turn();
    }
}

/// A box that the belt runs against the pin.
fn at_the_pin() -> Bench {
    let mut bench = Bench::new(CELL);
    bench.command("Run", true);
    turns(&mut bench, 300);
    bench
}

#[test]
fn a_part_stops_at_a_pin_and_goes_on_when_it_is_lowered() {
    let mut bench = at_the_pin();
    // the face of the pin is at 0.30 m, half of the box before it
    let stood_m: f64 = bench.read("Box");
    assert!(bench.read::<bool>("Raised") && (stood_m - 0.25).abs() < 1e-3, "{stood_m}");
    bench.command("Lower", true);
    // half of 0.1 s: half of 0.07 m
    turns(&mut bench, 5);
    assert!((bench.read::<f64>("Pin") - 0.035).abs() < 1e-4, "{}", bench.read::<f64>("Pin"));
    turns(&mut bench, 95);
    assert!(bench.read::<bool>("Lowered"));
    // 0.5 m/s for what is left of a second after the pin is below the belt
    let gone_m = bench.read::<f64>("Box") - stood_m;
    assert!(gone_m > 0.4 && gone_m < 0.5, "{gone_m}");
}

#[test]
fn a_code_is_read_and_a_tag_tells_another_head_what_was_written() {
    let mut bench = at_the_pin();
    for signal in ["Read", "Write", "Ask"] {
        bench.command(signal, true);
    }
    turns(&mut bench, 10);
    assert!(bench.read::<bool>("Good") && bench.read::<i32>("Code") == 501, "the second of two targets");
    assert!(bench.read::<bool>("Written") && !bench.read::<bool>("Known") && !bench.read::<bool>("There"));
    bench.command("Lower", true);
    bench.command("Ask", false);
    turns(&mut bench, 130);
    bench.command("Ask", true);
    turns(&mut bench, 5);
    assert!(bench.read::<bool>("There") && bench.read::<bool>("Known"), "{}", bench.read::<f64>("Box"));
    assert_eq!(bench.read::<i32>("Tag"), 4711);
}

#[test]
fn a_scale_feels_all_that_lies_on_it() {
    let mut bench = Bench::new(CELL);
    turns(&mut bench, 300);
    // 2.5 kg and what lies on them, in divisions of 10 g
    assert!((bench.read::<f64>("Gross") - 3.75).abs() < 1e-9, "{}", bench.read::<f64>("Gross"));
    assert!(bench.read::<bool>("Stable"));
    bench.command("Tare", true);
    turns(&mut bench, 5);
    assert_eq!(bench.read::<f64>("Net").abs(), 0.0);
}

#[test]
fn a_table_rises_by_its_ram_and_darkens_the_beams_that_it_covers() {
    let mut bench = Bench::new(CELL);
    turns(&mut bench, 50);
    let low_m: f64 = bench.read("Height");
    let lowest_m = 1.2 * 8.0_f64.to_radians().sin();
    assert!((low_m - lowest_m).abs() < 1e-6, "{low_m} {lowest_m}");
    bench.command("Up", true);
    for second in 1..=6 {
        turns(&mut bench, 100);
        let (a, b) = (0.9_f64, 0.35_f64);
        let ram = |angle: f64| (a * a + b * b - 2.0 * a * b * angle.cos()).sqrt();
        let s = ram(8.0_f64.to_radians()) + 0.02 * f64::from(second);
        let exact_m = 1.2 * ((a * a + b * b - s * s) / (2.0 * a * b)).acos().sin();
        let height_m: f64 = bench.read("Height");
        // a drive makes up a quarter of a deviation in a turn
        assert!((height_m - exact_m).abs() < 1e-6, "{second}: {height_m} {exact_m}");
        // the platform is 0.05 m thick about 0.2 m and its way, the beams are at 0.01 m and 0.04 m on
        let middle_m = 0.2 + height_m - lowest_m;
        let covers = |beam: i32| (0.01 + 0.04 * f64::from(beam) - middle_m).abs() <= 0.025;
        let dark = (0..32).filter(|beam| covers(*beam)).count() as i32;
        assert_eq!(bench.read::<i32>("Dark"), dark, "{middle_m}");
        assert!((1..=2).contains(&dark) && !bench.read::<bool>("Free"), "thicker than the pitch: never unseen");
    }
    assert!(!bench.read::<bool>("Overload"));
}

#[test]
fn a_feeder_reaches_its_place_in_the_time_of_its_slower_axis() {
    let mut bench = Bench::new(CELL);
    bench.command("Column", 6_i32);
    bench.command("Row", 3_i32);
    bench.command("Go", true);
    // 3 m below v²/a = 8 m: 2 √(3/0.5) = 4.899 s; 1.2 m: 1.2/0.8 + 1 = 2.5 s
    turns(&mut bench, 489);
    assert!(!bench.read::<bool>("In_Place"));
    turns(&mut bench, 6);
    let place: [f64; 2] = ["X", "Y"].map(|way| bench.read(way));
    assert!(bench.read::<bool>("In_Place") && !bench.read::<bool>("Feeder_Error"), "{place:?}");
    assert!((place[0] - 3.0).abs() < 1e-4 && (place[1] - 1.2).abs() < 1e-4, "{place:?}");
    bench.command("Left", true);
    // 1.2/0.6 + 0.6/1.0 = 2.6 s
    turns(&mut bench, 255);
    assert!(!bench.read::<bool>("Left_Out"));
    turns(&mut bench, 10);
    assert!(bench.read::<bool>("Left_Out"));
}

/// Commands that no part of the plant knows.
fn command(bench: &mut Bench, turn: u32) {
    for (index, signal) in
        ["Run", "Lower", "Read", "Write", "Ask", "Tare", "Up", "Down", "Go", "Left", "Left_Hand", "Right_Hand"]
            .into_iter()
            .enumerate()
    {
        bench.command(signal, (turn / (40 + 7 * index as u32)).is_multiple_of(2));
    }
    bench.command("Column", (turn / 90) as i32 % 5);
    bench.command("Mode", (turn / 60) as i32 % 2);
}

/// The signals of a cell that is restored half way go on to the bit, tags included.
#[test]
fn a_restored_cell_goes_on_to_the_bit() {
    let mut first = Bench::new(CELL);
    for turn in 0..250 {
        command(&mut first, turn);
        first.turn();
    }
    let saved = first.plant.save().expect("a state");
    let name = ClientName::new("plant").expect("a name");
    let plant = Plant::parse(CELL, "scene.toml", name, PERIOD).unwrap_or_else(|error| panic!("{error}"));
    let mut second = Bench::of(plant, PERIOD);
    second.plant.restore(&saved).expect("a state");
    second.outputs.clone_from(&first.outputs);
    second.t_v = first.t_v;
    for turn in 250..500 {
        for bench in [&mut first, &mut second] {
            command(bench, turn);
            bench.turn();
        }
        assert!(first.outputs == second.outputs, "turn {turn}");
    }
}

#[test]
fn a_joint_is_driven_once_and_beams_are_beside_each_other() {
    let refused = |from: &str, to: &str| {
        let scene = CELL.replace(from, to);
        assert_ne!(scene, CELL);
        let name = ClientName::new("plant").expect("a name");
        Plant::parse(&scene, "scene.toml", name, PERIOD).map(drop).expect_err("a fault").to_string()
    };
    let twice = refused("fork = \"reach\"", "fork = \"column\"");
    assert!(twice.contains("column"), "{twice}");
    let another = refused("lift = \"column\"", "lift = \"table_way\"");
    assert!(another.contains("table_way"), "{another}");
    let parallel = refused("along = [0, 0.3, 1]", "along = [0, 2, 0]");
    assert!(parallel.contains("along"), "{parallel}");
}
