//! Habits of published robots' files: URLs of files, labels as meshes, several joints on one body.

use std::path::{Path, PathBuf};

use onescan_base::regular::Within;
use onescan_plant::{Scene, SceneError};

const CUBE: &str = "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const LABEL: &str = "v 0 0 0\nv 50 0 0\nv 0 50 0\nf 1 3 2\n";

/// A folder with files of these names.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        std::fs::write(path, text).expect("written");
    }
    folder
}

/// The scene of a robot's file in a folder, with more keys of its table, where only what is in the folder may be read.
fn scene(folder: &Path, file: &str, keys: &str) -> Result<Scene, SceneError> {
    let text = format!("version = 1\n[[urdf]]\nname = \"r\"\nfile = \"{file}\"\n{keys}\n");
    let within = Within::places(vec![folder.to_path_buf()]);
    Scene::parse_with(&text, &folder.join("plant.toml").display().to_string(), &[], &within)
}

fn reported(result: Result<Scene, SceneError>) -> String {
    result.err().map(|error| error.to_string()).unwrap_or_default()
}

const XACRO: &str = r#"<robot xmlns:xacro="http://wiki.ros.org/xacro">
  <xacro:include filename="file://$(find arm)/urdf/parts.xacro"/>
  <link name="base">
    <collision><geometry><mesh filename="MESH" scale="0.001 0.001 0.001"/></geometry></collision>
  </link>
  <link name="${part}"/>
  <joint name="end" type="fixed"><parent link="base"/><child link="${part}"/></joint>
</robot>"#;

const PARTS: &str =
    r#"<robot xmlns:xacro="http://wiki.ros.org/xacro"><xacro:property name="part" value="hand"/></robot>"#;

/// A path to the same place from the folder in which the tests run.
#[cfg(unix)]
fn relative(path: &Path) -> PathBuf {
    let here = std::env::current_dir().expect("a folder");
    let up: PathBuf = here.components().skip(1).map(|_| "..").collect();
    up.join(path.strip_prefix("/").expect("absolute"))
}

#[cfg(not(unix))]
fn relative(path: &Path) -> PathBuf {
    path.to_path_buf()
}

#[test]
fn what_find_gives_may_stand_behind_file() {
    let forms = [
        "file://$(find arm)",
        "file:///$(find arm)",
        "$(find arm)",
        "package://arm",
        "file://$(dirname)/..",
        "file://..",
        "..",
    ];
    for form in forms {
        let xacro = XACRO.replace("MESH", &format!("{form}/meshes/cube.obj"));
        let files = folder(&[
            ("arm/urdf/arm.xacro", xacro.as_str()),
            ("arm/urdf/parts.xacro", PARTS),
            ("arm/meshes/cube.obj", CUBE),
        ]);
        for place in [files.path().to_path_buf(), relative(files.path())] {
            let found = scene(&place, "arm/urdf/arm.xacro", "").expect(form);
            assert_eq!(found.shapes.len(), 1, "{form}");
            let named = format!("{:?}", found.shapes[0]);
            assert!(
                named.contains("meshes/cube.obj") && !named.contains(&files.path().display().to_string()),
                "{named}"
            );
        }
    }
}

#[test]
fn a_file_url_leads_nowhere_that_may_not_be_read() {
    let other = folder(&[("cube.obj", CUBE), ("parts.xacro", PARTS)]);
    let url = format!("file://{}/cube.obj", other.path().display());
    let files = folder(&[("arm/urdf/arm.xacro", &XACRO.replace("MESH", &url)), ("arm/urdf/parts.xacro", PARTS)]);
    let said = reported(scene(files.path(), "arm/urdf/arm.xacro", ""));
    assert!(said.contains("outside of the scenario's folder"), "{said}");
    let include = XACRO.replace("$(find arm)/urdf", &other.path().display().to_string());
    let files = folder(&[("arm/urdf/arm.xacro", include.as_str())]);
    let said = reported(scene(files.path(), "arm/urdf/arm.xacro", ""));
    assert!(said.contains("outside of the scenario's folder"), "{said}");
}

const LABELLED: &str = r#"<mujoco>
  <asset><mesh name="label" file="label.obj"/></asset>
  <worldbody>
    <body name="arm"><joint name="turn"/><geom type="box" size="0.1 0.1 0.1"/>
      <geom type="mesh" mesh="label" contype="0" conaffinity="0"/></body>
  </worldbody>
</mujoco>"#;

#[test]
fn a_flat_mesh_is_left_out() {
    let read = |mjcf: &str, mesh: &str| scene(folder(&[("arm.xml", mjcf), ("label.obj", mesh)]).path(), "arm.xml", "");
    for mjcf in [LABELLED, &LABELLED.replace(" contype=\"0\"", "")] {
        let labelled = read(mjcf, LABEL).expect("a scene");
        assert_eq!(labelled.remarks, ["r: the mesh `label.obj` of link `arm` is flat: it is left out"]);
        assert_eq!(labelled.shapes.len(), 1);
    }
    assert_eq!(read(LABELLED, CUBE).expect("a scene").shapes.len(), 2);
}

#[test]
fn an_included_file_leads_nowhere_that_may_not_be_read() {
    let other = folder(&[("hand.xml", "<mujocoinclude><body name='hand'><geom size='0.1'/></body></mujocoinclude>")]);
    let named = format!("{}/hand.xml", other.path().display());
    let model = "<mujoco><worldbody><include file='HAND'/></worldbody></mujoco>";
    let files = folder(&[
        ("arm.xml", &model.replace("HAND", &named)),
        ("own.xml", &model.replace("HAND", "hand.xml")),
        ("hand.xml", "<mujocoinclude><body name='hand'><geom size='0.1'/></body></mujocoinclude>"),
    ]);
    let said = reported(scene(files.path(), "arm.xml", ""));
    assert!(said.contains("outside of the scenario's folder"), "{said}");
    let own = scene(files.path(), "own.xml", "").expect("a scene");
    assert_eq!(own.shapes.len(), 1, "{:?}", own.shapes);
}

const SPECK: &str = r#"<robot name="speck"><link name="base"/>
  <link name="rod"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
    <collision><geometry><cylinder length="1" radius="0.00000001"/></geometry></collision>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="rod"/></joint></robot>"#;

#[test]
fn a_shape_that_is_too_small_for_a_body_is_left_out() {
    let speck = scene(folder(&[("arm.urdf", SPECK)]).path(), "arm.urdf", "").expect("a scene");
    assert_eq!(speck.remarks, ["r: a shape of link `rod` has no size or less than 0.1 mm: it is left out"]);
    assert_eq!(speck.shapes.len(), 1);
}

/// A base that turns, and slides along where it has turned to.
const BASE: &str = r#"<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base" pos="0 0 1">
      <joint name="yaw" type="hinge" axis="0 0 1" pos="1 0 0"/>
      <joint name="ahead" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.1 0.1 0.1"/>
    </body>
  </worldbody>
</mujoco>"#;

#[test]
fn joints_of_one_body_turn_and_move_each_other_in_their_order() {
    let files = folder(&[("base.xml", BASE)]);
    let posed = "initial_rad = { yaw = 1.5707963267948966 }\ninitial_m = { ahead = 3 }";
    let base = scene(files.path(), "base.xml", &format!("kinematic = true\n{posed}")).expect("a scene");
    let at = base.bodies.iter().find(|body| body.name == "r.base").expect("a body").position_m;
    // about (1, 0): the origin goes to (1, -1), from there 3 m along y
    assert!(at.iter().zip([1.0, 2.0, 1.0]).all(|(is, wanted)| (is - wanted).abs() < 1e-9), "{at:?}");
    let said = reported(scene(files.path(), "base.xml", posed));
    assert!(said.contains("line 5: link `base.yaw` moves and has no mass (`density_kg_m3 = 2700`"), "{said}");
    let dynamic = scene(files.path(), "base.xml", &format!("density_kg_m3 = 2700\n{posed}")).expect("a scene");
    assert!(dynamic.remarks.iter().any(|said| said.contains("link `base.yaw` moves and has no shape: it is a ball")));
}
