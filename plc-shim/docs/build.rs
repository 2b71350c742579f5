//! Lists the pages in `codes`, so that the program has each of them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let codes = Path::new(&env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("codes");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={}", codes.display());
    let entries = fs::read_dir(&codes).expect("the folder of the pages");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry that can be read").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "md"));
    files.sort();
    let mut table = "const CODES: &[(&str, &str)] = &[\n".to_owned();
    for file in &files {
        let code = file.file_stem().and_then(|stem| stem.to_str()).expect("codes are plain names");
        let path = file.display().to_string();
        writeln!(table, "    ({code:?}, include_str!({path:?})),").expect("a string takes all");
    }
    table.push_str("];\n");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    fs::write(out.join("codes.rs"), table).expect("cargo's folder can be written");
}
