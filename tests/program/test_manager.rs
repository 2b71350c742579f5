//! `onescan test` on units with CODESYS' `{attribute 'test'}`.

use crate::typed::{Said, typed};

/// Counts to three once it is started.
const GREEN: &str = "{attribute 'test'}
{attribute 'testcasename' := 'N_001:Count'}
{attribute 'testcategory' := 'fast,counters'}
FUNCTION_BLOCK CountTest
VAR_INPUT xExecute, xAbort : BOOL; END_VAR
VAR_OUTPUT xDone, xBusy, xError, xAborted : BOOL; sInfo : STRING; END_VAR
VAR n : INT; END_VAR
IF xExecute AND NOT xDone THEN
    n := n + 1;
    xBusy := n < 3;
    ASSERT(n <= 3, 'no more than three');
    xDone := n = 3;
END_IF
END_FUNCTION_BLOCK
";

const OTHERS: &str = "{attribute 'test'}
FUNCTION_BLOCK FailsTest
VAR_INPUT xExecute : BOOL; END_VAR
VAR_OUTPUT xDone, xError : BOOL; sInfo : STRING; END_VAR
xError := xExecute;
sInfo := 'the belt stands still';
END_FUNCTION_BLOCK

{attribute 'test'}
{attribute 'testcasetimeout' := '200'}
FUNCTION_BLOCK EndlessTest
VAR_INPUT xExecute : BOOL; END_VAR
VAR_OUTPUT xDone : BOOL; END_VAR
END_FUNCTION_BLOCK

{attribute 'test' := 'multitest'}
FUNCTION_BLOCK ManyTests
END_FUNCTION_BLOCK

{attribute 'test'}
PROGRAM PlainTest
ASSERT(FALSE, 'never');
END_PROGRAM
";

fn tested(files: &[(&str, &str)], words: &[&str]) -> Said {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    typed(folder.path(), &[&["test", "--dialect", "codesys"], &names[..], words].concat())
}

#[test]
fn a_test_is_started_and_runs_until_it_is_done() {
    let said = tested(&[("count.st", GREEN)], &[]);
    assert_eq!(said.code, Some(0), "{said:?}");
    insta::assert_snapshot!(said.out);
    assert_eq!(tested(&[("count.st", GREEN)], &["--tag", "counters"]).code, Some(0));
    assert_eq!(tested(&[("count.st", GREEN)], &["--skip-tag", "fast"]).code, Some(2));
}

#[test]
fn a_test_fails_by_its_outputs_its_time_and_its_asserts() {
    let said = tested(&[("count.st", GREEN), ("others.st", OTHERS)], &[]);
    assert_eq!(said.code, Some(1), "{said:?}");
    insta::assert_snapshot!(said.out);
}
