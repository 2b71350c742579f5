//! Lists the files of the tasks in `learn` that are handed out, so that the program has each of them.

#[path = "src/handed_out.rs"]
#[expect(dead_code, unreachable_pub, reason = "the library uses the rest of it, and others through it")]
mod handed_out;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Kinds of file that are in the program: what a task needs to run, its sheet and its drawings, which are texts.
const TEXTS: [&str; 7] = ["csv", "md", "st", "svg", "toml", "urdf", "xml"];
/// The drawing of the machine, which the program makes anew: it is longer than all other files together.
const DRAWING: &str = "machine.svg";

fn main() {
    let learn = Path::new(&env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("learn");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/handed_out.rs");
    println!("cargo::rerun-if-changed={}", learn.display());
    let mut table = "const TASKS: &[Task] = &[\n".to_owned();
    for folder in entries(&learn).iter().filter(|path| path.join("scenario.toml").is_file()) {
        let name = folder.file_name().and_then(|name| name.to_str()).expect("tasks have plain names");
        let mut files = Vec::new();
        gather(folder, folder, &mut files);
        writeln!(table, "    Task {{ name: {name:?}, files: &[").expect("a string takes all");
        for file in files {
            let own = file.strip_prefix(folder).expect("it was found there").to_str().expect("a plain name");
            let (own, path) = (own.replace('\\', "/"), file.display().to_string());
            writeln!(table, "        ({own:?}, include_str!({path:?})),").expect("a string takes all");
        }
        table.push_str("    ] },\n");
    }
    table.push_str("];\n");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    fs::write(out.join("tasks.rs"), table).expect("cargo's folder can be written");
}

fn gather(task: &Path, folder: &Path, files: &mut Vec<PathBuf>) {
    for path in entries(folder) {
        let is_text = path.extension().is_some_and(|extension| TEXTS.iter().any(|known| extension == *known));
        let own = path.strip_prefix(task).expect("it was found there");
        if !handed_out::is_handed_out(own) || own.ends_with(DRAWING) {
            continue;
        }
        if path.is_dir() {
            gather(task, &path, files);
        } else if is_text {
            files.push(path);
        }
    }
}

/// What is in a folder, in the order of names.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of tasks");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry that can be read").path()).collect();
    paths.sort();
    paths
}
