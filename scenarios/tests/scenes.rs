//! The scenes of the repository ask for nothing that a plant cannot carry.

use std::path::{Path, PathBuf};

use onescan_scenario::Scenario;

fn folders(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            folders(&path, found);
        } else if path.file_name().is_some_and(|name| name == "scenario.toml") {
            found.push(folder.to_path_buf());
        }
    }
}

#[test]
fn no_scene_overlaps_or_asks_for_too_much() {
    let mut found = Vec::new();
    folders(Path::new(env!("CARGO_MANIFEST_DIR")), &mut found);
    found.sort();
    let mut plants = 0;
    for folder in found {
        // templates have blanks to fill in, which `onescan new` does
        if folder.iter().any(|part| part == "templates") {
            continue;
        }
        let scenario = Scenario::load(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let overlaps = scenario.overlaps().unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        assert!(overlaps.is_empty(), "{}: {overlaps:?}", folder.display());
        let excesses = scenario.excesses().unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        assert!(excesses.is_empty(), "{}: {excesses:?}", folder.display());
        plants += 1;
    }
    assert!(plants > 5, "{plants}");
}
