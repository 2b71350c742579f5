//! Robots from URDF files.

use onescan_clients::plant::{Plant, SceneError};
use onescan_server::client::Client;
use onescan_server::signal::ClientName;
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
    assert_eq!(names, ["clock.base", "clock.rod"], "a frame is no body");
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
fn what_is_wrong_with_a_robot_is_told_with_both_lines() {
    let told = |scene: &str, urdf: &str| plant(scene, urdf).err().map(|error| error.to_string()).unwrap_or_default();
    let broken = PENDULUM.replace("<mass value=\"2\"/>", "<mass value=\"x\"/>");
    let said = told(SCENE, &broken);
    assert!(
        said.contains(":6:8: robot `robots/urdf/pendulum.urdf` line 6: `value` must be a number, not \"x\""),
        "{said}"
    );
    let said = told(SCENE, &PENDULUM.replace("tip.obj", "tap.obj"));
    assert!(said.contains("of which no folder around it has `meshes/tap.obj`"), "{said}");
    let said = told(SCENE, &PENDULUM.replace("type=\"fixed\"", "type=\"floating\""));
    assert!(said.contains("link `tip` moves and has no <inertial>"), "{said}");
    let said = told(&SCENE.replace("pendulum.urdf", "none.urdf"), PENDULUM);
    assert!(said.contains(":6:8: robot `robots/urdf/none.urdf` cannot be read: "), "{said}");
    let said = told(&SCENE.replace("clock.swing", "clock.swign"), PENDULUM);
    assert!(said.contains("no joint `clock.swign` in this scene (did you mean `clock.swing`?)"), "{said}");
}
