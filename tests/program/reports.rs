//! Reports for others: `JUnit`, Cobertura and lcov, one page; read by the tools of the field.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::typed::{copied_shear, copied_shear_of_snapshots, edit, typed};
use crate::venv::python;

/// A Python with what reads these reports.
fn peer() -> PathBuf {
    python("reports-1", &["junitparser==3.2.0", "pycobertura==4.1.0"])
}

fn asked(folder: &Path, program: &str) -> String {
    let output = Command::new(peer()).current_dir(folder).args(["-c", program]).output().expect("the peer starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

const SOURCES: &str = "PROGRAM TEST_Odd ASSERT(FALSE, 'a < b & \"c\"'); END_PROGRAM\n";

/// The shear with one case that has changed, and a test program that fails.
fn reported() -> tempfile::TempDir {
    let folder = copied_shear_of_snapshots();
    edit(folder.path(), "plc/shear.st", "Position_1 > LowerLimit", "Position_1 >= LowerLimit");
    std::fs::write(folder.path().join("odd.st"), SOURCES).expect("a file");
    let words =
        ["test", ".", "odd.st", "--check", "--junit", "junit.xml", "--coverage", "coverage.xml", "--html", "page.html"];
    let said = typed(folder.path(), &words);
    assert_eq!(said.code, Some(1), "{said:?}");
    folder
}

#[test]
fn junit_is_read_by_junitparser() {
    let folder = reported();
    let program = "
import junitparser
xml = junitparser.JUnitXml.fromfile('junit.xml')
print(xml.tests, xml.failures, xml.errors)
for suite in xml:
    print(len(list(suite)), suite.tests, suite.failures, suite.errors, suite.skipped)
    for case in suite:
        for result in case.result:
            print(case.name, type(result).__name__, result.type, result.message)
";
    let reported = asked(folder.path(), program);
    insta::assert_snapshot!(reported);
}

#[test]
fn cobertura_is_read_by_pycobertura() {
    let folder = reported();
    let program = "
from pycobertura import Cobertura
from pycobertura.filesystem import filesystem_factory
report = Cobertura('coverage.xml', filesystem=filesystem_factory('.'))
for name in sorted(report.files()):
    print(name, report.total_statements(name), report.total_misses(name))
";
    let reported = asked(folder.path(), program);
    insta::assert_snapshot!(reported);
}

/// All but what says how long it took: a line of the page, and times of the wall clock in `JUnit`.
fn without_times(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.contains("class=\"made\""));
    let untimed = |line: &str| {
        let (before, after) = line.split_once(" time=\"")?;
        Some(before.to_owned() + after.split_once('"')?.1)
    };
    lines.map(|line| untimed(line).unwrap_or_else(|| line.to_owned())).collect::<Vec<_>>().join("\n")
}

#[test]
fn equal_runs_give_equal_reports() {
    let (one, other) = (reported(), reported());
    for file in ["junit.xml", "coverage.xml", "page.html"] {
        let read = |folder: &tempfile::TempDir| {
            let text = std::fs::read_to_string(folder.path().join(file)).expect("a report");
            let name = folder.path().file_name().expect("a name").to_string_lossy().into_owned();
            without_times(&text.replace(&name, "shear"))
        };
        assert_eq!(read(&one), read(&other), "{file}");
    }
}

#[test]
fn the_page_is_whole_in_one_file() {
    let folder = reported();
    let page = std::fs::read_to_string(folder.path().join("page.html")).expect("a page");
    assert!(page.contains("<svg") && page.contains("coverage of the PLC's code") && page.contains("on-the-limit"));
    assert!(page.contains("a &lt; b &amp; &quot;c&quot;"), "text stays text");
    assert!(page.contains(">reviewed</text>") && page.contains("first difference: "), "new over reviewed");
    assert!(page.contains("prefers-color-scheme: dark"), "it has a dark form");
    assert!(!page.contains("<link") && !page.contains(" src=") && !page.contains("@import"), "it loads nothing");
}

#[test]
fn coverage_of_all_cases_is_that_of_each_together() {
    let folder = copied_shear();
    let lcov = |words: &[&str]| {
        let said = typed(folder.path(), &[&["test", ".", "--check", "--coverage", "all.info"], words].concat());
        assert_eq!(said.code, Some(0), "{said:?}");
        std::fs::read_to_string(folder.path().join("all.info")).expect("a report")
    };
    let all = lcov(&[]);
    assert!(all.contains("SF:plc/shear.st"), "{all}");
    assert!(all.lines().any(|line| line.starts_with("DA:") && line.ends_with(",11")), "eleven cases: {all}");
    assert_eq!(lcov(&["--jobs", "1"]), all);
}

#[test]
fn a_run_has_a_page_too() {
    let folder = copied_shear();
    edit(
        folder.path(),
        "scenario.toml",
        "[plot]",
        "[[expect]]\nname = \"short\"\nformula = \"always Position_1 > -100 mm\"\n\n[plot]",
    );
    let said = typed(folder.path(), &["run", ".", "--case", "sensor-lost", "--html", "run.html"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let page = std::fs::read_to_string(folder.path().join("run.html")).expect("a page");
    assert!(page.contains("expectation `short` violated") && page.contains("Sensor_1 held at 0"), "{page}");
    assert!(page.contains("<svg") && page.contains("`short` violated at "), "the violation is marked in the picture");
    assert!(page.contains("completed, an expectation is violated"), "the heading says it in words");
    assert!(page.contains("the machine") && page.contains("<title>blade</title>"), "the machine is drawn");
    let plain = typed(folder.path(), &["run", ".", "--case", "sensor-lost", "--format", "json"]);
    let report: serde_json::Value = serde_json::from_str(&plain.out).expect("JSON");
    let digest = report["digest"].as_str().expect("a digest");
    assert!(page.contains(digest), "a page changes no bit");
}
