//! What scenarios may do on the machine that runs them: which files they may read, and whether they may start programs.
//!
//! This is for the whole process, like the user it runs as: whoever starts it decides once, before the first scenario is
//! read, and nothing in a scenario can change it.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use onescan_base::regular::{Limit, NotWithin, Within};

use super::error::ScenarioError;

/// The variable with the folders that scenarios may read beside their own, as a list of paths.
pub const PATHS_VARIABLE: &str = "ONESCAN_ALLOW_PATH";
/// The variable that forbids scenarios to start programs, if it is `1` or `true`.
pub const NO_COMMANDS_VARIABLE: &str = "ONESCAN_NO_COMMANDS";

/// What scenarios may do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Permission {
    /// Files, and folders with all that is in them, which scenarios may read beside their own folder.
    pub paths: Vec<PathBuf>,
    /// They may not start programs.
    pub no_commands: bool,
}

static GRANTED: OnceLock<Permission> = OnceLock::new();

/// Says what scenarios may do. Only the first call counts: nobody who comes later can take it back, or add to it.
pub fn grant(permission: Permission) {
    // A second one is a process that is asked twice for the same.
    let _ = GRANTED.set(permission);
}

/// What scenarios may do: read their own folder and start programs, unless somebody has said otherwise.
pub fn granted() -> &'static Permission {
    GRANTED.get_or_init(Permission::default)
}

impl Permission {
    /// The same for a process that this one starts, as variables of its environment.
    pub fn variables(&self) -> Vec<(&'static str, std::ffi::OsString)> {
        let mut variables = Vec::new();
        // A path with the separator in it cannot be passed on; it is not granted there.
        if let Ok(paths) = std::env::join_paths(&self.paths)
            && !paths.is_empty()
        {
            variables.push((PATHS_VARIABLE, paths));
        }
        if self.no_commands {
            variables.push((NO_COMMANDS_VARIABLE, "1".into()));
        }
        variables
    }

    /// Whether a scenario of `folder` may read `path`, wherever links lead.
    ///
    /// # Errors
    /// It lies elsewhere. Nothing of what is in it is said.
    pub fn check(&self, folder: &Path, path: &Path) -> Result<(), ScenarioError> {
        match self.within(folder).find(path) {
            // Reading it reports that it is missing; what cannot be resolved cannot be read.
            Ok(_) | Err(NotWithin::Missing(_)) => Ok(()),
            Err(NotWithin::Elsewhere(real)) => Err(ScenarioError::Outside { path: path.to_owned(), real }),
        }
    }

    /// What is in a file that a scenario of `folder` may read; the file that is looked at is the one that is read.
    ///
    /// # Errors
    /// It lies elsewhere; within it that it cannot be read.
    pub fn read(&self, folder: &Path, path: &Path, limit: Limit) -> Result<io::Result<Vec<u8>>, ScenarioError> {
        self.check(folder, path)?;
        Ok(self.within(folder).read(path, limit))
    }

    /// The same for a file of text.
    ///
    /// # Errors
    /// As [`Permission::read`].
    pub fn read_text(&self, folder: &Path, path: &Path) -> Result<io::Result<String>, ScenarioError> {
        self.check(folder, path)?;
        Ok(self.within(folder).read_text(path))
    }

    /// What a scenario of `folder` may read, for those who read for it.
    pub fn within(&self, folder: &Path) -> Within {
        Within::places(std::iter::once(folder.to_owned()).chain(self.paths.iter().cloned()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn links_and_dots_do_not_lead_out() {
        let place = tempfile::tempdir().unwrap();
        let own = place.path().join("own");
        let other = place.path().join("other");
        for folder in [&own, &other] {
            std::fs::create_dir(folder).unwrap();
            std::fs::write(folder.join("a.st"), "").unwrap();
        }
        std::os::unix::fs::symlink(other.join("a.st"), own.join("link.st")).unwrap();
        std::os::unix::fs::symlink(&own, place.path().join("way")).unwrap();
        let nothing = Permission::default();
        assert!(nothing.check(&own, &own.join("a.st")).is_ok());
        assert!(nothing.check(&place.path().join("way"), &own.join("../own/a.st")).is_ok());
        assert!(nothing.check(&own, &own.join("missing.st")).is_ok(), "reported by whoever reads it");
        for path in [own.join("../other/a.st"), own.join("link.st"), other.join("a.st")] {
            let error = nothing.check(&own, &path).unwrap_err().to_string();
            assert!(error.contains("outside of the scenario's folder"), "{error}");
            let wider = Permission { paths: vec![other.clone()], ..Permission::default() };
            assert!(wider.check(&own, &path).is_ok());
        }
    }

    #[test]
    fn a_process_that_is_started_may_do_the_same() {
        let permission = Permission { paths: vec!["a".into(), "b".into()], no_commands: true };
        let names: Vec<_> = permission.variables().into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, [PATHS_VARIABLE, NO_COMMANDS_VARIABLE]);
        assert!(Permission::default().variables().is_empty());
    }
}
