//! Python environments with programs of others in them, made once.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

/// Two tests that want the same environment do not make it at once.
static MAKING: Mutex<()> = Mutex::new(());

/// The Python of an environment `name` that has `packages`.
pub(crate) fn python(name: &str, packages: &[&str]) -> PathBuf {
    tried(name, packages).unwrap_or_else(|why| panic!("{why}"))
}

/// The same, or why it cannot be made.
pub(crate) fn tried(name: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let _making = MAKING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let python = folder.join("bin/python");
    let ready = folder.join("ready");
    if !ready.exists() {
        let run = |program: &Path, words: &[&str]| {
            let output = Command::new(program).args(words).output().expect("Python is on the machine");
            if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
        };
        run(Path::new("python3"), &["-m", "venv", "--clear", &folder.to_string_lossy()])?;
        run(&python, &[&["-m", "pip", "install", "--quiet"], packages].concat())?;
        std::fs::write(ready, "").expect("the folder is there");
    }
    Ok(python)
}
