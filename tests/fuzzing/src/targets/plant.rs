//! What plants are made of.

use std::path::{Path, PathBuf};

use onescan_base::{TimeSpan, VirtualTime};
use onescan_plant::Plant;
use onescan_server::client::Client;
use onescan_server::signal::ClientName;

use super::{Prepared, files, seed};

const PERIOD: TimeSpan = TimeSpan::nanos::<10_000_000>();

/// Three turns of a plant, if it is one; its state saved and taken back between them.
fn moves(scene: &Path) -> bool {
    let name = ClientName::new("plant").expect("a name");
    let Ok(mut plant) = Plant::load(scene, name, PERIOD) else { return false };
    let request = plant.join();
    let bytes = |ports: &[onescan_server::signal::Port]| vec![0_u8; ports.iter().map(|port| port.ty.size()).sum()];
    let (inputs, mut outputs) = (bytes(&request.reads), bytes(&request.writes));
    if plant.setup(&mut outputs).is_err() {
        return true;
    }
    for step in 1..=3 {
        if plant.turn(VirtualTime::from_nanos(step * PERIOD.as_nanos()), &inputs, &mut outputs).is_err() {
            break;
        }
        if step == 2 {
            let state = plant.save().expect("a plant that runs can be saved");
            plant.restore(&state).expect("a plant takes back what it has saved");
        }
    }
    true
}

/// A scene; meshes and robots that it names are there.
pub(super) fn scene(scratch: &Path) -> Prepared {
    for name in ["part.stl", "part.obj", "part.dae", "part.gltf", "part.glb", "arm.urdf", "arm.xacro", "arm.xml"] {
        std::fs::write(scratch.join(name), seed(name)).expect("a scratch folder");
    }
    let mut seeds = files("scenarios", &["plant.toml"]);
    seeds.extend(pages());
    seeds.push(text("mesh.toml", "part.stl"));
    seeds.push(text("robot.toml", "arm.urdf"));
    let path = scratch.join("plant.toml");
    Prepared::new(seeds, move |input| {
        std::fs::write(&path, input).expect("a scratch folder");
        moves(&path)
    })
}

/// An assembly, of which a scene has two components.
pub(super) fn assembly(scratch: &Path) -> Prepared {
    let scene = "version = 1\nlibraries = [\"kinds\"]\n\
        [[component]]\nname = \"part[0..1]\"\nkind = \"own\"\nstep_m = [0, 1, 0]\nrpy_deg = [0, 0, 90]\n";
    own(scratch, scene, "own.toml", example("toml", "[[parameter]]"))
}

/// A function block as a kind of component.
pub(super) fn block(scratch: &Path) -> Prepared {
    let scene = "version = 1\nlibraries = [\"kinds\"]\n[[component]]\nname = \"part\"\nkind = \"oven\"\n";
    own(scratch, scene, "oven.st", example("st", "FUNCTION_BLOCK oven"))
}

/// A kind of the user's own in a scene.
fn own(scratch: &Path, scene: &str, file: &'static str, seeds: Vec<Vec<u8>>) -> Prepared {
    std::fs::create_dir_all(scratch.join("kinds")).expect("a scratch folder");
    std::fs::write(scratch.join("plant.toml"), scene).expect("a scratch folder");
    let (scene, path): (PathBuf, PathBuf) = (scratch.join("plant.toml"), scratch.join("kinds").join(file));
    Prepared::new(seeds, move |input| {
        std::fs::write(&path, input).expect("a scratch folder");
        moves(&scene)
    })
}

/// The blocks of the manual of kinds in a language, those with a word in them.
fn example(language: &str, word: &str) -> Vec<Vec<u8>> {
    let pages = files("docs", &["kinds.md"]);
    let pages: Vec<String> = pages.iter().map(|page| String::from_utf8_lossy(page).into_owned()).collect();
    let opening = format!("```{language}\n");
    let blocks = pages.iter().flat_map(|page| page.split(&opening).skip(1));
    let blocks = blocks.filter_map(|block| block.split("```").next()).filter(|block| block.contains(word));
    blocks.map(|block| block.as_bytes().to_vec()).collect()
}

/// The examples of the manual: each block of TOML with a body or a component, made a scene.
fn pages() -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    for page in files("docs", &[".md"]).into_iter().chain(files("clients", &[".md"])) {
        let page = String::from_utf8_lossy(&page).into_owned();
        for block in page.split("```toml\n").skip(1) {
            let block = block.split("```").next().unwrap_or_default();
            if block.contains("[[component]]") || block.contains("[[body]]") || block.contains("[[axis]]") {
                let head = if block.contains("version =") { "" } else { "version = 1\n" };
                found.push(format!("{head}{block}").into_bytes());
            }
        }
    }
    found
}

/// A seed with a file's name in it.
fn text(name: &str, file: &str) -> Vec<u8> {
    String::from_utf8(seed(name)).expect("a text").replace("{}", file).into_bytes()
}

fn beside(scratch: &Path, scene: &str, file: &'static str, seeds: Vec<Vec<u8>>) -> Prepared {
    std::fs::write(scratch.join("plant.toml"), text(scene, file)).expect("a scratch folder");
    std::fs::write(scratch.join("part.stl"), seed("part.stl")).expect("a scratch folder");
    let (scene, path): (PathBuf, PathBuf) = (scratch.join("plant.toml"), scratch.join(file));
    Prepared::new(seeds, move |input| {
        std::fs::write(&path, input).expect("a scratch folder");
        moves(&scene)
    })
}

/// Text and binary.
pub(super) fn stl(scratch: &Path) -> Prepared {
    beside(scratch, "mesh.toml", "part.stl", vec![seed("part.stl"), seed("part-text.stl")])
}

/// Wavefront.
pub(super) fn obj(scratch: &Path) -> Prepared {
    beside(scratch, "mesh.toml", "part.obj", vec![seed("part.obj")])
}

/// COLLADA.
pub(super) fn collada(scratch: &Path) -> Prepared {
    beside(scratch, "mesh.toml", "part.dae", vec![seed("part.dae")])
}

/// glTF as text.
pub(super) fn gltf(scratch: &Path) -> Prepared {
    beside(scratch, "mesh.toml", "part.gltf", vec![seed("part.gltf")])
}

/// glTF in one file.
pub(super) fn glb(scratch: &Path) -> Prepared {
    beside(scratch, "mesh.toml", "part.glb", vec![seed("part.glb")])
}

/// URDF.
pub(super) fn urdf(scratch: &Path) -> Prepared {
    beside(scratch, "robot.toml", "arm.urdf", vec![seed("arm.urdf")])
}

/// xacro.
pub(super) fn xacro(scratch: &Path) -> Prepared {
    beside(scratch, "robot.toml", "arm.xacro", vec![seed("arm.xacro")])
}

/// MJCF.
pub(super) fn mjcf(scratch: &Path) -> Prepared {
    beside(scratch, "robot.toml", "arm.xml", vec![seed("arm.xml")])
}
