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
    let program = target.join("dist").join(format!("onescan{}", env::consts::EXE_SUFFIX));
    pack(root, &program, &target.join("release-files"), &format!("onescan-{version}-{}", host()?))
}

/// Puts the program and its documents into an archive called `name` below `folder`.
fn pack(root: &Path, program: &Path, folder: &Path, name: &str) -> Result<Vec<PathBuf>, TaskError> {
    let staged = folder.join(name);
    if staged.exists() {
        fs::remove_dir_all(&staged)?;
    }
    fs::create_dir_all(&staged)?;
    let file = program.file_name().ok_or_else(|| TaskError::wrong(program, "it is not a file"))?;
    copy(program, &staged.join(file))?;
    for document in DOCUMENTS {
        copy(&root.join(document), &staged.join(document.replace('/', "-")))?;
    }
    let archive = format!("{name}.tar.gz");
    run(Command::new("tar").arg("-czf").arg(&archive).arg(name).current_dir(folder))?;
    // The form that `sha256sum --check` reads; Git for Windows brings the command.
    let sum = output(Command::new("sha256sum").arg(&archive).current_dir(folder))?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace;

    #[test]
    fn the_archive_has_program_and_terms_and_its_checksum_is_right() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("onescan");
        fs::write(&program, "the program").unwrap();
        let files = folder.path().join("files");
        // Twice: what an earlier release left does not hinder the next one.
        let first = pack(&workspace::root(), &program, &files, "onescan-0.2.0-here").unwrap();
        let written = pack(&workspace::root(), &program, &files, "onescan-0.2.0-here").unwrap();
        assert_eq!(written, first);
        let listed = output(Command::new("tar").arg("-tzf").arg(&written[0])).unwrap();
        for name in ["onescan", "LICENSE-MIT", "LICENSE-APACHE", "web-LICENCES.md"] {
            assert!(listed.contains(&format!("onescan-0.2.0-here/{name}\n")), "{listed}");
        }
        output(Command::new("sha256sum").arg("--check").arg(&written[1]).current_dir(&files)).unwrap();
    }

    #[test]
    fn the_platform_has_a_name() {
        assert!(host().unwrap().contains(env::consts::ARCH));
    }
}
