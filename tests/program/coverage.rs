//! `onescan run --coverage`: what the soft PLC executed, and no other bits for that.

use crate::typed::{digests, run_shear};

#[test]
fn coverage_changes_no_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let (plain, said) = run_shear(&["--until", "2s"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let file = folder.path().join("lcov.info");
    let path = file.to_str().expect("text");
    let (covered, said) = run_shear(&["--until", "2s", "--runs", "2", "--coverage", path]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let digests = digests(&[plain, covered].concat());
    assert!(digests.iter().all(|digest| *digest == digests[0]), "{digests:?}");
    let text = std::fs::read_to_string(&file).expect("a report");
    assert!(text.lines().any(|line| line.starts_with("DA:") && line.ends_with(",2")), "two runs: {text}");
    assert!(text.lines().filter(|line| line.starts_with("SF:")).all(|line| !line.starts_with("SF:iec/")), "{text}");
}

#[test]
fn the_extension_says_the_format() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("coverage.xml");
    let path = file.to_str().expect("text");
    let (_, said) = run_shear(&["--until", "100ms", "--coverage", path]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let text = std::fs::read_to_string(&file).expect("a report");
    assert!(text.contains("<!DOCTYPE coverage") && text.contains("<class name="), "{text}");
    let (_, said) = run_shear(&["--until", "100ms", "--coverage", path, "--coverage-format", "lcov"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(std::fs::read_to_string(&file).expect("a report").starts_with("TN:\nSF:"));
}

#[test]
fn a_plc_in_another_process_is_not_seen() {
    let (_, said) = run_shear(&["--coverage", "x.info", "--transport", "tcp"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("--coverage means nothing with --transport tcp"), "{said:?}");
}
