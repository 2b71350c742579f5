//! `onescan new`: what it writes runs green at once, is clean, and is never written over anything.

use std::path::Path;

use crate::typed::{Said, onescan, typed};

/// Types a command where Python finds the package `onescan_client`.
fn with_python(folder: &Path, words: &[&str]) -> Said {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../clients/python/src");
    onescan(folder).args(words).env("PYTHONPATH", package).output().expect("the program starts").into()
}

#[test]
fn every_template_runs_green_at_once() {
    for template in ["cell", "tank", "python"] {
        let folder = tempfile::tempdir().unwrap();
        let said = typed(folder.path(), &["new", "my-cell", "--template", template]);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{template}");
        let said = with_python(folder.path(), &["run", "my-cell", "--runs", "2", "--plot", "run.svg"]);
        assert_eq!(said.code, Some(0), "{template}: {said:?}");
        assert!(!said.out.contains("violated") && folder.path().join("run.svg").exists(), "{template}: {said:?}");
        let said = typed(folder.path(), &["check", "my-cell", "--deny-warnings"]);
        assert_eq!(said.code, Some(0), "{template}: {said:?}");
        let said = typed(folder.path(), &["wiring", "my-cell"]);
        assert_eq!(said.code, Some(0), "{template}: {said:?}");
        for file in ["scenario.toml", "README.md", "plc/main.st"] {
            let text = std::fs::read_to_string(folder.path().join("my-cell").join(file)).unwrap();
            assert!(text.contains("my-cell") && !text.contains("{name}"), "{template}: {file}");
        }
    }
}

#[test]
fn it_says_what_it_wrote_and_what_comes_next() {
    let folder = tempfile::tempdir().unwrap();
    insta::assert_snapshot!("new_cell", typed(folder.path(), &["new", "my-cell"]).out);
}

#[test]
fn what_is_there_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    let said = typed(folder.path(), &["new", "mine"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("mine is there already"), "{said:?}");
    assert_eq!(std::fs::read_dir(folder.path().join("mine")).unwrap().count(), 0);
    let said = typed(folder.path(), &["new", "my cell"]);
    assert!(said.code == Some(2) && said.err.contains("`my cell` cannot name a scenario"), "{said:?}");
}

/// The commented-out failure of the cell is one that the library has, and it shows.
#[test]
fn what_the_readme_tells_to_try_can_be_tried() {
    let folder = tempfile::tempdir().unwrap();
    typed(folder.path(), &["new", "my-cell"]);
    let file = folder.path().join("my-cell/plant.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let failing = text.replace("# [[failure]]", "[[failure]]").replace("# component", "component");
    let failing =
        failing.replace("# mode = \"leaking\"", "mode = \"jammed\"").replace("# from_s = 10.0", "from_s = 1.0");
    std::fs::write(&file, failing).unwrap();
    let said = typed(folder.path(), &["run", "my-cell"]);
    assert!(said.code == Some(1) && said.out.contains("`boxes are pushed off` violated"), "{said:?}");
}

/// A sensor more, as the cell's README tells: the error names the line to write, and with it the run is green.
#[test]
fn a_sensor_is_added_by_what_the_program_says() {
    let folder = tempfile::tempdir().unwrap();
    typed(folder.path(), &["new", "my-cell"]);
    let file = |name: &str| folder.path().join("my-cell").join(name);
    let text = std::fs::read_to_string(file("plant.toml")).unwrap();
    let barrier = text.split("[[component]]").find(|part| part.contains("name = \"barrier\"")).expect("it has one");
    let another = barrier.replace("\"barrier\"", "\"end\"").replace("Box_There", "Box_At_End").replace("0.36,", "0.9,");
    std::fs::write(file("plant.toml"), format!("{text}\n[[component]]{another}")).unwrap();
    let said = typed(folder.path(), &["run", "my-cell"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    insta::assert_snapshot!("a_signal_that_is_not_declared", said.err);
    let line = said.err.split_once("under [signals]:").expect("a help").1;
    let line = line.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let text = std::fs::read_to_string(file("scenario.toml")).unwrap();
    std::fs::write(file("scenario.toml"), text.replace("[signals]\n", &format!("[signals]\n{}\n", line.trim())))
        .unwrap();
    let said = typed(folder.path(), &["run", "my-cell", "--signal", "Box_At_End", "--plot", "end.svg"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
}
