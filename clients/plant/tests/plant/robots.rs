//! Robots from their makers' files.

use onescan_plant::{Plant, SceneError};
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, PortLayout};
use onescan_server::time::VirtualTime;

use crate::bench::PERIOD;

/// A pendulum that hangs 0.05 rad off its rest, with a frame at its end; its tensor is turned.
const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="base"/>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 0.5" rpy="0 1.5707963267948966 0"/>
      <mass value="2"/>
      <inertia ixx="0.01" iyy="0.2" izz="0.2"/>
    </inertial>
    <collision><origin xyz="0 0 0.5"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision>
  </link>
  <link name="tip"><collision><geometry><mesh filename="package://robots/meshes/tip.obj" scale="0.001 0.001 0.001"/></geometry></collision></link>
  <joint name="swing" type="continuous">
    <parent link="base"/><child link="rod"/><origin rpy="0 3.091592653589793 0"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="end" type="fixed"><parent link="rod"/><child link="tip"/><origin xyz="0 0 1"/></joint>
</robot>"#;

const TIP: &str = "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

const SCENE: &str = r#"
version = 1

[[urdf]]
name = "clock"
file = "robots/urdf/pendulum.urdf"
position_m = [0.0, 0.0, 3.0]

[[component]]
name = "encoder"
kind = "absolute_encoder"
joint = "clock.swing"
"#;

fn plant(scene: &str, urdf: &str) -> Result<Plant, SceneError> {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        std::fs::write(path, text).expect("written");
    };
    write("robots/urdf/pendulum.urdf", urdf);
    write("robots/meshes/tip.obj", TIP);
    write("plant.toml", scene);
    Plant::load(&folder.path().join("plant.toml"), ClientName::new("plant").expect("a name"), PERIOD)
}

/// How far the rod is off its rest, to the first order.
fn off(plant: &Plant) -> f64 {
    let pose = plant.poses().find(|pose| pose.name == "clock.rod").expect("a body");
    let [x, y, z, w] = pose.rotation_xyzw;
    2.0 * (x * z + w * y)
}

#[test]
fn a_pendulum_swings_with_the_period_of_its_tensor() {
    let mut plant = plant(SCENE, PENDULUM).expect("a scene");
    let names: Vec<_> = plant.scene().bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["clock.base", "clock.rod"], "a frame is not a body");
    let shapes: Vec<_> = plant.scene().shapes.iter().map(|shape| (shape.name.as_str(), shape.body)).collect();
    assert_eq!(shapes, [("clock.rod.shape[0]", 1), ("clock.tip.shape[0]", 1)]);
    plant.setup(&mut []).expect("a set-up");
    assert!((off(&plant) - 0.05_f64.sin()).abs() < 1e-9, "{}", off(&plant));
    let mut crossings = Vec::new();
    let mut before = off(&plant);
    for k in 1..=1000_u64 {
        plant.turn(VirtualTime::from_nanos(k * 10_000_000), &[], &mut []).expect("a turn");
        let now = off(&plant);
        if before * now < 0.0 {
            crossings.push(0.01 * (k as f64 - now / (now - before)));
        }
        before = now;
    }
    // T = 2π √(J/(m g l)) with J = 0.2 + 2·0.5² about the pivot: the tensor's 0.01 lies along the rod
    let period_s = 2.0 * std::f64::consts::PI * (0.7_f64 / (2.0 * 9.81 * 0.5)).sqrt();
    let (first, last) = (crossings[0], crossings[crossings.len() - 1]);
    let measured_s = 2.0 * (last - first) / (crossings.len() - 1) as f64;
    // the amplitude of 0.05 rad adds 0.02 %; the rest is the step's
    assert!((measured_s / period_s - 1.0).abs() < 2e-3, "{measured_s} {period_s}");
}

#[test]
fn what_is_wrong_with_a_robot_is_reported_with_both_lines() {
    let reported =
        |scene: &str, urdf: &str| plant(scene, urdf).err().map(|error| error.to_string()).unwrap_or_default();
    let broken = PENDULUM.replace("<mass value=\"2\"/>", "<mass value=\"x\"/>");
    let said = reported(SCENE, &broken);
    assert!(
        said.contains(":6:8: robot `robots/urdf/pendulum.urdf` line 6: `value` must be a number, not \"x\""),
        "{said}"
    );
    let said = reported(SCENE, &PENDULUM.replace("tip.obj", "tap.obj"));
    assert!(said.contains("of which no folder around it has `meshes/tap.obj`"), "{said}");
    let said = reported(SCENE, &PENDULUM.replace("type=\"fixed\"", "type=\"floating\""));
    assert!(said.contains("link `tip` moves and has no mass (`density_kg_m3 = 2700` in the table"), "{said}");
    let said = reported(&SCENE.replace("pendulum.urdf", "none.urdf"), PENDULUM);
    assert!(said.contains(":6:8: robot `robots/urdf/none.urdf` cannot be read: "), "{said}");
    let said = reported(&SCENE.replace("clock.swing", "clock.swign"), PENDULUM);
    assert!(said.contains("no joint `clock.swign` in this scene (did you mean `clock.swing`?)"), "{said}");
}

/// A robot as many are published: without masses, with a frame of mass 0, a joint that cannot stand at 0,
/// fingers of which one follows the other, a mesh of COLLADA that is mirrored.
const PUBLISHED: &str = r#"<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://wiki.ros.org/xacro">
  <xacro:arg name="reach" default="0.4"/>
  <xacro:include filename="parts.xacro"/>
  <link name="world"/>
  <link name="base"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <joint name="stand" type="fixed"><parent link="world"/><child link="base"/></joint>
  <xacro:rod name="upper" reach="$(arg reach)"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 1 0"/><limit lower="-3" upper="-1" effort="9" velocity="9"/>
  </joint>
  <link name="flange"><inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0"/></inertial></link>
  <joint name="end" type="fixed"><parent link="upper"/><child link="flange"/><origin xyz="0 0 ${0.5 * 0.8}"/></joint>
  <xacro:finger side="left" sign="1"/>
  <xacro:finger side="right" sign="-1">
  </xacro:finger>
</robot>"#;

const PARTS: &str = r#"<robot xmlns:xacro="http://wiki.ros.org/xacro">
  <xacro:property name="width" value="0.05"/>
  <xacro:macro name="rod" params="name reach radius:=${width / 2}">
    <link name="${name}">
      <collision><origin xyz="0 0 ${reach / 2}"/><geometry><cylinder radius="${radius}" length="${reach}"/></geometry></collision>
    </link>
  </xacro:macro>
  <xacro:macro name="finger" params="side sign">
    <link name="${side}">
      <collision><geometry><mesh filename="package://robots/meshes/tip.dae" scale="${sign} 1 1"/></geometry></collision>
    </link>
    <joint name="${side}" type="prismatic">
      <parent link="flange"/><child link="${side}"/><axis xyz="${sign} 0 0"/>
      <limit lower="0" upper="0.04" effort="9" velocity="9"/>
      <xacro:if value="${side == 'right'}"><mimic joint="left" multiplier="0.5" offset="0.01"/></xacro:if>
    </joint>
  </xacro:macro>
</robot>"#;

const HAND: &str = r#"
version = 1

[[urdf]]
name = "arm"
file = "robots/urdf/arm.xacro"
density_kg_m3 = 2700
arguments = { reach = 0.8 }
initial_m = { left = 0.02 }

[[axis]]
name = "shoulder"
joint = "arm.shoulder"
drive = "position"
command_signal = "Angle"
position_signal = "Angle_Is"
speed_rad_s = 1.0
acceleration_rad_s2 = 2.0

[[axis]]
name = "hand"
joint = "arm.left"
drive = "position"
command_signal = "Width"
speed_m_s = 0.05
acceleration_m_s2 = 0.5
"#;

fn hand(scene: &str, arm: &str, parts: &str) -> Result<Plant, SceneError> {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        std::fs::write(path, text).expect("written");
    };
    write("robots/package.xml", "<package><name>robots</name></package>");
    write("robots/urdf/arm.xacro", arm);
    write("robots/urdf/parts.xacro", parts);
    write("robots/meshes/tip.dae", DAE);
    write("plant.toml", scene);
    Plant::load(&folder.path().join("plant.toml"), ClientName::new("plant").expect("a name"), PERIOD)
}

/// A tetrahedron with edges of 50 mm.
const DAE: &str = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit meter="0.001"/></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="s"><float_array count="12">0 0 0 50 0 0 0 50 0 0 0 50</float_array></source>
    <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
  </mesh></geometry></library_geometries>
</COLLADA>"##;

#[test]
fn a_robot_as_it_is_published_holds_its_pose_and_its_fingers_follow() {
    let mut plant = hand(HAND, PUBLISHED, PARTS).expect("a scene");
    let names: Vec<_> = plant.scene().bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["arm.world", "arm.upper", "arm.left", "arm.right"], "frames are not bodies");
    assert_eq!(
        plant.scene().remarks,
        [
            "arm: link `flange` has a mass of 0: it is a frame",
            "arm: joint `shoulder` cannot stand at 0: it begins at -2"
        ]
    );
    let joints: Vec<_> = plant.scene().joints.iter().map(|joint| (joint.name.as_str(), joint.initial)).collect();
    assert_eq!(joints, [("arm.shoulder", -2.0), ("arm.left", 0.02), ("arm.right", 0.02)]);
    let join = plant.join();
    let (reads, writes) = (PortLayout::new(join.reads), PortLayout::new(join.writes));
    let (mut inputs, mut outputs) = (vec![0; reads.size()], vec![0; writes.size()]);
    plant.setup(&mut outputs).expect("a set-up");
    reads.slot::<f64>("Angle").expect("an input").set(&mut inputs, -2.0);
    reads.slot::<f64>("Width").expect("an input").set(&mut inputs, 0.04);
    for k in 1..=300_u64 {
        plant.turn(VirtualTime::from_nanos(k * 10_000_000), &inputs, &mut outputs).expect("a turn");
    }
    let angle = writes.slot::<f64>("Angle_Is").expect("an output").get(&outputs);
    assert!((angle + 2.0).abs() < 0.01, "{angle}");
    let at = |name: &str| plant.poses().find(|pose| pose.name == name).expect("a body").position_m;
    let (left, right, upper) = (at("arm.left"), at("arm.right"), at("arm.upper"));
    let apart = |one: [f64; 3], other: [f64; 3]| {
        one.iter().zip(&other).map(|(one, other)| (one - other).powi(2)).sum::<f64>().sqrt()
    };
    // the right finger slides the other way, half as far and 10 mm
    assert!((apart(left, right) - (0.04 + 0.5 * 0.04 + 0.01)).abs() < 1e-3, "{left:?} {right:?}");
    // both 0.4 m along the rod, which is 0.8 m long; the left one 40 mm beside it
    assert!((apart(left, upper) - (0.4_f64.powi(2) + 0.04_f64.powi(2)).sqrt()).abs() < 1e-3, "{left:?} {upper:?}");
}

#[test]
fn all_that_is_wrong_with_a_robot_is_reported_at_once_in_its_own_file() {
    let reported = |scene: &str, arm: &str, parts: &str| {
        let error = hand(scene, arm, parts).err().expect("refused");
        let one = |fault: &onescan_plant::SceneFault| {
            let place = fault.inside.as_ref().map(|inside| inside.place.start().to_string()).unwrap_or_default();
            let place = place.rsplit('/').next().unwrap_or_default().to_owned();
            let hint = fault.hint.as_ref().map(|hint| format!(" ({hint})")).unwrap_or_default();
            let said = fault.inside.as_ref().map_or_else(|| fault.kind.to_string(), |inside| inside.reported.clone());
            format!("{place}: {said}{hint}")
        };
        error.faults().iter().map(one).collect::<Vec<_>>().join("\n")
    };
    let mut all = vec![
        reported(&HAND.replace("density_kg_m3 = 2700\n", ""), PUBLISHED, PARTS),
        reported(
            &HAND.replace("left = 0.02", "left = 0.05, right = 0.01, lefd = 0.01, shoulder = 0.1"),
            PUBLISHED,
            PARTS,
        ),
        reported(&HAND.replace("\"arm.left\"", "\"arm.right\""), PUBLISHED, PARTS),
        reported(HAND, &PUBLISHED.replace("<xacro:rod ", "<xacro:rot "), PARTS),
        reported(HAND, &PUBLISHED.replace(" reach=\"$(arg reach)\"", ""), PARTS),
        reported(HAND, &PUBLISHED.replace("$(arg reach)", "$(arg raech)"), PARTS),
        reported(HAND, &PUBLISHED.replace("parts.xacro", "$(find elsewhere)/parts.xacro"), PARTS),
        reported(HAND, PUBLISHED, &PARTS.replace("${width / 2}", "${widht / 2}")),
        reported(HAND, PUBLISHED, &PARTS.replace("value=\"0.05\"", "value=\"${width * 2}\"")),
        reported(HAND, PUBLISHED, &PARTS.replace("side == 'right'", "side + 'right'")),
        reported(HAND, PUBLISHED, &PARTS.replace("tip.dae", "tap.dae")),
        reported(
            HAND,
            PUBLISHED,
            &PARTS.replace("multiplier=\"0.5\"", "multiplier=\"half\"").replace("upper=\"0.04\"", "upper=\"-1\""),
        ),
        reported(HAND, PUBLISHED, &PARTS.replace("params=\"side sign\"", "params=\"side *:=1\"")),
    ];
    all.retain(|said| !said.is_empty());
    insta::assert_snapshot!(all.join("\n---\n"));
}

/// A slide that lifts a finger: half a metre for each metre.
const LIFT: &str = r#"<robot name="lift">
  <link name="base"/>
  <link name="cart"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>
  <link name="load"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>
  <joint name="drive" type="prismatic">
    <parent link="base"/><child link="cart"/><axis xyz="1 0 0"/><limit lower="0" upper="1" effort="9" velocity="9"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="load"/><axis xyz="0 0 1"/><limit lower="0" upper="1" effort="9" velocity="9"/>
    <mimic joint="drive" multiplier="0.5"/>
  </joint>
</robot>"#;

const LIFTING: &str = r#"
version = 1

[[urdf]]
name = "clock"
file = "robots/urdf/pendulum.urdf"

[[axis]]
name = "drive"
joint = "clock.drive"
drive = "position"
command_signal = "To"
position_signal = "Is"
force_signal = "Force"
speed_m_s = 1.0
acceleration_m_s2 = 2.0
"#;

#[test]
fn what_follows_weighs_on_what_it_follows() {
    let mut plant = plant(LIFTING, LIFT).expect("a scene");
    let join = plant.join();
    let (reads, writes) = (PortLayout::new(join.reads), PortLayout::new(join.writes));
    let (mut inputs, mut outputs) = (vec![0; reads.size()], vec![0; writes.size()]);
    plant.setup(&mut outputs).expect("a set-up");
    reads.slot::<f64>("To").expect("an input").set(&mut inputs, 0.4);
    let mut run = |from: u64, to: u64| {
        for k in from..=to {
            plant.turn(VirtualTime::from_nanos(k * 10_000_000), &inputs, &mut outputs).expect("a turn");
        }
        ["Is", "Force"].map(|name| writes.slot::<f64>(name).expect("an output").get(&outputs))
    };
    let [_, starts_n] = run(1, 20);
    // 1 kg and 0.5² of 2 kg at 2 m/s², and half of the weight
    assert!((starts_n - (1.5 * 2.0 + 9.81)).abs() < 1e-6, "{starts_n}");
    let [is_m, rests_n] = run(21, 300);
    assert!((is_m - 0.4).abs() < 1e-9 && (rests_n - 9.81).abs() < 1e-6, "{is_m} {rests_n}");
    let load = plant.poses().find(|pose| pose.name == "clock.load").expect("a body").position_m;
    assert!((load[2] - 0.2).abs() < 1e-9, "{load:?}");
}
