//! Robots without dynamics: exactly where they are set, whatever is in the way.

use onescan_plant::Plant;
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, PortLayout};
use onescan_server::time::{TimeSpan, VirtualTime};

/// An arm of two links without masses, as most makers publish theirs, whose wrist follows its shoulder.
const ARM: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="hand">
    <collision><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.1 0.1"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="9" velocity="9"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="upper"/><child link="hand"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="9" velocity="9"/><mimic joint="shoulder" multiplier="-0.5" offset="0.1"/>
  </joint>
</robot>"#;

const SCENE: &str = r#"
version = 1

[[urdf]]
name = "arm"
file = "arm.urdf"
kinematic = true
position_m = [0.0, 0.0, 0.25]

[[axis]]
name = "shoulder"
joint = "arm.shoulder"
drive = "position"
command_signal = "Angle"
position_signal = "Is"
velocity_signal = "Speed"
speed_rad_s = 1.0
acceleration_rad_s2 = 2.0

[[body]]
name = "floor"
kind = "fixed"
shape = "box"
size_m = [6.0, 6.0, 0.2]
position_m = [0.0, 0.0, -0.1]

# in the way
[[body]]
name = "block"
kind = "dynamic"
shape = "box"
size_m = [0.4, 0.4, 0.4]
mass_kg = 500.0
position_m = [0.5, 0.6, 0.2]
"#;

struct Robot {
    plant: Plant,
    inputs: Vec<u8>,
    outputs: Vec<u8>,
    step: u64,
    period_us: u64,
}

fn loaded(scene: &str, period_us: u64) -> Result<Plant, String> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("arm.urdf"), ARM).expect("written");
    std::fs::write(folder.path().join("plant.toml"), scene).expect("written");
    let period = TimeSpan::from_micros(period_us).expect("not zero");
    let name = ClientName::new("plant").expect("a name");
    Plant::load(&folder.path().join("plant.toml"), name, period).map_err(|error| error.to_string())
}

impl Robot {
    fn new(scene: &str, period_us: u64) -> Self {
        let mut plant = loaded(scene, period_us).expect("a scene");
        let join = plant.join();
        let (reads, writes) = (PortLayout::new(join.reads), PortLayout::new(join.writes));
        let (mut inputs, mut outputs) = (vec![0; reads.size()], vec![0; writes.size()]);
        plant.setup(&mut outputs).expect("a set-up");
        reads.slot::<f64>("Angle").expect("an input").set(&mut inputs, 1.5);
        Self { plant, inputs, outputs, step: 0, period_us }
    }

    fn run_us(&mut self, time_us: u64) {
        for _ in 0..time_us / self.period_us {
            self.step += 1;
            let t_v = VirtualTime::from_nanos(self.step * self.period_us * 1000);
            self.plant.turn(t_v, &self.inputs, &mut self.outputs).expect("a turn");
        }
    }

    fn read(&self, signal: &str) -> f64 {
        PortLayout::new(self.plant.join().writes).slot::<f64>(signal).expect("an output").get(&self.outputs)
    }

    fn at(&self, body: &str) -> [f64; 3] {
        self.plant.poses().find(|pose| pose.name == body).expect("a body").position_m
    }

    /// How far a body is turned about the vertical.
    fn turned(&self, body: &str) -> f64 {
        let [_, _, z, w] = self.plant.poses().find(|pose| pose.name == body).expect("a body").rotation_xyzw;
        2.0 * z.atan2(w)
    }
}

#[test]
fn a_kinematic_robot_is_where_it_is_set_whatever_is_in_the_way() {
    for period_us in [100, 1_000, 10_000] {
        let mut robot = Robot::new(SCENE, period_us);
        assert!((robot.turned("arm.hand") - 0.1).abs() < 1e-12, "the offset of what follows");
        robot.run_us(1_000_000);
        // half a second at 2 rad/s², then half a second at 1 rad/s; rounded a turn at a time
        assert!((robot.read("Is") - 0.75).abs() < 1e-11, "{period_us}: {}", robot.read("Is"));
        assert!((robot.read("Speed") - 1.0).abs() < 1e-11, "{period_us}: {}", robot.read("Speed"));
        let ([x, y, z], (sin, cos)) = (robot.at("arm.hand"), 0.75_f64.sin_cos());
        assert!((x - cos).abs() + (y - sin).abs() + (z - 0.25).abs() < 1e-11, "{period_us}: {x} {y} {z}");
        let wrist = robot.turned("arm.hand") - 0.75;
        assert!((wrist + 0.5 * 0.75 - 0.1).abs() < 1e-11, "{period_us}: {wrist}");
        robot.run_us(2_000_000);
        assert_eq!((robot.read("Is"), robot.read("Speed")), (1.5, 0.0), "{period_us}");
        // the block is out of the arm's way, whose side is 0.05 m from its axis, to within what a contact gives
        let [x, y, _] = robot.at("block");
        let beside = y * 1.5_f64.cos() - x * 1.5_f64.sin();
        assert!(x < 0.3 && y > 0.6, "{period_us}: it was pushed: {x} {y}");
        assert!(beside > 0.05 + 0.2 - 0.02, "{period_us}: {beside}");
    }
}

#[test]
fn its_state_goes_on_to_the_bit() {
    let mut whole = Robot::new(SCENE, 10_000);
    whole.run_us(700_000);
    let state = whole.plant.save().expect("a state");
    let mut other = Robot::new(SCENE, 10_000);
    other.plant.restore(&state).expect("restored");
    other.step = whole.step;
    whole.run_us(800_000);
    other.run_us(800_000);
    assert_eq!(whole.outputs, other.outputs);
    assert_eq!(whole.plant.save().expect("a state"), other.plant.save().expect("a state"));
}

#[test]
fn no_force_acts_on_a_kinematic_robot() {
    let reported = |more: &str| loaded(&format!("{SCENE}{more}"), 10_000).err().unwrap_or_default();
    let guided = "is one of a kinematic robot, on which no force acts";
    let fitting = reported("[[fitting]]\nname = \"f\"\njoint = \"arm.shoulder\"\nfriction_nm = 1.0\n");
    assert!(fitting.contains(guided), "{fitting}");
    let motor = reported("[[component]]\nname = \"m\"\nkind = \"asynchronous_motor\"\njoint = \"arm.wrist\"\n");
    assert!(motor.contains(guided), "{motor}");
    let weak = loaded(&SCENE.replace("speed_rad_s", "torque_max_nm = 5.0\nspeed_rad_s"), 10_000);
    let weak = weak.err().unwrap_or_default();
    assert!(weak.contains("axis `shoulder` of a kinematic robot") && weak.contains("torque_max_nm"), "{weak}");
    let loose = loaded(&SCENE.replace("kinematic = true", "kinematic = true\nfixed = false"), 10_000);
    let loose = loose.err().unwrap_or_default();
    assert!(loose.contains("kinematic robot `arm`"), "{loose}");
    let free = loaded(&SCENE.replace("kinematic = true", "density_kg_m3 = 2700"), 10_000).expect("a scene");
    assert!(free.scene().joints.iter().all(|joint| !joint.guided));
}
