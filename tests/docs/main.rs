//! The repository's Markdown: its links lead somewhere, the index lists every document, the manuals name every key, and
//! the page of modules has the tables of the sources.

mod keys;
mod libraries;
mod links;
mod markdown;
mod rooms;

use std::path::{Path, PathBuf};

/// Folders whose Markdown is not ours.
const PASSED_OVER: [&str; 2] = ["target", "node_modules"];

/// The folder of the workspace.
fn repository() -> PathBuf {
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    crate_folder.parent().expect("the tests are a member of a workspace").to_owned()
}

/// All Markdown files below `folder`, in order, except those in hidden folders.
fn markdown_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder that can be read") {
            let path = entry.expect("an entry that can be read").path();
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if path.is_dir() && !name.starts_with('.') && !PASSED_OVER.contains(&name.as_str()) {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
