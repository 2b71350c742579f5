//! `onescan test` in a job of a CI server: marks at lines, a table on the page of the job, a line for each test that ends.

use crate::typed::{Said, onescan};

const TESTS: &str = "PROGRAM TEST_Adds
    ASSERT_EQUAL_INT(EXPECTED := 4, ACTUAL := 2 + 3, TEXT := 'two, and three: 100%');
END_PROGRAM
PROGRAM TEST_Holds
    ASSERT(TRUE, 'always');
END_PROGRAM
";

#[test]
fn failures_are_marked_at_their_lines_and_listed_on_the_page_of_the_job() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sums.st"), TESTS).unwrap();
    let page = folder.path().join("page.md");
    // Another step of the job has written there.
    std::fs::write(&page, "before\n").unwrap();
    let words = ["test", "sums.st", "--check", "--format", "github", "--junit", "sums.xml"];
    let said: Said = onescan(folder.path())
        .args(words)
        .env("GITHUB_STEP_SUMMARY", &page)
        .output()
        .expect("the program starts")
        .into();
    assert_eq!(said.code, Some(1), "{said:?}");
    let marks: Vec<&str> = said.out.lines().filter(|line| line.starts_with("::")).collect();
    let [mark] = marks[..] else { panic!("{said:?}") };
    assert!(
        mark.starts_with("::error file=sums.st,line=2,col=5,title=sums.st/TEST_Adds::two, and three: 100%25"),
        "{mark}"
    );
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.starts_with("before\n### onescan: 2 tests: 1 passed, 1 failed\n"), "{text}");
    assert!(text.contains("| failed | sums.st/TEST\\_Adds | sums.st:2"), "{text}");
    assert!(said.err.contains(" 1 / 1 ") && said.err.contains("sums.st"), "{said:?}");
    let junit = std::fs::read_to_string(folder.path().join("sums.xml")).unwrap();
    assert!(junit.contains("<property name=\"virtual_time_s\" value=\"0.010\"/>"), "{junit}");
}

#[test]
fn a_ci_server_sees_each_test_end_and_the_output_stays_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sums.st"), TESTS).unwrap();
    let test = |ci: Option<&str>| -> Said {
        let mut command = onescan(folder.path());
        command.args(["test", "sums.st"]).envs(ci.map(|value| ("CI", value)));
        command.output().expect("the program starts").into()
    };
    let (alone, in_a_job) = (test(None), test(Some("true")));
    assert_eq!((alone.out, alone.err.as_str()), (in_a_job.out, ""));
    assert!(in_a_job.err.contains(" 1 / 1 "), "{}", in_a_job.err);
}
