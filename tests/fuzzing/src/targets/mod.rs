//! The parsers of bytes from outside: for each, good inputs to begin with, and what the program does with an input.
//!
//! | module | parsers |
//! |---|---|
//! | `wire` | frames and messages of sessions; telegrams of PLCs |
//! | `scenario` | scenarios, cases, expectations, links, tokens |
//! | `plant` | scenes, meshes, robots |
//! | `source` | PLC sources, projects, I/O lists |
//! | `kept` | checkpoints, states of clients, recordings, snapshots |
//!
//! The OPC UA `NodeSet` is only written; OPC UA and Modbus frames are read by libraries.

mod kept;
mod plant;
mod scenario;
mod source;
mod wire;

use std::path::{Path, PathBuf};

/// A parser.
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// What is parsed, and how far.
    pub about: &'static str,
    /// Makes it ready, with its files in this folder.
    pub prepare: fn(&Path) -> Prepared,
}

/// A parser with what it needs.
pub struct Prepared {
    /// Good inputs.
    pub seeds: Vec<Vec<u8>>,
    /// Words of its format beside those of the good inputs.
    pub words: &'static [&'static str],
    /// Puts right what would hide all other faults, such as a checksum.
    pub mend: fn(&mut Vec<u8>),
    /// Takes an input; true if it is a good one.
    pub take: Box<Take>,
}

/// Takes an input; true if it is a good one.
pub type Take = dyn FnMut(&[u8]) -> bool;

impl Prepared {
    fn new(seeds: Vec<Vec<u8>>, take: impl FnMut(&[u8]) -> bool + 'static) -> Self {
        Self { seeds, words: &[], mend: |_| (), take: Box::new(take) }
    }
}

/// All of them.
pub const TARGETS: &[Target] = &[
    Target { name: "wire", about: "frames, messages, a client's side of a session", prepare: wire::session },
    Target { name: "telegrams", about: "answers and requests of S7 and ADS", prepare: wire::telegrams },
    Target { name: "blocks", about: "data blocks in a stream, cut and decoded", prepare: wire::blocks },
    Target { name: "scanner", about: "commands to an infrared scanner", prepare: wire::scanner },
    Target { name: "scenario", about: "scenario.toml, up to its clients", prepare: scenario::scenario },
    Target { name: "cases", about: "cases.toml, each put on its scenario", prepare: scenario::cases },
    Target { name: "expectation", about: "a formula, judged over a run", prepare: scenario::expectation },
    Target { name: "link", about: "the mapping of a gateway, listed", prepare: scenario::link },
    Target { name: "tokens", about: "the register of tokens", prepare: scenario::tokens },
    Target { name: "certificate", about: "certificate and key in PEM", prepare: scenario::certificate },
    Target { name: "subject", about: "whom a client's certificate is for", prepare: scenario::subject },
    Target { name: "scene", about: "a scene, for three turns", prepare: plant::scene },
    Target { name: "assembly", about: "an assembly, in a scene for three turns", prepare: plant::assembly },
    Target { name: "block", about: "a function block as a component, for three turns", prepare: plant::block },
    Target { name: "stl", about: "a mesh, as a body", prepare: plant::stl },
    Target { name: "obj", about: "a mesh, as a body", prepare: plant::obj },
    Target { name: "collada", about: "a mesh, as a body", prepare: plant::collada },
    Target { name: "gltf", about: "a mesh, as a body", prepare: plant::gltf },
    Target { name: "glb", about: "a mesh, as a body", prepare: plant::glb },
    Target { name: "urdf", about: "a robot, for three turns", prepare: plant::urdf },
    Target { name: "xacro", about: "a robot, for three turns", prepare: plant::xacro },
    Target { name: "mjcf", about: "a robot, for three turns", prepare: plant::mjcf },
    Target { name: "st", about: "Structured Text, checked, compiled, run, instrumented", prepare: source::st },
    Target { name: "scl", about: "SCL, checked, compiled, run, instrumented", prepare: source::scl },
    Target { name: "plcopen", about: "PLCopen XML, checked, compiled, run, instrumented", prepare: source::plcopen },
    Target {
        name: "twincat",
        about: "TwinCAT objects, checked, compiled, run, instrumented",
        prepare: source::twincat,
    },
    Target { name: "project", about: "the list of files of a TwinCAT project", prepare: source::project },
    Target {
        name: "io-list",
        about: "lists of engineering tools; the first byte says which",
        prepare: source::io_list,
    },
    Target { name: "checkpoint", about: "a checkpoint with a right checksum, resumed", prepare: kept::checkpoint },
    Target { name: "plc-state", about: "the state of a soft PLC, restored and run", prepare: kept::plc_state },
    Target {
        name: "plant-state",
        about: "the state of a plant with a right checksum, restored and run",
        prepare: kept::plant_state,
    },
    Target { name: "recording", about: "a part of a trajectory, read and exported", prepare: kept::part },
    Target { name: "header", about: "the header of a recording", prepare: kept::header },
    Target { name: "events", about: "the events of a recording, as an operator's", prepare: kept::events },
    Target { name: "snapshot", about: "a snapshot, written again and compared", prepare: kept::snapshot },
];

/// The project's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A good input of `tests/fuzzing/seeds`.
fn seed(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All files of a folder of the project, at any depth, with one of these endings and no longer than 40 kB.
fn files(folder: &str, endings: &[&str]) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for entry in entries {
            let path = entry.expect("a folder that can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if endings.iter().any(|ending| path.to_string_lossy().ends_with(ending)) {
                found.push(path);
            }
        }
    }
    found.sort();
    let read = found.iter().map(|path| std::fs::read(path).expect("a file that can be read"));
    read.filter(|bytes| bytes.len() <= 40_000).collect()
}

/// A copy of the files of the shear in `folder`.
fn shear(folder: &Path) -> PathBuf {
    let (from, to) = (root().join("scenarios/shear"), folder.join("shear"));
    for below in ["", "plc", "snapshots"] {
        std::fs::create_dir_all(to.join(below)).expect("a scratch folder");
        for entry in std::fs::read_dir(from.join(below)).expect("the shear") {
            let path = entry.expect("the shear").path();
            if path.is_file() {
                std::fs::copy(&path, to.join(below).join(path.file_name().expect("a file"))).expect("a scratch folder");
            }
        }
    }
    to
}
