//! The files of a scenario's snapshots: reviewed ones, and pending ones beside them.

use std::path::{Path, PathBuf};

use onescan_base::regular::{Limit, NotWithin, Within};
use onescan_report::{FileError, file};
use onescan_scenario::permission::granted;

use super::Snapshot;
use super::error::StoreError;
use onescan_runner::error::{Unreadable, Usage};

/// The folder beside `scenario.toml`.
pub const FOLDER: &str = "snapshots";
const REVIEWED: &str = ".traj";
const PENDING: &str = ".traj.new";

/// The snapshot of one case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The scenario's folder; its file, if that is not called as usual.
    pub scenario: PathBuf,
    pub case: String,
}

impl Place {
    /// The snapshot that was reviewed.
    pub fn reviewed(&self) -> PathBuf {
        shelf(&self.scenario).join(format!("{}{REVIEWED}", self.case))
    }

    /// The snapshot that waits for a review.
    pub fn pending(&self) -> PathBuf {
        shelf(&self.scenario).join(format!("{}{PENDING}", self.case))
    }

    /// The scenario's folder.
    pub fn folder(&self) -> &Path {
        folder_of(&self.scenario)
    }

    /// The reviewed snapshot, if there is one.
    ///
    /// # Errors
    /// It cannot be read, or is none.
    pub fn read_reviewed(&self) -> Result<Option<Snapshot>, StoreError> {
        read(&self.reviewed(), &granted().within(self.folder()))
    }

    /// The pending snapshot, if there is one.
    ///
    /// # Errors
    /// It cannot be read, or is none.
    pub fn read_pending(&self) -> Result<Option<Snapshot>, StoreError> {
        read(&self.pending(), &granted().within(self.folder()))
    }

    /// Makes a snapshot the reviewed one; what was pending is so no longer.
    ///
    /// # Errors
    /// The files cannot be written.
    pub fn accept(&self, snapshot: &Snapshot) -> Result<(), StoreError> {
        // In this order nothing is lost if it ends between the two.
        self.write(&self.reviewed(), snapshot)?;
        self.reject()
    }

    /// Keeps a snapshot for a review.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep(&self, snapshot: &Snapshot) -> Result<(), StoreError> {
        self.write(&self.pending(), snapshot)
    }

    /// Drops what is pending.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn reject(&self) -> Result<(), StoreError> {
        self.check_shelf()?;
        let path = self.pending();
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(FileError { path, source }.into()),
            _ => Ok(()),
        }
    }

    /// A folder that is a link would have files and folders made, and files removed, elsewhere.
    fn check_shelf(&self) -> Result<(), StoreError> {
        let bounds = granted().within(self.folder());
        for path in [self.folder().join(FOLDER), shelf(&self.scenario)] {
            match bounds.find(&path) {
                Ok(_) | Err(NotWithin::Missing(_)) => {}
                Err(elsewhere) => return Err(FileError { path, source: elsewhere.into() }.into()),
            }
        }
        Ok(())
    }

    fn write(&self, path: &Path, snapshot: &Snapshot) -> Result<(), StoreError> {
        self.check_shelf()?;
        file::create_folder(&shelf(&self.scenario))?;
        Ok(file::write_whole(path, snapshot.to_text().as_bytes())?)
    }
}

/// The folder of a scenario that is named by its folder or its file.
fn folder_of(scenario: &Path) -> &Path {
    if is_file(scenario) { scenario.parent().unwrap_or(Path::new("")) } else { scenario }
}

/// Whether a scenario is named by its file: several of a folder are distinguished by it.
fn is_file(scenario: &Path) -> bool {
    scenario.extension().is_some_and(|ending| ending == "toml") && !scenario.is_dir()
}

/// Where the snapshots of a scenario are: those of a file that is not called as usual in a folder of its name.
fn shelf(scenario: &Path) -> PathBuf {
    let all = folder_of(scenario).join(FOLDER);
    match scenario.file_stem().filter(|_| is_file(scenario)) {
        Some(name) => all.join(name),
        None => all,
    }
}

/// The snapshot in a file, if it is there.
///
/// # Errors
/// It cannot be read, or is none.
pub fn read(path: &Path, within: &Within) -> Result<Option<Snapshot>, StoreError> {
    let bytes = match within.read(path, Limit::TEXT) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(Unreadable { path: path.to_owned(), source }.into()),
    };
    let help = || Some("take it back from version control, or delete it and run `onescan test` again".to_owned());
    let Ok(text) = String::from_utf8(bytes) else {
        return Err(Usage::new(format!("{} is not a snapshot: it is not text", path.display()), help()).into());
    };
    match Snapshot::parse(&text) {
        Ok(snapshot) => Ok(Some(snapshot)),
        Err(error) => Err(Usage::new(format!("{}: {error}", path.display()), help()).into()),
    }
}

/// The snapshots that wait for a review below a scenario, in the order of their names.
///
/// # Errors
/// The folder cannot be read.
pub fn pending(scenario: &Path) -> Result<Vec<Place>, StoreError> {
    named(scenario, PENDING)
}

/// The reviewed snapshots of a scenario, in the order of their names.
///
/// # Errors
/// The folder cannot be read.
pub fn reviewed(scenario: &Path) -> Result<Vec<Place>, StoreError> {
    named(scenario, REVIEWED)
}

fn named(scenario: &Path, ending: &str) -> Result<Vec<Place>, StoreError> {
    let folder = shelf(scenario);
    let failed = Unreadable::at(&folder);
    let entries = match std::fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(failed(error).into()),
    };
    let mut cases = Vec::new();
    for entry in entries {
        let name = entry.map_err(&failed)?.file_name().to_string_lossy().into_owned();
        cases.extend(name.strip_suffix(ending).map(str::to_owned));
    }
    cases.sort();
    Ok(cases.into_iter().map(|case| Place { scenario: scenario.to_owned(), case }).collect())
}
