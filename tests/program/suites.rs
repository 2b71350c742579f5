//! `onescan test` on projects whose tests `TcUnit` runs. The runner here is one of our own that keeps its results as
//! `TcUnit` does; it stands in the project's folder `libraries`, or elsewhere for `--library`.

use std::path::Path;

use serde_json::Value;

use crate::typed::{Said, typed};

const RUNNER: &str = include_str!("suites/runner.st");

/// A suite whose tests hold; the second takes three scans.
const SUMS: &str = "{attribute 'tags' := 'sums'}
FUNCTION_BLOCK Test_Sums EXTENDS TcUnit.FB_TestSuite
VAR scans : INT; END_VAR
Small();
Slow();
TEST_SKIPPED('Later');
METHOD Small
    TEST('Small sums');
    Equal(4, 2 + 2, 'two and two');
    Finish();
END_METHOD
METHOD Slow
    TEST('Slow');
    scans := scans + 1;
    IF scans = 3 THEN
        Equal(3, scans, 'three scans');
        Finish();
    END_IF
END_METHOD
END_FUNCTION_BLOCK
";

/// One whose test fails twice.
const WRONG: &str = "FUNCTION_BLOCK Products EXTENDS TcUnit.FB_TestSuite
TEST('Wrong');
Equal(5, 2 * 2, 'two twos');
Equal(7, 2 * 3, '<two> threes');
Finish();
END_FUNCTION_BLOCK
";

/// One with a test that has no end.
const ENDLESS: &str = "FUNCTION_BLOCK Endless EXTENDS TcUnit.FB_TestSuite
TEST('Quick');
Finish();
TEST('Waits for ever');
END_FUNCTION_BLOCK
";

fn main_of(suites: &str) -> String {
    format!("PROGRAM TEST_Main\nVAR {suites} END_VAR\nTcUnit.RUN();\nEND_PROGRAM\n")
}

/// A TwinCAT project of these files, with the runner as its library.
fn project(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
    std::fs::create_dir(folder.path().join("libraries")).expect("a folder");
    write("libraries/runner.st", RUNNER);
    let listed: Vec<String> = files.iter().map(|(name, _)| format!("<Compile Include=\"{name}\"/>")).collect();
    let listed = listed.concat();
    write("plc.plcproj", &format!("<Project><ItemGroup>{listed}</ItemGroup></Project>"));
    for (name, text) in files {
        write(name, text);
    }
    folder
}

fn tested(folder: &Path, words: &[&str]) -> Said {
    let said = typed(folder, &[&["test", "--dialect", "twincat"], words].concat());
    assert!(!said.err.contains("panicked"), "{said:?}");
    said
}

fn outcomes(said: &Said) -> Vec<Value> {
    said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

#[test]
fn suites_that_hold_are_green() {
    let folder = project(&[("sums.st", SUMS), ("main.st", &main_of("sums : Test_Sums;"))]);
    let said = tested(folder.path(), &["plc.plcproj"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    insta::assert_snapshot!(said.out);
    assert_eq!(tested(folder.path(), &["."]).code, Some(0), "the folder stands for its project");
}

#[test]
fn a_library_may_lie_elsewhere() {
    let folder = project(&[("sums.st", SUMS), ("main.st", &main_of("sums : Test_Sums;"))]);
    std::fs::rename(folder.path().join("libraries"), folder.path().join("shelf")).expect("a folder");
    let said = tested(folder.path(), &["plc.plcproj"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert_eq!(tested(folder.path(), &["plc.plcproj", "--library", "shelf"]).code, Some(0));
    let checked = typed(folder.path(), &["check", "plc.plcproj", "--dialect", "twincat", "--library", "shelf"]);
    assert_eq!(checked.code, Some(0), "{checked:?}");
}

#[test]
fn an_assert_that_does_not_hold_is_reported_with_its_test() {
    let main = main_of("sums : Test_Sums; products : Products;");
    let folder = project(&[("sums.st", SUMS), ("products.st", WRONG), ("main.st", &main)]);
    let said = tested(folder.path(), &["plc.plcproj", "--junit", "junit.xml"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    insta::assert_snapshot!(said.out);
    let junit = std::fs::read_to_string(folder.path().join("junit.xml")).expect("a report");
    let without_wall_time: Vec<&str> = junit.lines().filter(|line| !line.contains("<testsuites")).collect();
    insta::assert_snapshot!(without_wall_time.join("\n"));
}

#[test]
fn suites_are_chosen_by_tag_and_tests_by_name() {
    let main = main_of("sums : Test_Sums; products : Products;");
    let folder = project(&[("sums.st", SUMS), ("products.st", WRONG), ("main.st", &main)]);
    let names = |words: &[&str]| {
        let said = tested(folder.path(), &[&["plc.plcproj", "--format", "json"], words].concat());
        let all = outcomes(&said);
        all.iter().filter_map(|each| Some(each["name"].as_str()?.to_owned())).collect::<Vec<_>>()
    };
    let sums = ["TEST_Main.sums@Small sums", "TEST_Main.sums@Slow", "TEST_Main.sums@Later"];
    assert_eq!(names(&["--tag", "sums"]), sums);
    assert_eq!(names(&["--skip-tag", "sums"]), ["TEST_Main.products@Wrong"]);
    assert_eq!(names(&["--filter", "@S"]), sums[..2]);
}

#[test]
fn a_suite_that_never_finishes_is_an_error_with_its_name() {
    let main = main_of("sums : Test_Sums; endless : Endless;");
    let folder = project(&[("sums.st", SUMS), ("endless.st", ENDLESS), ("main.st", &main)]);
    let said = tested(folder.path(), &["plc.plcproj", "--until", "1s"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    insta::assert_snapshot!(said.out);
}

#[test]
fn a_fault_is_reported_with_the_test_that_ran() {
    let text = "FUNCTION_BLOCK Broken EXTENDS TcUnit.FB_TestSuite\nVAR zero, n : INT; END_VAR\nTEST('Divides');\n\
                n := 1 / zero;\nFinish();\nEND_FUNCTION_BLOCK";
    let folder = project(&[("broken.st", text), ("main.st", &main_of("broken : Broken;"))]);
    let said = tested(folder.path(), &["plc.plcproj"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    insta::assert_snapshot!(said.out);
}

#[test]
fn what_there_is_no_room_for_is_reported() {
    let calls: Vec<String> = (1..=5).map(|n| format!("TEST('Number {n}'); Finish();\n")).collect();
    let calls = calls.concat();
    let text = format!("FUNCTION_BLOCK Many EXTENDS TcUnit.FB_TestSuite\n{calls}END_FUNCTION_BLOCK");
    let folder = project(&[("many.st", &text), ("main.st", &main_of("many : Many;"))]);
    let said = tested(folder.path(), &["plc.plcproj"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.out.contains("2 of its 5 tests are not reported"), "{said:?}");
}

#[test]
fn equal_runs_give_equal_reports() {
    let main = main_of("sums : Test_Sums; products : Products; endless : Endless;");
    let files = [("sums.st", SUMS), ("products.st", WRONG), ("endless.st", ENDLESS), ("main.st", main.as_str())];
    let folder = project(&files);
    let said = || tested(folder.path(), &["plc.plcproj", "--format", "json", "--until", "500ms"]).out;
    assert_eq!(said(), said());
}

#[test]
fn suites_that_nothing_runs_are_reported() {
    let main = "PROGRAM Main\nVAR sums : Test_Sums; END_VAR\nsums();\nEND_PROGRAM\n";
    let folder = project(&[("sums.st", SUMS), ("main.st", main)]);
    let said = tested(folder.path(), &["plc.plcproj"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.out.contains("no program runs the suites of TcUnit"), "{said:?}");
}

#[test]
fn own_tests_and_suites_run_side_by_side() {
    let own = "PROGRAM TEST_Own ASSERT(TRUE, 'always'); END_PROGRAM\n";
    let folder = project(&[("sums.st", SUMS), ("own.st", own), ("main.st", &main_of("sums : Test_Sums;"))]);
    let said = tested(folder.path(), &["plc.plcproj", "--format", "json"]);
    let names: Vec<_> = outcomes(&said).iter().filter_map(|each| Some(each["name"].as_str()?.to_owned())).collect();
    assert_eq!(names[..2], ["TEST_Own", "TEST_Main.sums@Small sums"], "{said:?}");
    assert_eq!(said.code, Some(0), "{said:?}");
}
