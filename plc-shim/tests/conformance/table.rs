//! `CONFORMANCE.md` against the tests that it names: what it claims is shown, and what is shown it claims.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::{files, stem};

/// A row of one of the tables.
struct Row<'t> {
    line: &'t str,
    support: &'t str,
    tests: Vec<&'t str>,
}

fn rows(text: &str) -> Vec<Row<'_>> {
    let mut rows = Vec::new();
    let body = text.lines().filter(|line| line.starts_with('|') && !line.starts_with("|---"));
    for line in body {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        if let [.., support, tests] = cells[..]
            && tests != "test"
        {
            // Every second piece stands between backticks.
            rows.push(Row { line, support, tests: tests.split('`').skip(1).step_by(2).collect() });
        }
    }
    rows
}

fn source_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            source_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The tests of the crate as `module::name`, and the cases by name.
fn tests() -> BTreeSet<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = Vec::new();
    // The text of durations is the ground floor's.
    for folder in ["../iec/src", "../iec-run/src", "../iec-project/src", ".", "../../base/src"] {
        source_files(&root.join(folder), &mut sources);
    }
    let mut names: BTreeSet<String> = files().iter().map(|path| stem(path)).collect();
    for path in sources {
        let text = std::fs::read_to_string(&path).expect("a source file");
        // The tests of a module may stand in a file of their own, `module/tests.rs`.
        let module = match stem(&path).as_str() {
            "tests" | "mod" => path.parent().map(stem).unwrap_or_default(),
            name => name.to_owned(),
        };
        let mut after = text.split("#[test]").skip(1);
        let names_in_file = after.by_ref().filter_map(|test| test.split_once("fn ")?.1.split_once('('));
        names.extend(names_in_file.map(|(name, _)| format!("{module}::{name}")));
    }
    names
}

fn conformance() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../CONFORMANCE.md")).expect("CONFORMANCE.md")
}

#[test]
fn every_claim_names_a_test_that_exists() {
    let (text, tests) = (conformance(), tests());
    let rows = rows(&text);
    assert!(rows.len() > 150, "only {} rows", rows.len());
    for row in rows {
        let word = row.support.split([' ', ';', ':', ',']).next().unwrap_or_default();
        assert!(matches!(word, "yes" | "no" | "deviation"), "neither yes, no nor deviation: {}", row.line);
        assert_eq!(row.tests.is_empty(), word == "no", "a claim has a test, a gap has none: {}", row.line);
        for test in row.tests {
            assert!(tests.contains(test), "there is no test `{test}`: {}", row.line);
        }
    }
}

#[test]
fn every_case_is_named_in_the_table() {
    let text = conformance();
    let named: BTreeSet<&str> = rows(&text).into_iter().flat_map(|row| row.tests).collect();
    let missing: Vec<_> = files().iter().map(|path| stem(path)).filter(|name| !named.contains(name.as_str())).collect();
    assert!(missing.is_empty(), "CONFORMANCE.md does not name {}", missing.join(", "));
}
