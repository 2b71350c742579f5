//! Makes the page in `dist`, if it was built, a part of the program. Without it the program says how to get it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let web = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let page = web.join("dist");
    // cargo runs this at every build while what it is to watch is not there
    if let Some(watched) = [&page, &web].into_iter().find(|folder| folder.is_dir()) {
        println!("cargo::rerun-if-changed={}", watched.display());
    }
    println!("cargo::rerun-if-changed=build.rs");
    let mut files: Vec<PathBuf> = fs::read_dir(&page)
        .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
        .unwrap_or_default();
    // a folder without its first page is half a build
    if !files.iter().any(|file| file.ends_with("index.html")) {
        files.clear();
    }
    files.sort();
    let mut table = "const PAGE: &[File] = &[\n".to_owned();
    for file in &files {
        let Some(media) = media(file) else { continue };
        let name = file.file_name().and_then(|name| name.to_str()).expect("the page's files have plain names");
        let path = file.canonicalize().expect("it was just listed");
        writeln!(table, "    ({name:?}, {media:?}, include_bytes!({:?})),", path.display())
            .expect("a string takes all");
        println!("cargo::rerun-if-changed={}", file.display());
    }
    table.push_str("];\n");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    fs::write(out.join("page.rs"), table).expect("cargo's folder can be written");
}

/// The media type of a file of the page; none of what the page does not need.
fn media(file: &Path) -> Option<&'static str> {
    match file.extension()?.to_str()? {
        "html" => Some("text/html; charset=utf-8"),
        "js" => Some("text/javascript; charset=utf-8"),
        "css" => Some("text/css; charset=utf-8"),
        "svg" => Some("image/svg+xml"),
        "png" => Some("image/png"),
        _ => None,
    }
}
