//! A little of what `tests/long` does, in every run of the tests.
#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::Command;

use crate::typed::onescan;

/// One digest, whole, cut by checkpoints, over TCP with a recording; memory that does not grow.
#[test]
fn a_long_run_is_the_same_however_it_is_cut_and_carried() {
    let folder = tempfile::tempdir().unwrap();
    let mut script = Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("long"));
    script.current_dir(folder.path()).args(["--steps", "20000", "--tcp-steps", "2000", "--cuts", "10"]);
    script.arg("--program").arg(onescan(folder.path()).get_program());
    let output = script.output().expect("Python");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.ends_with("all holds\n"), "{said}{output:?}");
}
