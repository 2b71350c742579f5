//! Some of what `tests/mutate` tries, in every run of the tests; more with `ONESCAN_MUTATED=5000`.
#![cfg(unix)]

use std::path::Path;
use std::process::Command;

use crate::typed::onescan;

/// Exit codes from 0 to 3 and no panic, whatever is in a file or a frame; servers let in who comes next.
#[test]
fn nothing_that_is_read_harms_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let files = std::env::var("ONESCAN_MUTATED").unwrap_or_else(|_| "4".to_owned());
    let frames = files.parse::<u32>().expect("a number of files") * 2;
    let mut script = Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("mutate"));
    // The limit of time is for what does not end: a machine may be slow.
    script.current_dir(folder.path()).args(["--seconds", "15", "--files", &files, "--frames", &frames.to_string()]);
    script.arg("--program").arg(onescan(folder.path()).get_program());
    let output = script.output().expect("Python");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.ends_with("nothing found\n"), "{said}{output:?}");
}
