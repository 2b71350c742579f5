//! `onescan test` on PLC sources: test programs in ST.

use std::path::Path;

use crate::typed::flat;
use crate::typed::{Said, typed};

const UNITS: &str = "
FUNCTION Twice : INT
VAR_INPUT x : INT; END_VAR
    Twice := 2 * x;
END_FUNCTION

FUNCTION_BLOCK Delay
VAR_INPUT IN : BOOL; END_VAR
VAR_OUTPUT Q : BOOL; END_VAR
VAR t : TON; END_VAR
    t(IN := IN, PT := T#50ms);
    Q := t.Q;
END_FUNCTION_BLOCK
";

const TESTS: &str = "
PROGRAM TEST_Twice
    ASSERT(Twice(2) = 4, 'twice two');
    ASSERT_EQUAL_INT(6, Twice(3), 'twice three');
    ASSERT_FALSE(Twice(0) > 0, 'twice nothing');
END_PROGRAM

FUNCTION_BLOCK TEST_Delay
VAR_OUTPUT Done : BOOL; END_VAR
VAR delay : Delay; scans : INT; END_VAR
    delay(IN := TRUE);
    scans := scans + 1;
    ASSERT(delay.Q = (scans > 5), 'five scans of rest, then TRUE');
    Done := scans = 10;
END_FUNCTION_BLOCK
";

const FAILING: &str = "
PROGRAM TEST_Wrong
VAR_OUTPUT Done : BOOL; END_VAR
VAR n : DINT; END_VAR
    n := n + 1;
    ASSERT_EQUAL_DINT(EXPECTED := 1, ACTUAL := n, TEXT := 'counts');
    ASSERT_EQUAL_LREAL(0.3, 0.1 + 0.2, 1.0E-12, 'near enough');
    ASSERT_EQUAL_STRING('one', 'two', 'names');
    ASSERT_EQUAL_TIME(T#1s, T#2s, 'times');
    ASSERT_EQUAL_WORD(16#00FF, 16#0F0F, 'masks');
    Done := n = 3;
END_PROGRAM

PROGRAM TEST_Fault
VAR zero : INT; result : INT; END_VAR
    result := 1 / zero;
END_PROGRAM

PROGRAM TEST_Never
VAR_OUTPUT Done : BOOL; END_VAR
    ASSERT_TRUE(TRUE, 'always');
END_PROGRAM

PROGRAM TEST_Endless
    WHILE TRUE DO ; END_WHILE;
END_PROGRAM
";

fn sources(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

fn tested(folder: &Path, words: &[&str]) -> Said {
    typed(folder, &[&["test"], words].concat())
}

/// A pattern that a shell left as it is, because nothing matches it, is named as one.
#[test]
fn a_pattern_without_files_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let said = typed(folder.path(), &["test", "plc/*.st"]);
    assert!(said.code == Some(2) && flat(&said.err).contains("no file here matches this pattern"), "{said:?}");
}

#[test]
fn tests_that_hold_are_green() {
    let folder = sources(&[("units.st", UNITS), ("tests.st", TESTS)]);
    let said = tested(folder.path(), &["units.st", "tests.st"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    insta::assert_snapshot!(said.out);
    let whole = tested(folder.path(), &["."]);
    assert_eq!(whole.code, Some(0), "a folder without a scenario stands for its sources: {whole:?}");
}

#[test]
fn what_does_not_hold_is_reported_with_its_place() {
    let folder = sources(&[("failing.st", FAILING)]);
    let said = tested(folder.path(), &["failing.st", "--until", "1s", "--sarif", "log.sarif"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    insta::assert_snapshot!(said.out);
    let log = std::fs::read_to_string(folder.path().join("log.sarif")).expect("a log");
    let log: serde_json::Value = serde_json::from_str(&log).expect("JSON");
    let results = log["runs"][0]["results"].as_array().expect("a list");
    let lines: Vec<_> =
        results.iter().map(|each| each["locations"][0]["physicalLocation"]["region"]["startLine"].as_u64()).collect();
    assert_eq!(lines[..4], [Some(8), Some(9), Some(10), Some(6)], "{results:?}");
}

#[test]
fn each_test_begins_again() {
    let text = "VAR_GLOBAL shared : INT; END_VAR
        PROGRAM TEST_One shared := shared + 1; ASSERT(shared = 1, 'one'); END_PROGRAM
        PROGRAM TEST_Two shared := shared + 1; ASSERT(shared = 1, 'two'); END_PROGRAM";
    let folder = sources(&[("a.st", text)]);
    let said = tested(folder.path(), &["a.st"]);
    assert_eq!(said.code, Some(0), "{said:?}");
}

#[test]
fn one_test_is_chosen_by_its_name() {
    let folder = sources(&[("units.st", UNITS), ("tests.st", TESTS)]);
    let said = tested(folder.path(), &["units.st", "tests.st", "--filter", "TEST_Delay", "--format", "json"]);
    let lines: Vec<serde_json::Value> =
        said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(lines.len(), 2, "{said:?}");
    assert_eq!((lines[0]["name"].as_str(), lines[0]["steps"].as_u64()), (Some("TEST_Delay"), Some(10)));
    assert_eq!(lines[0]["asserts_made"], 10);
}

#[test]
fn tests_are_chosen_by_name_and_tag() {
    let tagged =
        TESTS.replace("FUNCTION_BLOCK TEST_Delay", "{attribute 'tags' := 'slow, timing'}\nFUNCTION_BLOCK TEST_Delay");
    let failing = format!("{{attribute 'tags' := 'slow, broken'}}{FAILING}");
    let folder = sources(&[("units.st", UNITS), ("tests.st", &tagged), ("failing.st", &failing)]);
    let names = |words: &[&str]| {
        let said =
            tested(folder.path(), &[&["units.st", "tests.st", "failing.st", "--format", "json"], words].concat());
        let outcomes = said.out.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
        outcomes.filter_map(|outcome| Some(outcome["name"].as_str()?.to_owned())).collect::<Vec<_>>()
    };
    assert_eq!(names(&["--tag", "slow"]), ["TEST_Delay", "TEST_Wrong"]);
    assert_eq!(names(&["--tag", "slow", "--skip-tag", "broken"]), ["TEST_Delay"]);
    assert_eq!(names(&["--skip-tag", "slow", "--filter", "T_F"]), ["TEST_Fault"]);
    assert_eq!(names(&["--tag", "slow", "--filter", "Twice"]), [""; 0]);
    let said = tested(folder.path(), &["units.st", "tests.st", "--tag", "nightly"]);
    assert!(said.code == Some(2) && said.err.contains("none of the tests is chosen"), "{said:?}");
    let said = tested(folder.path(), &["units.st", "tests.st", "--tag", "timing", "--format", "json"]);
    assert!(said.out.contains("\"tags\":[\"slow\",\"timing\"]"), "{said:?}");
}

#[test]
fn sources_that_do_not_compile_or_have_no_test_are_reported() {
    let folder = sources(&[("wrong.st", "PROGRAM TEST_A ASSERT(2.5, 'one'); END_PROGRAM"), ("units.st", UNITS)]);
    let said = tested(folder.path(), &["wrong.st"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    insta::assert_snapshot!(said.out);
    let said = tested(folder.path(), &["units.st"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    insta::assert_snapshot!(said.out);
}

#[test]
fn a_function_of_ones_own_that_is_called_assert_stays_ones_own() {
    let text = "FUNCTION ASSERT : BOOL VAR_INPUT x : BOOL; END_VAR ASSERT := x; END_FUNCTION
        PROGRAM TEST_Own VAR ok : BOOL; END_VAR ok := ASSERT(FALSE); END_PROGRAM";
    let folder = sources(&[("own.st", text)]);
    let said = tested(folder.path(), &["own.st"]);
    assert_eq!(said.code, Some(0), "{said:?}");
}

#[test]
fn asserts_are_known_to_check() {
    let folder = sources(&[("units.st", UNITS), ("tests.st", TESTS)]);
    let said = typed(folder.path(), &["check", "."]);
    assert_eq!(said.code, Some(0), "{said:?}");
}
