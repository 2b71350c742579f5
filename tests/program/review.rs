//! `onescan review`: old, new and difference, accepted or rejected.

use crate::typed::{copied_shear, copied_shear_of_snapshots, edit, scenario, typed};

/// The shear with a change that has been tested.
fn changed_shear() -> tempfile::TempDir {
    let folder = copied_shear_of_snapshots();
    edit(folder.path(), "plc/shear.st", "Position_1 > LowerLimit", "Position_1 >= LowerLimit");
    assert_eq!(typed(folder.path(), &["test", "."]).code, Some(1));
    folder
}

fn snapshot(folder: &std::path::Path) -> String {
    std::fs::read_to_string(folder.join("snapshots/on-the-limit.traj")).expect("a snapshot")
}

fn named(folder: &tempfile::TempDir, text: &str) -> String {
    text.replace(&folder.path().file_name().expect("a name").to_string_lossy().into_owned(), "shear")
}

#[test]
fn old_new_and_difference_are_shown_in_80_columns() {
    let folder = changed_shear();
    let said = typed(folder.path(), &["review", "."]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let drawn = said.out.lines().filter(|line| !line.contains("expected"));
    assert!(drawn.clone().all(|line| line.chars().count() <= 80), "{}", said.out);
    assert!(!said.out.contains('\u{1b}'), "no colours");
    insta::assert_snapshot!(named(&folder, &said.out));
}

#[test]
fn all_are_listed_rejected_or_accepted() {
    let folder = changed_shear();
    let before = snapshot(folder.path());
    let said = typed(folder.path(), &["review", ".", "--list"]);
    assert_eq!(named(&folder, &said.out), "changed shear: on-the-limit\n");
    let said = typed(folder.path(), &["review", ".", "--reject-all"]);
    assert_eq!(named(&folder, &said.out), "rejected shear: on-the-limit\n");
    assert_eq!(snapshot(folder.path()), before);
    let said = typed(folder.path(), &["review"]);
    assert_eq!((said.out.as_str(), said.code), ("no snapshot waits for a review\n", Some(0)));

    assert_eq!(typed(folder.path(), &["test", "."]).code, Some(1));
    assert_eq!(typed(folder.path(), &["review", "--accept-all"]).code, Some(0));
    assert_ne!(snapshot(folder.path()), before);
    assert_eq!(typed(folder.path(), &["test", ".", "--check"]).code, Some(0));
}

/// What a user types on a terminal: a key that means nothing, then accept; reject; skip; quit.
#[cfg(unix)]
#[test]
fn keys_decide_one_by_one() {
    let folder = copied_shear();
    edit(folder.path(), "plc/shear.st", "T#100ms", "T#110ms");
    assert_eq!(typed(folder.path(), &["test", "."]).code, Some(1));
    let files = |ending: &str| {
        let names = std::fs::read_dir(folder.path().join("snapshots")).expect("a folder");
        let names = names.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
        let mut cases: Vec<String> = names.filter_map(|name| Some(name.strip_suffix(ending)?.to_owned())).collect();
        cases.sort();
        cases
    };
    let text = |case: &str| std::fs::read_to_string(folder.path().join(format!("snapshots/{case}.traj"))).expect("one");
    let waiting = files(".traj.new");
    assert_eq!(waiting.len(), 11, "{waiting:?}");
    let before: Vec<String> = waiting.iter().map(|case| text(case)).collect();
    let terminal = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/terminal.py");
    let output = std::process::Command::new("python3")
        .arg(terminal)
        .args(["xa,r,s,q", env!("CARGO_BIN_EXE_onescan-under-test"), "review", "."])
        .current_dir(folder.path())
        .env("NO_COLOR", "1")
        .output()
        .expect("Python is on the machine");
    let said = named(&folder, &String::from_utf8_lossy(&output.stdout));
    assert_eq!(output.status.code(), Some(0), "{said}");
    // The screen is cleared before what came of it is printed.
    let reported = said.rsplit("\u{1b}[H").next().into_iter().flat_map(str::lines);
    let reported: Vec<&str> =
        reported.filter(|line| line.starts_with("accepted ") || line.starts_with("rejected ")).collect();
    let [accepted, rejected] = [0, 1].map(|index| waiting[index].clone());
    assert_eq!(reported, [format!("accepted shear: {accepted}"), format!("rejected shear: {rejected}")], "{said}");
    assert!(said.contains("[1/11] signals 1-") && said.contains("[4/11]") && !said.contains("[5/11]"), "{said}");
    assert_eq!(files(".traj.new"), waiting[2..], "what was skipped, and what was not asked for, waits");
    let changed: Vec<bool> = waiting.iter().zip(&before).map(|(case, before)| text(case) != *before).collect();
    assert!(changed[0] && changed[1..].iter().all(|changed| !changed), "{changed:?}");
}

#[test]
fn a_page_shows_all_in_one_file() {
    let folder = changed_shear();
    let said = typed(folder.path(), &["review", ".", "--list", "--html", "review.html"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let page = std::fs::read_to_string(folder.path().join("review.html")).expect("a page");
    assert!(page.contains("first difference") && page.contains("Position_1, new less reviewed"), "{page}");
    assert!(!page.contains("<link") && !page.contains(" src=") && !page.contains("@import"), "it loads nothing");
}

#[test]
fn a_garbled_pending_snapshot_is_reported() {
    let folder = changed_shear();
    std::fs::write(folder.path().join("snapshots/on-the-limit.traj.new"), "onescan trajectory 1\n").expect("a file");
    let said = typed(folder.path(), &["review", "."]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("line 2: the file is cut off here"), "{}", said.err);
}

#[test]
fn nothing_waits_in_the_project() {
    let said = typed(&scenario(""), &["review", ".", "--list"]);
    assert_eq!(said.out, "no snapshot waits for a review\n");
}
