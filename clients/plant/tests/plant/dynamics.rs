//! Mass matrix and gravity forces of mechanisms, against closed forms.

use onescan_plant::{Dynamics, Scene};

const G: f64 = 9.81;

/// The only mechanism of a robot, with further keys of its table.
fn dynamics(robot: &str, ending: &str, keys: &str) -> Dynamics {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join(format!("arm.{ending}")), robot).expect("written");
    let scene = format!("version = 1\n[[urdf]]\nname = \"arm\"\nfile = \"arm.{ending}\"\n{keys}");
    let file = folder.path().join("plant.toml");
    let scene = Scene::parse(&scene, &file.display().to_string()).unwrap_or_else(|error| panic!("{error}"));
    let mut found = scene.dynamics();
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

fn close(found: f64, exact: f64) {
    assert!((found - exact).abs() < 1e-12, "{found} in place of {exact}");
}

/// Two links of 3 and 2 kg along x, 0.5 m from joint to joint, that turn upwards.
const TWO: &str = r#"<robot name="two"><link name="base"/>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="3"/><inertia ixx="0.01" iyy="0.05" izz="0.05"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0.1 0 0"/><mass value="2"/><inertia ixx="0.01" iyy="0.03" izz="0.03"/></inertial></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 -1 0"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0.5 0 0"/><axis xyz="0 -1 0"/></joint>
</robot>"#;

#[test]
fn two_links_have_the_mass_matrix_of_the_textbook() {
    let (one, two) = (0.4_f64, -1.1_f64);
    let found = dynamics(TWO, "urdf", &format!("initial_rad = {{ shoulder = {one}, elbow = {two} }}"));
    assert_eq!(found.joints, ["arm.shoulder", "arm.elbow"]);
    let (m1, m2, c1, c2, l) = (3.0, 2.0, 0.2, 0.1, 0.5);
    let lower = 0.03 + m2 * c2 * c2;
    let both = lower + m2 * l * c2 * two.cos();
    let whole = 0.05 + m1 * c1 * c1 + m2 * l * l + 2.0 * both - lower;
    for (entry, exact) in found.mass_matrix.concat().into_iter().zip([whole, both, both, lower]) {
        close(entry, exact);
    }
    let below = m2 * G * c2 * (one + two).cos();
    close(found.gravity[1], below);
    close(found.gravity[0], below + G * (m1 * c1 + m2 * l) * one.cos());
}

/// A file's angle of exactly a quarter turn is where angles for people lose half of their digits.
#[test]
fn a_body_that_stands_on_end_is_turned_exactly() {
    let rod = r#"<mujoco><worldbody><body name="rod" euler="0 90 0"><joint name="swing" axis="0 1 0"/>
        <inertial pos="0.5 0 0" mass="100" diaginertia="1 2 2"/></body></worldbody></mujoco>"#;
    let found = dynamics(rod, "xml", "");
    close(found.gravity[0], 0.0);
    close(found.mass_matrix[0][0], 2.0 + 100.0 * 0.25);
}

/// A joint of MuJoCo's may have another coordinate than 0 where the file draws it.
#[test]
fn a_joint_that_stands_elsewhere_than_at_0_begins_there() {
    let rod = r#"<mujoco><compiler angle="radian"/><worldbody><body name="rod"><joint name="swing" axis="0 1 0" ref="0.7"/>
        <inertial pos="0 0 0.5" mass="2" diaginertia="1 1 1"/></body></worldbody></mujoco>"#;
    close(dynamics(rod, "xml", "").gravity[0], 0.0);
    let turned = dynamics(rod, "xml", "initial_rad = { swing = 1.0 }");
    close(turned.gravity[0], -2.0 * G * 0.5 * 0.3_f64.sin());
}

/// A finger with a tensor of its own, and a shape beside its origin that weighs nothing.
#[test]
fn a_shape_without_mass_changes_no_tensor() {
    let finger = |collision: &str| {
        let robot = format!(
            r#"<robot name="hand"><link name="base"/><link name="finger"><inertial><origin xyz="0 0.001 0.002"/><mass value="0.01"/>
            <inertia ixx="2e-7" iyy="3e-7" izz="4e-7" ixy="3e-8" ixz="-2e-8" iyz="1e-8"/></inertial>{collision}</link>
            <joint name="bend" type="continuous"><parent link="base"/><child link="finger"/><axis xyz="0 0 1"/></joint></robot>"#
        );
        dynamics(&robot, "urdf", "").mass_matrix[0][0]
    };
    let exact = 4e-7 + 0.01 * 1e-6;
    let shape = r#"<collision><origin xyz="0.01 0.02 0" rpy="0.3 0.2 0.1"/><geometry><sphere radius="0.01"/></geometry></collision>"#;
    for found in [finger(""), finger(shape)] {
        assert!((found / exact - 1.0).abs() < 1e-14, "{found} in place of {exact}");
    }
}
