//! The shim as TwinCAT objects, read by another's parser of TwinCAT's ST.

use std::path::Path;
use std::process::Command;

use crate::typed::{scenario, typed};
use crate::venv::python;

#[test]
fn blark_reads_what_is_attached() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_string_lossy().into_owned();
    let words = ["instrument", ".", "--target", "twincat", "--output", &out];
    let said = typed(&scenario("gantry-robot"), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/twincat.py");
    let read = Command::new(python("twincat-1", &["blark==0.8.3"])).arg(script).arg(folder.path()).output().unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    let reported = String::from_utf8_lossy(&read.stdout).into_owned();
    let count: Option<u32> = reported.trim().parse().ok();
    assert!(count.is_some_and(|count| count > 50), "{reported}");
}
