//! The folder for certificates.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

/// How the names of passing folders begin; the number of their process follows.
const PREFIX: &str = "onescan-pki-";

/// Removes the passing folders of processes that were killed, and could not do so themselves: each has a private key.
/// Where it cannot be found out whether a process is there, they stay.
fn sweep(place: &Path) {
    let is_dead = |process: &str| {
        cfg!(target_os = "linux") && process.parse::<u32>().is_ok() && !Path::new("/proc").join(process).exists()
    };
    // A place that cannot be listed has nothing that can be removed; making the new folder there reports why.
    for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let process = name.to_str().and_then(|name| name.strip_prefix(PREFIX)).and_then(|rest| rest.split('-').next());
        if process.is_some_and(is_dead) {
            // One of another user stays, and so does one that somebody else is removing just now.
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

/// A folder that is kept, or one for this connection only.
#[derive(Debug)]
pub enum Pki {
    Kept(PathBuf),
    /// Gone when it is no more needed.
    Passing(TempDir),
}

impl Pki {
    /// The folder `kept`, or a passing one.
    ///
    /// # Errors
    /// There is no room for a passing one.
    pub fn new(kept: Option<&Path>) -> std::io::Result<Self> {
        if let Some(path) = kept {
            return Ok(Self::Kept(path.to_owned()));
        }
        sweep(&std::env::temp_dir());
        TempDir::with_prefix(format!("{PREFIX}{}-", std::process::id())).map(Self::Passing)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        match self {
            Self::Kept(path) => path,
            Self::Passing(folder) => folder.path(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_dead_have_left_is_removed_and_nothing_else() {
        let place = tempfile::tempdir().unwrap();
        // No process has a number beyond 2^22 on Linux.
        let (dead, alive) = (format!("{PREFIX}4294967295-a"), format!("{PREFIX}{}-b", std::process::id()));
        for name in [dead.as_str(), &alive, "onescan-pki-x", "other"] {
            std::fs::create_dir(place.path().join(name)).unwrap();
        }
        sweep(place.path());
        assert_eq!(place.path().join(dead).exists(), !cfg!(target_os = "linux"));
        for name in [alive.as_str(), "onescan-pki-x", "other"] {
            assert!(place.path().join(name).exists(), "{name}");
        }
    }
}
