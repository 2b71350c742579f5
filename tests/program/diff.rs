//! `onescan diff` and `onescan bisect`: where runs part, and which statement did it.

use std::path::Path;

use crate::typed::{copied_shear, edit, git, typed};

/// A comparison in the low level control that matters: the blade goes down from the second stroke on.
const BEFORE: &str = "Actuator_1_Down := ixDown AND Position_1 > LowerLimit AND Strokes > 0;";
const AFTER: &str = "Actuator_1_Down := ixDown AND Position_1 > LowerLimit AND Strokes >= 0;";
const OTHER: &str = "Actuator_1_Down := ixDown AND Position_1 > LowerLimit AND Strokes > 1;";
const OWN: &str = "Actuator_1_Down := ixDown AND Position_1 > LowerLimit;";

/// A shear with its recordings `a` and, after `change`, `b`.
fn recorded(until: [&str; 2], change: impl FnOnce(&Path)) -> tempfile::TempDir {
    let folder = copied_shear();
    edit(folder.path(), "plc/shear.st", OWN, BEFORE);
    record(folder.path(), "a", until[0]);
    change(folder.path());
    record(folder.path(), "b", until[1]);
    folder
}

/// Records a run, whether or not it is what the scenario expects.
fn record(folder: &Path, name: &str, until: &str) {
    let said = typed(folder, &["run", ".", "--until", until, "--record", name]);
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
}

#[test]
fn the_statement_that_differs_is_named() {
    let folder = recorded(["3s", "3s"], |folder| edit(folder, "plc/shear.st", BEFORE, OTHER));
    let said = typed(folder.path(), &["diff", "a", "b"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    // The copy's folder has another name each time.
    let name = folder.path().file_name().unwrap().to_string_lossy().into_owned();
    insta::assert_snapshot!(said.out.replace(&name, "shear"));
    let said = typed(folder.path(), &["diff", "a", "b", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let signal = &found["signals"][0];
    assert_eq!((&signal["signal"], &signal["writer"]), (&"Actuator_1_Down".into(), &"plc".into()));
    for (side, statement) in [("a", BEFORE), ("b", OTHER)] {
        let written = &signal[side]["written"];
        assert_eq!(written["statement"], statement.trim_end_matches(';'), "{found}");
        assert_eq!((&written["at"]["file"], &written["at"]["line"]), (&"plc/shear.st".into(), &45.into()));
    }
}

/// The statement is the same in both, and runs in one only: what differs is the condition around it.
#[test]
fn the_decision_that_differs_is_named() {
    const STATEMENT: &str = "Actuator_1_Down := ixDown AND Position_1 > LowerLimit;";
    const BRANCHES: &str = "Actuator_1_Down := FALSE;
    IF Strokes > 0 (* the first is for looking *) THEN
        IF ixDown AND Position_1 > LowerLimit THEN
            Actuator_1_Down := TRUE;
        END_IF;
    END_IF;";
    let folder = copied_shear();
    edit(folder.path(), "plc/shear.st", STATEMENT, BRANCHES);
    record(folder.path(), "a", "3s");
    edit(folder.path(), "plc/shear.st", "IF Strokes > 0 (*", "IF Strokes >= 0 (*");
    record(folder.path(), "b", "3s");
    edit(folder.path(), "plc/shear.st", "IF Strokes >= 0 (*", "IF Strokes > 1 (*");
    record(folder.path(), "c", "3s");
    let said = typed(folder.path(), &["diff", "a", "b"]);
    assert_eq!(said.code, Some(0), "a stroke is counted when it begins: {said:?}");
    let said = typed(folder.path(), &["diff", "a", "c"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let name = folder.path().file_name().unwrap().to_string_lossy().into_owned();
    insta::assert_snapshot!(said.out.replace(&name, "shear"));
    let said = typed(folder.path(), &["diff", "a", "c", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let parting = &found["partings"][0];
    assert_eq!((&parting["a"]["question"], &parting["a"]["answer"]), (&"IF Strokes > 0".into(), &"THEN".into()));
    assert_eq!((&parting["b"]["question"], &parting["b"]["answer"]), (&"IF Strokes > 1".into(), &"ELSE".into()));
    assert_eq!(parting["t_v_ns"], found["t_v_ns"], "the way differs in the scan in which the signal does");
}

/// The snapshot that was reviewed and the one that waits.
#[test]
fn snapshots_are_compared() {
    let folder = copied_shear();
    edit(folder.path(), "plc/shear.st", "Position_1 > LowerLimit", "Position_1 >= LowerLimit");
    assert_eq!(typed(folder.path(), &["test", "."]).code, Some(1));
    let [old, new] = ["snapshots/on-the-limit.traj", "snapshots/on-the-limit.traj.new"];
    let said = typed(folder.path(), &["diff", old, new]);
    assert_eq!(said.code, Some(1), "{said:?}");
    // The new one has the name of the copy's folder.
    let name = folder.path().file_name().unwrap().to_string_lossy().into_owned();
    insta::assert_snapshot!(said.out.replace(&name, "shear"));
    let json = |words: &[&str]| -> serde_json::Value {
        serde_json::from_str(&typed(folder.path(), &[&["diff", old, new, "--format", "json"], words].concat()).out)
            .unwrap()
    };
    let found = json(&[]);
    assert_eq!(
        (&found["t_v_ns"], &found["differences"][0]["signal"]),
        (&860_000_000.into(), &"Actuator_1_Down".into())
    );
    assert_eq!(json(&["--signals", "Strokes"])["equal"], true);
    let since = json(&["--from", "1s", "--signals", "Position_1"]);
    assert!(since["t_v_ns"].as_u64().is_none_or(|at| at >= 1_000_000_000), "{since}");
    let said = typed(folder.path(), &["diff", old, old]);
    assert_eq!((said.code, said.out.lines().last()), (Some(0), Some("no difference")));
    let said = typed(folder.path(), &["diff", old, "snapshots"]);
    assert!(said.code == Some(2) && said.err.contains("compare two recordings"), "{said:?}");
    let said = typed(folder.path(), &["diff", old, "scenario.toml"]);
    assert!(said.code == Some(2) && said.err.contains("scenario.toml: line 1"), "{said:?}");
}

/// Decisions are known again when others come and go around them.
#[test]
fn a_decision_that_is_new_does_not_count() {
    let folder = copied_shear();
    record(folder.path(), "a", "3s");
    edit(folder.path(), "plc/shear.st", OWN, &format!("IF Strokes < 0 THEN RETURN; END_IF;\n{OWN}"));
    edit(folder.path(), "plc/shear.st", OWN, OTHER);
    record(folder.path(), "b", "3s");
    let said = typed(folder.path(), &["diff", "a", "b"]);
    assert!(said.out.contains("Strokes > 1") && !said.out.contains("goes another way"), "{said:?}");
}

#[test]
fn a_change_that_alters_nothing_is_not_a_difference() {
    let folder = recorded(["3s", "3s"], |folder| edit(folder, "plc/shear.st", BEFORE, AFTER));
    let said = typed(folder.path(), &["diff", "a", "b"]);
    assert_eq!(
        (said.code, said.out.lines().last()),
        (Some(0), Some("no difference, by the digests of steps 0 to 300")),
        "{said:?}"
    );
    let said = typed(folder.path(), &["diff", "a", "b", "--from", "1s", "--signals", "Strokes"]);
    assert_eq!(said.out.lines().last(), Some("no difference, by the values of 1 signal"), "{said:?}");
}

#[test]
fn runs_of_other_lengths_steps_and_times_are_compared() {
    let folder = recorded(["1s", "2s"], |_| {});
    let said = typed(folder.path(), &["diff", "a", "b"]);
    assert_eq!(said.code, Some(1));
    assert!(said.out.contains("equal up to t_v = 1.000 s, where A ends; B goes on"), "{said:?}");
    let half = |folder: &Path| edit(folder, "scenario.toml", "step = \"10ms\"", "step = \"5ms\"");
    let folder = recorded(["300ms", "300ms"], half);
    let said = typed(folder.path(), &["diff", "a", "b", "--signals", "Strokes"]);
    assert_eq!(said.code, Some(0), "the same strokes at the times of both: {said:?}");
    let said = typed(folder.path(), &["diff", "a", "b"]);
    assert!(said.code == Some(1) && said.out.contains(" of A, step "), "{said:?}");
}

#[test]
fn since_leaves_out_what_was_before() {
    let later = |folder: &Path| edit(folder, "plc/shear.st", "T#100ms", "T#110ms");
    let folder = recorded(["3s", "3s"], later);
    let at = |words: &[&str]| -> u64 {
        let said = typed(folder.path(), &[&["diff", "a", "b", "--format", "json"], words].concat());
        let found: serde_json::Value = serde_json::from_str(&said.out).unwrap();
        found["t_v_ns"].as_u64().unwrap()
    };
    let first = at(&[]);
    assert_eq!(at(&["--since", "0s"]), first);
    assert!(at(&["--since", "2s"]) >= 2_000_000_000);
    let said = typed(folder.path(), &["diff", "a", "nowhere"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("nowhere is not a recording"), "{said:?}");
}

/// A comparison by digest finds what a comparison of all values finds.
#[test]
fn digests_and_values_agree() {
    let folder = recorded(["3s", "3s"], |folder| edit(folder, "plc/shear.st", BEFORE, OTHER));
    let found = |words: &[&str]| -> serde_json::Value {
        let said = typed(folder.path(), &[&["diff", "a", "b", "--format", "json"], words].concat());
        serde_json::from_str(&said.out).unwrap()
    };
    let (by_digest, by_value) = (found(&[]), found(&["--signals", "*"]));
    assert_eq!((&by_digest["basis"], &by_value["basis"]), (&"digests".into(), &"values".into()));
    assert_eq!(by_digest["step_a"], by_value["step_a"]);
    assert_eq!(by_digest["signals"], by_value["signals"]);
}

fn commit(folder: &Path, subject: &str, from: &str, to: &str) {
    edit(folder, "plc/shear.st", from, to);
    git(folder, &["commit", "-qam", subject]);
}

#[test]
fn the_commit_that_changed_the_run_is_found() {
    let folder = copied_shear();
    edit(folder.path(), "plc/shear.st", OWN, BEFORE);
    git(folder.path(), &["init", "-q", "-b", "main"]);
    git(folder.path(), &["add", "."]);
    git(folder.path(), &["commit", "-qm", "The shear"]);
    git(folder.path(), &["tag", "good"]);
    commit(folder.path(), "A comment", "(* strokes begun *)", "(* strokes begun so far *)");
    commit(folder.path(), "Does not compile", "ixUp := NOT ixDown;", "ixUp := NOT ixDwon;");
    commit(folder.path(), "Compiles again", "ixUp := NOT ixDwon;", "ixUp := NOT ixDown;");
    commit(folder.path(), "Go down later", BEFORE, OTHER);
    commit(folder.path(), "Another comment", "begun so far", "begun up to now");
    let said = typed(folder.path(), &["bisect", ".", "--good", "good", "--until", "2s"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let from_subject = said.out.split_once(" Go down later").expect("the commit").1;
    insta::assert_snapshot!(from_subject);
    let said = typed(folder.path(), &["bisect", ".", "--good", "good", "--bad", "HEAD~2", "--until", "2s"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), "good and HEAD~2 have the same digest\n"), "{said:?}");
    let said = typed(folder.path(), &["bisect", ".", "--good", "nothing"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(typed(folder.path(), &["bisect", ".", "--good", "HEAD"]).err.contains("no commit after the good one"));
}
