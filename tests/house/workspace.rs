//! The crates of the workspace, and what their manifests name. Nothing but the standard library reads them, so that
//! the law can be built and run by itself.

use std::path::{Path, PathBuf};

use crate::root;

/// The folders of the crates, as the workspace's manifest lists them; those without sources of their own left out.
pub fn crates() -> Vec<String> {
    let text = std::fs::read_to_string(root().join("Cargo.toml")).expect("the workspace's manifest");
    let (_, after) = text.split_once("\nmembers = [").expect("a list of members");
    let (list, _) = after.split_once(']').expect("an end of the list");
    let members = list.split(',').map(|member| member.trim().trim_matches('"').to_owned());
    members.filter(|member| !member.is_empty() && root().join(member).join("src").is_dir()).collect()
}

/// The name under which others depend on a crate.
pub fn package(folder: &str) -> String {
    let text = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).expect("a manifest");
    let line = text.lines().find_map(|line| line.strip_prefix("name = ")).expect("a name");
    line.trim().trim_matches('"').to_owned()
}

/// The crates of this workspace that a crate depends on, other than for its tests.
pub fn dependencies(folder: &str) -> Vec<String> {
    let path = root().join(folder).join("Cargo.toml");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut found = Vec::new();
    let mut inside = false;
    for line in text.lines().map(str::trim) {
        if line.starts_with('[') {
            inside = line.ends_with("dependencies]") && !line.contains("dev-");
        } else if inside && line.starts_with("onescan") {
            let end = line.find(['.', ' ', '=']).unwrap_or(line.len());
            found.push(line[..end].to_owned());
        }
    }
    found
}

/// The Rust files below a folder, in the order of their paths.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    files_ending(folder, "rs")
}

/// The files below a folder whose names end so, in the order of their paths.
pub fn files_ending(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    collect(folder, &mut found);
    found.retain(|path| path.extension().is_some_and(|extension| extension == ending));
    found.sort();
    found
}

/// All folders below a folder, itself included.
pub fn folders(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![folder.to_owned()];
    collect(folder, &mut found);
    found.retain(|path| path.is_dir());
    found.sort();
    found
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for entry in entries {
        let path = entry.expect("a folder that can be read").path();
        if path.is_dir() {
            collect(&path, found);
        }
        found.push(path);
    }
}

/// A path from the root of the repository.
pub fn name(path: &Path) -> String {
    path.strip_prefix(root()).expect("below the root").display().to_string()
}
