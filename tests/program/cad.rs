//! Parts from CAD: a STEP file by a converter in Python, as docs/plant.md shows it, in a scene.

use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::typed::typed;
use crate::venv;

/// The roller of `tests/peers/roller.step`, m: a cylinder whose ends are frustums. It was drawn in Gmsh by these measures.
const RADIUS: f64 = 0.03;
const LENGTH: f64 = 0.4;
const CHAMFER: f64 = 0.01;

/// It is lifted, for its mass, and turned about its axis, for its moment of inertia.
const SCENE: &str = r#"version = 1

[[body]]
name = "roller[0..1]"
kind = "dynamic"
shape = "mesh"
mesh = "roller.obj"
unit_m = 0.001
density_kg_m3 = 7850.0
position_m = [0.0, 0.0, 1.0]
step_m = [0.0, 0.2, 0.0]

[[joint]]
name = "lift"
kind = "prismatic"
parent = "ground"
child = "roller[0]"
axis = [0, 0, 1]

[[joint]]
name = "turn"
kind = "revolute"
parent = "ground"
child = "roller[1]"
anchor_m = [0.0, 0.2, 1.0]
axis = [1, 0, 0]
"#;

/// Mass in kg and moment of inertia about the axis in kg·m², of steel.
fn closed_form() -> [f64; 2] {
    let (barrel, end) = (LENGTH - 2.0 * CHAMFER, RADIUS - CHAMFER);
    // the integrals of r² and of r⁴ along the axis
    let squares = barrel * RADIUS.powi(2) + 2.0 * CHAMFER * (RADIUS.powi(3) - end.powi(3)) / (3.0 * (RADIUS - end));
    let fourths = barrel * RADIUS.powi(4) + 2.0 * CHAMFER * (RADIUS.powi(5) - end.powi(5)) / (5.0 * (RADIUS - end));
    [7850.0 * PI * squares, 7850.0 * PI / 2.0 * fourths]
}

/// What a scene has of the roller if its mesh may be off by so much, and how many triangles that is.
fn meshed(python: &Path, folder: &Path, off_mm: f64, off_rad: f64) -> ([f64; 2], usize) {
    let step = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/roller.step");
    let convert = "import cascadio, sys; sys.exit(cascadio.step_to_obj(*sys.argv[1:3], *map(float, sys.argv[3:])))";
    let mut command = Command::new(python);
    command.args(["-c", convert]).arg(step).arg(folder.join("roller.obj"));
    let output = command.args([off_mm.to_string(), off_rad.to_string()]).output().expect("Python starts");
    assert!(output.status.success(), "{output:?}");
    let mesh = std::fs::read_to_string(folder.join("roller.obj")).expect("a mesh");
    let triangles = mesh.lines().filter(|line| line.starts_with("f ")).count();
    let said = typed(folder, &["describe", "plant.toml", "--dynamics", "--format", "json"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let scene: Value = serde_json::from_str(&said.out).expect("JSON");
    let row = |which: usize| scene["dynamics"][which]["mass_matrix"][0][0].as_f64().expect("a number");
    ([row(0), row(1)], triangles)
}

/// Chords that are off by s from their circle take 4/3 s/r of its area, and twice that of its moment of inertia.
#[test]
fn a_part_in_step_has_the_mass_and_the_inertia_of_its_closed_form() {
    let python = match venv::tried("cascadio", &["cascadio", "numpy"]) {
        Ok(python) => python,
        Err(why) => {
            eprintln!("skipped: cascadio cannot be installed: {why}");
            return;
        }
    };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("plant.toml"), SCENE).expect("a file");
    let [fine, coarse] = [(0.1, 0.3), (0.5, 0.5)].map(|(off_mm, off_rad)| {
        let (found, triangles) = meshed(&python, folder.path(), off_mm, off_rad);
        let most = off_mm / 1000.0 / RADIUS;
        for ((found, wanted), most) in found.iter().zip(closed_form()).zip([most * 4.0 / 3.0, most * 8.0 / 3.0]) {
            let less = 1.0 - found / wanted;
            assert!((0.0..most).contains(&less), "{found} for {wanted} at {off_mm} mm");
        }
        triangles
    });
    assert!(coarse < fine / 2, "{coarse} triangles, {fine}");
}
