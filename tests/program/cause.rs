//! `onescan test` names the statement in which a case parts from the program that was reviewed.

use std::path::Path;

use crate::typed::{copied, copied_shear, edit, git, typed};

/// The scenario as it was reviewed, in a repository.
fn reviewed(folder: &Path) {
    git(folder, &["init", "-q", "-b", "main"]);
    git(folder, &["add", "."]);
    git(folder, &["commit", "-qm", "As reviewed"]);
}

/// The statement in which the first bad case parts, as `FILE:LINE` in the program as it is now.
fn place(folder: &Path) -> Option<String> {
    let said = typed(folder, &["test", ".", "--check", "--format", "json"]);
    let outcomes = said.out.lines().map(|row| serde_json::from_str::<serde_json::Value>(row).expect("JSON"));
    let mut places = outcomes.filter_map(|outcome| Some(outcome.get("cause")?.get("place")?.clone()));
    let place = places.next()?;
    Some(format!("{}:{}", place["file"].as_str()?, place["line"]))
}

#[test]
fn the_statement_that_broke_a_case_is_named() {
    let folder = copied_shear();
    reviewed(folder.path());
    edit(folder.path(), "plc/shear.st", "ixUp := NOT ixDown;", "ixUp := ixDown;");
    let said = typed(folder.path(), &["test", ".", "--check", "-f", "on-the-limit", "--junit", "junit.xml"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let name = folder.path().file_name().unwrap().to_string_lossy().into_owned();
    insta::assert_snapshot!(said.out.replace(&name, "shear"));
    let junit = std::fs::read_to_string(folder.path().join("junit.xml")).unwrap();
    assert!(junit.contains("file=\"plc/shear.st\" line=\"40\""), "{junit}");
}

/// One changed constant breaks many cases: the way to it is shown once.
#[test]
fn a_cause_of_several_cases_is_shown_once() {
    let folder = copied_shear();
    reviewed(folder.path());
    edit(folder.path(), "plc/shear.st", "Rest : TIME := T#100ms;", "Rest : TIME := T#110ms;");
    let said = typed(folder.path(), &["test", ".", "--check", "--html", "tests.html"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let name = folder.path().file_name().unwrap().to_string_lossy().into_owned();
    insta::assert_snapshot!(said.out.replace(&name, "shear"));
    let page = std::fs::read_to_string(folder.path().join("tests.html")).unwrap();
    assert!(page.contains("<li>plc/shear.st:26 is the cause in 4 tests</li>"), "the page begins with causes");
}

/// What differs may be far from the signal that shows it: behind a variable, a timer, a constant, an array, a block.
#[test]
fn the_way_goes_through_variables_timers_and_constants() {
    let folder = copied_shear();
    reviewed(folder.path());
    let tries = [
        // The output reads a variable, which another statement has written.
        ("ixUp := NOT ixDown;", "ixUp := ixDown;", "plc/shear.st:40"),
        // The condition of a branch.
        ("ELSIF Down THEN", "ELSIF NOT Down THEN", "plc/shear.st:37"),
        // The input of a timer, whose output shows it much later.
        ("Dwell(IN := Level AND NOT ixDown, PT := Rest);", "Dwell(IN := Level, PT := T#90ms);", "plc/shear.st:33"),
        // A constant, which its statements hold as a number.
        ("Rest : TIME := T#100ms;", "Rest : TIME := T#110ms;", "plc/shear.st:26"),
        ("LowerLimit : LREAL := -0.10;", "LowerLimit : LREAL := -0.11;", "plc/shear.st:25"),
        // A statement that is gone is named as it was.
        ("        Strokes := Strokes + 1;\n", "", "plc/shear.st:36"),
        // One that is new.
        ("ixUp := NOT ixDown;", "ixUp := NOT ixDown; ixUp := Strokes = 0;", "plc/shear.st:40"),
    ];
    for (from, to, expected) in tries {
        edit(folder.path(), "plc/shear.st", from, to);
        assert_eq!(place(folder.path()).as_deref(), Some(expected), "{from} -> {to}");
        git(folder.path(), &["checkout", "-q", "."]);
    }
}

/// A number that lies last in memory, and of which only the lowest byte ever changes.
#[test]
fn the_way_goes_through_a_number_at_the_end_of_memory() {
    let folder = copied_shear();
    let program = [
        ("    Dwell : TON;  ", "    Dwell : TON := (PT := T#100ms); Phase : INT;  "),
        ("Dwell(IN := Level AND NOT ixDown, PT := Rest);", "Dwell(IN := Level AND Phase <> 2);"),
        ("        ixDown := TRUE;", "        Phase := 2;"),
        ("        ixDown := FALSE;", "        Phase := 1;"),
        ("    ixUp := NOT ixDown;", "    ixDown := Phase = 2; ixUp := NOT ixDown;"),
    ];
    for (from, to) in program {
        edit(folder.path(), "plc/shear.st", from, to);
    }
    let said = typed(folder.path(), &["test", ".", "--bless"]);
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
    reviewed(folder.path());
    edit(folder.path(), "plc/shear.st", "(PT := T#100ms)", "(PT := T#110ms)");
    assert_eq!(place(folder.path()).as_deref(), Some("plc/shear.st:22"));
}

#[test]
fn the_way_goes_through_blocks_and_arrays() {
    let folder = copied("gantry-robot");
    reviewed(folder.path());
    let tries = [
        // An element of an array, by the way of two blocks and the motion control.
        (
            "plc/robot.st",
            "(X := 1.4, Z := 0.4), (X := 1.4, Z := 0.9)",
            "(X := 1.4, Z := 0.4), (X := 1.4, Z := 0.8)",
            "plc/robot.st:31",
        ),
        // A line of a call that takes two.
        (
            "plc/servo.st",
            "        Deceleration := Acceleration, Jerk",
            "        Deceleration := 0.9 * Acceleration, Jerk",
            "plc/servo.st:38",
        ),
        // A statement of a block.
        ("plc/servo.st", "Done := Move.Done AND", "Done := Move.Busy AND", "plc/servo.st:45"),
    ];
    for (file, from, to, expected) in tries {
        edit(folder.path(), file, from, to);
        assert_eq!(place(folder.path()).as_deref(), Some(expected), "{from} -> {to}");
        git(folder.path(), &["checkout", "-q", "."]);
    }
}

/// Without the reviewed program the verdict is the same; the reason is missing.
#[test]
fn without_a_repository_there_is_a_verdict_and_no_reason() {
    let folder = copied_shear();
    edit(folder.path(), "plc/shear.st", "ixUp := NOT ixDown;", "ixUp := ixDown;");
    let said = typed(folder.path(), &["test", ".", "--check"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(!said.out.contains("parts from"), "{said:?}");
    let said = typed(folder.path(), &["test", ".", "--check", "--against", "HEAD"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    reviewed(folder.path());
    let said = typed(folder.path(), &["test", ".", "--check", "--against", "nothing"]);
    assert_eq!((said.code, said.err.contains("nothing")), (Some(2), true), "{said:?}");
    // The commit that is checked out is not the reviewed program: it is not believed.
    assert_eq!(place(folder.path()), None);
}

/// The change is committed: the commit that the snapshot is from has the reviewed program.
#[test]
fn the_commit_of_the_snapshot_counts_where_the_last_one_has_changed_it() {
    let folder = copied_shear();
    reviewed(folder.path());
    edit(folder.path(), "plc/shear.st", "ixUp := NOT ixDown;", "ixUp := ixDown;");
    git(folder.path(), &["commit", "-qam", "Up and down"]);
    assert_eq!(place(folder.path()).as_deref(), Some("plc/shear.st:40"));
}

/// A stranger's repository names programs in its configuration and attributes: for filters, for what watches files, for
/// what shows signatures, for hooks. None of them is started, and a folder that is itself a bare repository is not one.
#[cfg(unix)]
#[test]
fn the_configuration_of_a_repository_starts_nothing() {
    let folder = copied_shear();
    std::fs::write(folder.path().join(".gitattributes"), "* filter=own diff=own\n").unwrap();
    reviewed(folder.path());
    edit(folder.path(), "plc/shear.st", "ixUp := NOT ixDown;", "ixUp := ixDown;");
    let marker = folder.path().join("started");
    let touch = format!("touch {} && cat", marker.display());
    for name in
        ["filter.own.smudge", "filter.own.clean", "core.fsmonitor", "core.pager", "gpg.program", "diff.own.textconv"]
    {
        git(folder.path(), &["config", name, &touch]);
    }
    git(folder.path(), &["config", "filter.own.required", "true"]);
    git(folder.path(), &["config", "log.showSignature", "true"]);
    assert_eq!(place(folder.path()).as_deref(), Some("plc/shear.st:40"), "the reviewed program is still found");
    assert!(!marker.exists(), "a program of the configuration has run");

    // The same repository as plain files in the scenario's folder.
    let bare = folder.path().join(".git");
    for entry in std::fs::read_dir(&bare).unwrap() {
        let entry = entry.unwrap();
        std::fs::rename(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    std::fs::remove_dir(bare).unwrap();
    let config = std::fs::read_to_string(folder.path().join("config")).unwrap();
    std::fs::write(folder.path().join("config"), config.replace("bare = false", "bare = true")).unwrap();
    let said = typed(folder.path(), &["test", ".", "--check"]);
    assert_eq!((said.code, said.out.contains("parts from")), (Some(1), false), "{said:?}");
    assert!(!marker.exists(), "a program of the configuration has run");
}

/// With `--no-commands` nothing is started, git neither.
#[test]
fn without_commands_git_is_not_asked() {
    let folder = copied_shear();
    reviewed(folder.path());
    edit(folder.path(), "plc/shear.st", "ixUp := NOT ixDown;", "ixUp := ixDown;");
    let said = typed(folder.path(), &["test", ".", "--check", "--no-commands"]);
    assert_eq!((said.code, said.out.contains("parts from")), (Some(1), false), "{said:?}");
    let forbidden = "this asks git, which `--no-commands` forbids";
    let asked: [&[&str]; 2] = [
        &["test", ".", "--check", "--against", "HEAD", "--no-commands"],
        &["bisect", ".", "--good", "HEAD", "--bad", "HEAD", "--no-commands"],
    ];
    for words in asked {
        let said = typed(folder.path(), words);
        assert_eq!((said.code, said.err.contains(forbidden)), (Some(2), true), "{words:?} {said:?}");
    }
}
