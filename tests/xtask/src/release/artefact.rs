//! The archive of the program for this platform, and its checksum.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use super::{output, run};
use crate::error::TaskError;

/// What is handed out beside the program: its terms, and what has changed.
const DOCUMENTS: [&str; 5] = ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT", "web/LICENCES.md"];

/// Builds the program with the profile `dist` and packs it; returns the archive and the file of its checksum.
///
/// # Errors
/// The page was not built, the build fails, or a file cannot be written.
pub(super) fn build(root: &Path, version: &str) -> Result<Vec<PathBuf>, TaskError> {
    // The build takes in the page if it is there; without it the program would have none, and nobody would notice.
    if !root.join("web/dist/index.html").is_file() {
        return Err(TaskError::NotReady("web/dist has no page: run `npm ci && npm run build` in `web`".to_owned()));
    }
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    run(Command::new(cargo)
        .args(["build", "--profile", "dist", "--locked", "--package", "onescan"])
        .current_dir(root))?;
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    let name = format!("onescan-{version}-{}", host()?);
    let folder = target.join("release-files");
    let staged = folder.join(&name);
    if staged.exists() {
        fs::remove_dir_all(&staged)?;
    }
    fs::create_dir_all(&staged)?;
    let program = format!("onescan{}", env::consts::EXE_SUFFIX);
    copy(&target.join("dist").join(&program), &staged.join(&program))?;
    for document in DOCUMENTS {
        copy(&root.join(document), &staged.join(document.replace('/', "-")))?;
    }
    let archive = format!("{name}.tar.gz");
    run(Command::new("tar").arg("-czf").arg(&archive).arg(&name).current_dir(&folder))?;
    // The form that `sha256sum --check` reads; Git for Windows brings the command.
    let sum = output(Command::new("sha256sum").arg(&archive).current_dir(&folder))?;
    let sum_file = folder.join(format!("{archive}.sha256"));
    fs::write(&sum_file, sum)?;
    Ok(vec![folder.join(archive), sum_file])
}

fn copy(from: &Path, to: &Path) -> Result<(), TaskError> {
    fs::copy(from, to).map(drop).map_err(|source| TaskError::Unreadable { path: from.to_owned(), source })
}

/// The platform that rustc builds for, as in `x86_64-unknown-linux-gnu`.
fn host() -> Result<String, TaskError> {
    let version = output(Command::new("rustc").arg("-vV"))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| TaskError::Failed("rustc -vV".to_owned()))
}
