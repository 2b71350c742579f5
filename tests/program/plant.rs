//! `components` and `describe` as they are typed.

use onescan_plant::component::kind::Kind;
use onescan_plant::component::kinds;

use crate::typed::{copied_shear, edit, scenario, typed};

const CELL: &str = r#"version = 1
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
[[component]]
name = "clamp"
kind = "pneumatic_cylinder"
joint = "slide"
valve = "5/3-closed"
extend_signal = "Clamp"
extended_signal = "Clamped"
[[component]]
name = "gauge"
kind = "pressure_sensor"
pressure_bar_from = "clamp.cap_bar"
measured_bar_signal = "Pressure"
[[failure]]
component = "clamp"
mode = "leaking"
"#;

#[test]
fn the_library_is_listed() {
    let said = typed(&scenario("shear"), &["components"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    // What is in the library is the library's business: a new kind needs no change here.
    let kinds = kinds();
    let width = kinds.iter().map(|kind| kind.name.len()).max().expect("there are kinds");
    let line = |kind: &Kind| format!("{:width$}  {}\n", kind.name, kind.summary);
    assert_eq!(said.out, kinds.iter().map(line).collect::<String>());
}

#[test]
fn one_kind_is_described_in_full() {
    let said = typed(&scenario("shear"), &["components", "lamp"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    insta::assert_snapshot!(said.out);
    let said = typed(&scenario("shear"), &["components", "lamp", "--format", "json"]);
    let kind: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!((&kind["name"], &kind["failures"][0]["mode"]), (&"lamp".into(), &"burnt".into()));
}

#[test]
fn a_kind_that_is_not_there_has_a_nearest_name() {
    let said = typed(&scenario("shear"), &["components", "lampe"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(
        said.err.contains("there is no component `lampe`") && said.err.contains("did you mean `lamp`?"),
        "{said:?}"
    );
}

#[test]
fn a_scene_is_described_as_a_tree() {
    let said = typed(&scenario("shear"), &["describe", "plant.toml"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    insta::assert_snapshot!("shear_described", said.out);
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("cell.toml"), CELL).expect("written");
    insta::assert_snapshot!("cell_described", typed(folder.path(), &["describe", "cell.toml"]).out);
    let said = typed(folder.path(), &["describe", "cell.toml", "--format", "json"]);
    let scene: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(scene["components"][0]["kind"], "pneumatic_cylinder");
}

/// Twenty packages that are alike are one line; the last one differs, and stands alone.
#[test]
fn bodies_of_an_array_that_are_alike_are_one_line() {
    let said = typed(&scenario("filling-machine"), &["describe", "."]);
    assert!(said.out.contains("\n  package[0..19]: dynamic, box") && !said.out.contains("package[1]: "), "{said:?}");
    let folder = tempfile::tempdir().expect("a folder");
    let body = |name: &str, side: u32| {
        format!("[[body]]\nname = \"{name}\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [{side}, 1, 1]\n")
    };
    let scene = ["version = 1\n".to_owned(), body("a[0..2]", 1), body("a[3]", 2), body("b[0]", 2)].concat();
    std::fs::write(folder.path().join("cell.toml"), scene).expect("written");
    let said = typed(folder.path(), &["describe", "cell.toml"]);
    let about = |side: u32| format!("fixed, box {side} x 1 x 1 m");
    let bodies = format!("  a[0..2]: {}\n  a[3]: {}\n  b[0]: {}\n", about(1), about(2), about(2));
    assert!(said.out.contains(&bodies), "{said:?}");
}

#[test]
fn a_scenario_is_described_by_its_scenes() {
    let shear = scenario("shear");
    let (by_file, by_folder) = (typed(&shear, &["describe", "plant.toml"]), typed(&shear, &["describe", "."]));
    assert_eq!((by_folder.code, by_folder.out), (Some(0), by_file.out));
    let said = typed(&shear, &["describe", "plnat.toml"]);
    assert!(said.code == Some(2) && said.err.contains("the folder of its scenario"), "{said:?}");
}

#[test]
fn a_scene_is_drawn_from_all_sides() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("machine.svg");
    let mut pictures = Vec::new();
    for view in ["corner", "front", "back", "left", "right", "top"] {
        let said = typed(&scenario("shear"), &["describe", ".", "--svg", &file.to_string_lossy(), "--view", view]);
        assert_eq!(said.code, Some(0), "{said:?}");
        let svg = std::fs::read_to_string(&file).expect("a picture");
        assert!(svg.contains("<title>blade</title>") && svg.contains(&format!("from side `{view}`")), "{svg}");
        pictures.push(svg);
    }
    pictures.sort();
    pictures.dedup();
    assert_eq!(pictures.len(), 6, "each side shows something else");
    let said = typed(&scenario("shear"), &["describe", ".", "--view", "top"]);
    assert!(said.code == Some(2) && said.err.contains("--svg"), "a side without a picture: {said:?}");
}

/// A scenario's figures are drawn as its page shows them at the start: where looks put them, without those that looks hide. The
/// floor lies behind all that stands on it; the scene alone has no figures.
#[test]
fn a_scenario_is_drawn_with_its_figures_as_they_are_at_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("machine.svg");
    let drawn = |name: &str, path: &str| {
        let said = typed(&scenario(name), &["describe", path, "--svg", &file.to_string_lossy(), "--view", "front"]);
        assert!(said.code == Some(0) && said.err.is_empty(), "{said:?}");
        std::fs::read_to_string(&file).expect("a picture")
    };
    let line = drawn("peeling-line", ".");
    for name in ["deck", "log[0]", "log[2]", "walker[3]", "gantry"] {
        assert!(line.contains(&format!("<title>{name}</title>")), "{name} is not there");
    }
    assert!(!line.contains("<title>block_on_loader</title>"), "no block is there yet");
    assert!(line.contains("figure, or in its own colour"));
    assert!(line.find("<title>hall</title>") < line.find("<title>deck_leg[0]</title>"), "the floor comes first");
    assert_eq!(drawn("peeling-line", "."), line, "the same bytes again");
    assert!(!drawn("peeling-line", "plant.toml").contains("<title>deck</title>"));
    let furnace = drawn("arc-furnace", ".");
    assert!(furnace.contains("<title>electrode[3]</title>") && furnace.contains("<title>roof</title>"));
}

#[test]
fn values_with_names_stand_at_the_axis() {
    let folder = copied_shear();
    let plot = folder.path().join("plot.svg");
    let said = typed(
        &scenario("filling-machine"),
        &["run", ".", "--until", "5s", "--plot", &plot.to_string_lossy(), "--signals", "MachineStep"],
    );
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(std::fs::read_to_string(&plot).expect("a plot").contains(">1 Motor_Setup</text>"));
    let line = "Actuator_1_Up = { type = \"BOOL\", writer = \"plc\"";
    edit(folder.path(), "scenario.toml", line, &format!("{line}, names = {{ 2 = \"Two\" }}"));
    let said = typed(folder.path(), &["run", "."]);
    assert!(said.code == Some(2) && said.err.contains("2 is not a value of BOOL"), "{said:?}");
}

#[test]
fn a_wrong_scene_is_shown_where_it_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("cell.toml"), CELL.replace("valve =", "valves =")).expect("written");
    let said = typed(folder.path(), &["describe", "cell.toml"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    insta::assert_snapshot!(said.err);
    assert_eq!(typed(folder.path(), &["describe", "nothing.toml"]).code, Some(2));
}

/// A carriage that is 0.1 mm in its rail: `describe` says so, and so does a run, once.
#[test]
fn bodies_that_overlap_at_the_start_are_named() {
    let folder = copied_shear();
    let scene = folder.path().join("plant.toml");
    let more = r#"
[[body]]
name = "rail"
kind = "fixed"
shape = "box"
size_m = [2.0, 0.2, 0.1]
position_m = [50.0, 0.0, -0.05]
[[body]]
name = "carriage"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.1]
mass_kg = 5.0
position_m = [50.0, 0.0, 0.0499]
"#;
    let text = std::fs::read_to_string(&scene).expect("a scene") + more;
    std::fs::write(&scene, text).expect("it is written");
    let described = typed(folder.path(), &["describe", "plant.toml"]);
    assert_eq!(described.code, Some(0), "{described:?}");
    assert!(described.out.contains("`rail` and `carriage` overlap by 0.100 mm"), "{}", described.out);
    let json = typed(folder.path(), &["describe", "plant.toml", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(json["overlaps"][0]["bodies"], serde_json::json!(["rail", "carriage"]), "{json}");
    let run = typed(folder.path(), &["run", ".", "--until", "20ms", "--runs", "2"]);
    let warned = run.err.replace('\n', " ");
    assert_eq!(warned.matches("overlap by 0.100 mm").count(), 1, "{}", run.err);
}

/// What hangs on joints beside bodies, and what closes a loop.
#[test]
fn fittings_couplings_and_loops_are_listed() {
    let body = |name: &str, x: u32| {
        format!(
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.1\nmass_kg = 1.0\n\
             position_m = [{x}, 0, 0]\n"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"{parent}\"\nchild = \"{child}\"\naxis = [0, 1, 0]\n"
        )
    };
    let mut scene = "version = 1\n".to_owned() + &body("a", 0) + &body("b", 1) + &body("c", 2) + &body("d", 3);
    scene += &(joint("p", "ground", "a") + &joint("q", "ground", "b") + &joint("r", "ground", "c"));
    scene += &(joint("s", "c", "d") + &joint("t", "ground", "d"));
    scene += "[[fitting]]\nname = \"hub\"\njoint = \"p\"\nspring_nm_rad = 4.0\nrest_rad = 0.5\nfriction_nm = 0.1\nbrake_nm = 3.0\n\
              release_signal = \"Go\"\n[[coupling]]\nname = \"gear\"\njoint = \"q\"\nof = [\"p\"]\nratio = [-3.0]\n\
              slip_nm = 20.0\n";
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("plant.toml"), scene).expect("it is written");
    let described = typed(folder.path(), &["describe", "plant.toml"]);
    let listed = "fittings\n  hub: joint p, spring 4 N·m/rad, at rest at 0.5 rad, friction 0.1 N·m, brake 3 N·m released by Go\n\
                  couplings\n  gear: joint q = -3 x p, slips beyond 20 N·m\n";
    assert!(described.out.contains(listed), "{described:?}");
    assert!(described.out.contains("loops\n  joint `t` closes a loop with `r`, `s`\n"), "{described:?}");
}

/// A spring that is too fast for the step: `describe` names it at its end, and so does a run, once.
#[test]
fn what_a_plant_cannot_carry_is_named() {
    let folder = copied_shear();
    let scene = folder.path().join("plant.toml");
    let more = r#"
[[body]]
name = "wagging"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 1.0
position_m = [50.0, 0.0, 0.0]
[[joint]]
name = "wag"
kind = "prismatic"
parent = "ground"
child = "wagging"
axis = [1, 0, 0]
[[fitting]]
name = "leaf"
joint = "wag"
spring_n_m = 400000.0
"#;
    let text = std::fs::read_to_string(&scene).expect("a scene") + more;
    std::fs::write(&scene, text).expect("it is written");
    let described = typed(folder.path(), &["describe", "plant.toml"]);
    let last = described.out.lines().last().unwrap_or_default();
    assert_eq!(
        last, "  the spring of `leaf` on joint `wag` swings with 100.7 Hz, which takes a physics step of 2 ms",
        "{}",
        described.out
    );
    let json = typed(folder.path(), &["describe", "plant.toml", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(json["excesses"][0]["kind"], "swing", "{json}");
    let wired = typed(folder.path(), &["wiring", "."]);
    assert!(wired.out.contains("  plant: the spring of `leaf` on joint `wag` swings with 100.7 Hz"), "{}", wired.out);
    let json = typed(folder.path(), &["wiring", ".", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    let plants = json["plants"].as_array().expect("a list");
    let said =
        |text: &str| plants.iter().any(|plant| plant["message"].as_str().is_some_and(|said| said.contains(text)));
    // the shear's own loop is exact
    assert!(said("100.7 Hz") && !said("closes a loop with"), "{json}");
    let run = typed(folder.path(), &["run", ".", "--until", "20ms", "--runs", "2"]);
    assert_eq!(run.err.replace('\n', " ").matches("100.7 Hz").count(), 1, "{}", run.err);
}

/// What a drive has to hold and to move, in the pose of the scene.
#[test]
fn a_mechanism_is_described_with_its_mass_matrix_if_that_is_wanted() {
    let folder = tempfile::tempdir().expect("a folder");
    let arm = r#"<robot name="arm"><link name="base"/>
<link name="beam"><inertial><origin xyz="0.5 0 0"/><mass value="4"/><inertia ixx="0.1" iyy="0.3" izz="0.3"/></inertial></link>
<joint name="tilt" type="continuous"><parent link="base"/><child link="beam"/><axis xyz="0 -1 0"/></joint></robot>"#;
    std::fs::write(folder.path().join("arm.urdf"), arm).expect("it is written");
    let scene = "version = 1\n[[urdf]]\nname = \"arm\"\nfile = \"arm.urdf\"\n";
    std::fs::write(folder.path().join("plant.toml"), scene).expect("it is written");
    let plain = typed(folder.path(), &["describe", "plant.toml"]);
    assert!(!plain.out.contains("mechanism"), "{}", plain.out);
    let described = typed(folder.path(), &["describe", "plant.toml", "--dynamics"]);
    let last: Vec<_> = described.out.lines().rev().take(2).collect();
    assert_eq!(
        last,
        [
            "  arm.tilt: 19.620000 Nm; 1.300000",
            "mechanism at rest: what holds each joint against gravity, and its row of the mass matrix"
        ]
    );
    let json = typed(folder.path(), &["describe", "plant.toml", "--dynamics", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(json["dynamics"][0]["joints"], serde_json::json!(["arm.tilt"]), "{json}");
}
