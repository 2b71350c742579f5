//! Kinds of component of one's own, typed from `docs/kinds.md` alone: its files, its commands.

use std::path::Path;

use crate::typed::{digests, edit, typed};

/// The files of the manual in a folder: each stands behind a line with its name.
fn from_the_manual() -> tempfile::TempDir {
    let manual = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/kinds.md");
    let manual = std::fs::read_to_string(manual).expect("a manual");
    let folder = tempfile::tempdir().expect("a folder");
    let mut lines = manual.lines();
    let mut files = 0;
    while let Some(line) = lines.next() {
        let Some(name) = line.strip_prefix('`').and_then(|line| line.strip_suffix("`:")) else { continue };
        let block = lines.by_ref().skip_while(|line| !line.starts_with("```")).skip(1);
        let text: Vec<_> = block.take_while(|line| !line.starts_with("```")).collect();
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        std::fs::write(path, text.join("\n") + "\n").expect("a file");
        files += 1;
    }
    assert_eq!(files, 4, "two kinds, a scene, a scenario");
    folder
}

fn run(folder: &Path, words: &[&str]) -> (Vec<String>, Option<i32>) {
    let said = typed(folder, &[&["run", ".", "--format", "json"], words].concat());
    let reports: Vec<_> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect();
    assert!(!reports.is_empty(), "{said:?}");
    (digests(&reports), said.code)
}

#[test]
fn the_manuals_example_runs() {
    let folder = from_the_manual();
    let (whole, code) = run(folder.path(), &[]);
    assert_eq!(code, Some(0));
    insta::assert_snapshot!("own_kinds_digest", whole[0]);
    // neither transport nor a checkpoint changes a bit
    assert_eq!(run(folder.path(), &["--transport", "tcp"]).0, whole);
    assert_eq!(run(folder.path(), &["--save-at", "23s", "--save", "half.ckpt"]).0, whole);
    assert_eq!(run(folder.path(), &["--resume", "half.ckpt"]).0, whole);
    edit(folder.path(), "components/oven.st", "> 60.0", "> 61.0");
    let refused = typed(folder.path(), &["run", ".", "--resume", "half.ckpt"]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.err.contains("another `code` at component"), "{refused:?}");
}

#[test]
fn a_recording_runs_alone_with_the_kinds_of_its_scene() {
    let folder = from_the_manual();
    let (whole, _) = run(folder.path(), &["--record", "r"]);
    let copy = folder.path().join("r/run-1/scenario");
    assert_eq!(run(&copy, &[]).0, whole);
}

#[test]
fn kinds_of_a_folder_are_listed() {
    let folder = from_the_manual();
    let listed = typed(folder.path(), &["components", "--library", "components"]);
    assert_eq!(listed.code, Some(0), "{listed:?}");
    let (library, own) = listed.out.split_once("\ncomponents\n").expect("the folder behind the library");
    assert!(library.contains("pneumatic_cylinder  "), "{library}");
    insta::assert_snapshot!("own_kinds_listed", own);
    let oven = typed(folder.path(), &["components", "oven", "--library", "components"]);
    let press = typed(folder.path(), &["components", "press", "--library", "components"]);
    insta::assert_snapshot!("own_kinds_in_full", format!("{}\n{}", oven.out, press.out));
    let machine = typed(folder.path(), &["components", "--library", "components", "--format", "json"]);
    let all: Vec<serde_json::Value> = serde_json::from_str(&machine.out).expect("JSON");
    assert!(all.iter().any(|kind| kind["name"] == "press") && all.iter().any(|kind| kind["name"] == "oven"));
    let described = typed(folder.path(), &["describe", "plant.toml"]);
    insta::assert_snapshot!("own_kinds_described", described.out);
}

#[test]
fn what_is_wrong_in_a_folder_of_kinds_is_reported() {
    let folder = from_the_manual();
    edit(folder.path(), "components/oven.st", "flow_w : LREAL", "flow_w : LRAEL");
    let wrong = typed(folder.path(), &["components", "--library", "components"]);
    assert_eq!(wrong.code, Some(2), "{wrong:?}");
    assert!(wrong.out.contains("press: a plate on a guide"), "{wrong:?}");
    insta::assert_snapshot!("own_kinds_wrong", wrong.err);
    let run = typed(folder.path(), &["run", "."]);
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.err.contains("components/oven.st:19:"), "{run:?}");
    let missing = typed(folder.path(), &["components", "--library", "componets"]);
    assert_eq!(missing.code, Some(2), "{missing:?}");
    let unknown = typed(folder.path(), &["components", "ovn", "--library", "components"]);
    assert_eq!(unknown.code, Some(2), "{unknown:?}");
}

/// A folder that scenarios share lies outside of each of them: whoever runs one allows it.
#[test]
fn a_shared_folder_is_read_where_that_is_allowed() {
    let folder = from_the_manual();
    let cell = folder.path().join("cell");
    std::fs::create_dir(&cell).expect("a folder");
    for file in ["plant.toml", "scenario.toml"] {
        std::fs::rename(folder.path().join(file), cell.join(file)).expect("moved");
    }
    edit(&cell, "plant.toml", "\"components\"", "\"../components\"");
    let refused = typed(&cell, &["run", "."]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(
        refused.err.contains("outside of the scenario's folder") && refused.err.contains("--allow-path"),
        "{refused:?}"
    );
    let (shared, code) = run(&cell, &["--allow-path", "../components"]);
    assert_eq!((shared.len(), code), (1, Some(0)));
    edit(&cell, "plant.toml", "../components", "../../..");
    assert_eq!(typed(&cell, &["run", ".", "--allow-path", "../components"]).code, Some(2));
}
