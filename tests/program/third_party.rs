//! Real code of others: the sources in the test data of the Python package `blark`. They are fetched,
//! not kept.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use onescan_iec::input::kind::FileKind;
use onescan_iec::{Dialect, Finding, Input, Severity, inspect};
use onescan_iec_run::Application;

/// How many of the files parse, and how many of these compile, each by itself.
const PARSING: usize = 27;
const COMPILING: usize = 8;

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

/// How far a file comes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum State {
    /// Its text is wrong, or a construct is not known.
    Unread,
    /// It parses; names that it uses are declared in no file of the package.
    Parses,
    /// It compiles.
    Compiles,
}

/// True for what is wrong with the text itself: syntax, the file's form, a construct that is not
/// supported.
fn is_unread(finding: &Finding) -> bool {
    let diagnostic = finding.diagnostic();
    diagnostic.severity == Severity::Error && diagnostic.code.text().starts_with(['S', 'F', 'L'])
}

fn is_error(finding: &Finding) -> bool {
    finding.diagnostic().severity == Severity::Error
}

/// How far the file comes by itself, and the first finding that keeps it from coming further.
fn state(path: &Path) -> (State, String) {
    let Some(FileKind::Source(kind)) = FileKind::of(path) else { unreachable!("`sources` lists sources") };
    let name = path.file_name().unwrap().to_string_lossy();
    // All of it was written for TwinCAT.
    let read = || Input::read(&name, kind, &std::fs::read(path).unwrap()).in_dialect(Dialect::TwinCat);
    let findings = inspect([read()], None);
    let obstacle = findings.findings().iter().find(|found| is_unread(found));
    let obstacle = obstacle.or_else(|| findings.findings().iter().find(|found| is_error(found)));
    let Some(found) = obstacle else {
        Application::from_inputs([read()]).expect("what has no findings compiles");
        return (State::Compiles, String::new());
    };
    let line = found.text().lines().nth(found.start().line as usize - 1).unwrap_or_default().trim();
    let (code, message) = (found.diagnostic().code, &found.diagnostic().message);
    let reason = format!("{code} {}:{} {message} | {line}", found.start().line, found.start().column);
    (if is_unread(found) { State::Unread } else { State::Parses }, reason)
}

#[test]
fn sources_of_blark() {
    let folder = tempfile::tempdir().unwrap();
    fetch(folder.path());
    let mut files = Vec::new();
    sources(folder.path(), &mut files);
    let mut table = String::from("parses check compile file\n");
    let mut states = Vec::new();
    for path in &files {
        let (state, reason) = state(path);
        let mark = |wanted| if state >= wanted { "yes" } else { "-" };
        let (parses, compiles) = (mark(State::Parses), mark(State::Compiles));
        let name = path.file_name().unwrap().to_string_lossy();
        writeln!(table, "{parses:6} {compiles:5} {compiles:7} {name:40} {reason}").unwrap();
        states.push(state);
    }
    let count = |wanted| states.iter().filter(|state| **state >= wanted).count();
    println!("{table}{} of {} parse, {} compile", count(State::Parses), files.len(), count(State::Compiles));
    assert_eq!(files.len(), 27);
    assert!(count(State::Parses) >= PARSING && count(State::Compiles) >= COMPILING, "{table}");
}
