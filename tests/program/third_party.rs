//! Real code of others: the sources in the test data of the Python package `blark`. They are fetched,
//! not kept.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use onescan_plc_shim::input::kind::FileKind;
use onescan_plc_shim::{Finding, Input, Severity, inspect};

/// The package's sources, unpacked in `folder`.
fn fetch(folder: &Path) {
    let words = ["download", "--quiet", "--no-deps", "--no-binary", ":all:", "blark==0.8.3", "--dest", "."];
    let pip = Command::new("pip").args(words).current_dir(folder).output().expect("pip is on the machine");
    assert!(pip.status.success(), "{}", String::from_utf8_lossy(&pip.stderr));
    let tar = Command::new("tar").args(["-xzf", "blark-0.8.3.tar.gz"]).current_dir(folder).status();
    assert!(tar.expect("tar is on the machine").success());
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if matches!(FileKind::of(&path), Some(FileKind::Source(_))) {
            found.push(path);
        }
    }
    found.sort();
}

/// True for what is wrong with the text itself.
fn is_syntax(finding: &Finding) -> bool {
    finding.diagnostic().code.text().starts_with(['S', 'F'])
}

#[test]
#[ignore = "fetches a package from PyPI"]
fn sources_of_blark() {
    let folder = tempfile::tempdir().unwrap();
    fetch(folder.path());
    let mut files = Vec::new();
    sources(folder.path(), &mut files);
    let (mut parsed, mut checked) = (0, 0);
    let mut table = String::new();
    for path in &files {
        let Some(FileKind::Source(kind)) = FileKind::of(path) else { continue };
        let name = path.file_name().unwrap().to_string_lossy();
        let findings = inspect([Input::read(&name, kind, &std::fs::read(path).unwrap())], None);
        let errors = || findings.findings().iter().filter(|found| found.diagnostic().severity == Severity::Error);
        let state = if errors().any(is_syntax) {
            "no"
        } else if errors().count() > 0 {
            "parses"
        } else {
            "checks"
        };
        parsed += usize::from(state != "no");
        checked += usize::from(state == "checks");
        let first = errors().find(|found| state != "no" || is_syntax(found));
        let reason = first.map_or_else(String::new, |found| {
            let line = found.text().lines().nth(found.start().line as usize - 1).unwrap_or_default().trim();
            format!("{}:{} {} | {line}", found.start().line, found.start().column, found.diagnostic().message)
        });
        writeln!(table, "{state:7} {name:40} {reason}").unwrap();
    }
    println!("{table}{parsed} of {} parse, {checked} check", files.len());
    assert_eq!(files.len(), 27);
    assert!(parsed >= 1, "{table}");
}
