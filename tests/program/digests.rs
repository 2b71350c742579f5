//! The digests of all scenarios and cases: the same in debug and release builds, with one job and
//! with two, idle and loaded. All are held against one file, `program__digests__reviewed.snap`.

use crate::load::under_load;
use crate::typed::{scenario, typed};

/// A line a case: scenario, case, steps, digest.
fn digests(jobs: &str) -> String {
    let said = typed(&scenario(""), &["test", ".", "--check", "--format", "json", "--jobs", jobs]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let outcomes = said.out.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
    let line = |outcome: serde_json::Value| {
        let of = |field: &str| outcome[field].as_str().map(str::to_owned);
        Some(format!("{} {} {} {}", of("suite")?, of("name")?, outcome["steps"], of("digest")?))
    };
    outcomes.filter_map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_build_has_those_that_were_reviewed() {
    insta::assert_snapshot!("reviewed", digests("2"));
}

#[test]
fn one_job_changes_none() {
    insta::assert_snapshot!("reviewed", digests("1"));
}

#[test]
fn load_changes_none() {
    insta::assert_snapshot!("reviewed", under_load(|| digests("2")));
}
