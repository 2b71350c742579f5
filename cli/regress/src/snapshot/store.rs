//! The files of a scenario's snapshots: reviewed ones, and pending ones beside them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use onescan_base::regular::{Limit, NotWithin, Within};
use onescan_report::{FileError, file};
use onescan_scenario::permission::granted;

use super::conflict::{self, Conflict};
use super::error::StoreError;
use super::{Snapshot, compare};
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

/// What the file of reviewed snapshots holds for a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reviewed {
    /// The file is not there: the case was never reviewed.
    Nothing,
    One(Snapshot),
    /// Two branches changed it, and whoever merged them left that to the review.
    Undecided(Merge),
}

/// A snapshot with both sides of a merge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Merge {
    path: PathBuf,
    /// The line of the first mark, from 1.
    line: usize,
    names: [String; 2],
    /// Nothing where git put lines of both together that make no snapshot.
    sides: [Option<Snapshot>; 2],
}

impl Merge {
    /// The side to compare a run with: the one that it is equal to, else the first that is a snapshot.
    pub fn nearest(&self, run: &Snapshot, tolerances: &BTreeMap<String, f64>) -> Option<&Snapshot> {
        let equal = self.sides.iter().flatten().find(|side| compare(side, run, tolerances).is_empty());
        equal.or_else(|| self.sides.iter().flatten().next())
    }

    /// Where it is, and whose run it is, in words.
    pub fn note(&self, run: &Snapshot, tolerances: &BTreeMap<String, f64>) -> String {
        let is_equal =
            |side: &Option<Snapshot>| side.as_ref().is_some_and(|side| compare(side, run, tolerances).is_empty());
        let equal = self.names.iter().zip(&self.sides).filter(|(_, side)| is_equal(side)).map(|(name, _)| name);
        let whose = match equal.collect::<Vec<_>>()[..] {
            [] => "this run is that of neither side".to_owned(),
            [one] => format!("this run is that of `{one}`"),
            [..] => "this run is that of both sides".to_owned(),
        };
        format!("{}:{} holds both sides of a merge; {whose}", self.path.display(), self.line)
    }
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
    /// It cannot be read, or is not a snapshot; also where a merge left it undecided.
    pub fn read_reviewed(&self) -> Result<Option<Snapshot>, StoreError> {
        read(&self.reviewed(), &granted().within(self.folder()))
    }

    /// The reviewed snapshot, or both sides of a merge.
    ///
    /// # Errors
    /// It cannot be read, or is not a snapshot.
    pub fn read_merged(&self) -> Result<Reviewed, StoreError> {
        let path = self.reviewed();
        let Some(text) = text(&path, &granted().within(self.folder()))? else { return Ok(Reviewed::Nothing) };
        match conflict::sides(&text) {
            Some(Conflict { line, names, sides }) => {
                let sides = sides.map(|side| Snapshot::parse(&side).ok());
                Ok(Reviewed::Undecided(Merge { path, line, names, sides }))
            }
            None => Ok(Reviewed::One(parsed(&path, &text)?)),
        }
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
/// It cannot be read, or is not a snapshot.
pub fn read(path: &Path, within: &Within) -> Result<Option<Snapshot>, StoreError> {
    text(path, within)?.map(|text| parsed(path, &text)).transpose()
}

fn text(path: &Path, within: &Within) -> Result<Option<String>, StoreError> {
    let bytes = match within.read(path, Limit::TEXT) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(Unreadable { path: path.to_owned(), source }.into()),
    };
    let not_text = |_| Usage::new(format!("{} is not a snapshot: it is not text", path.display()), Some(help()));
    Ok(Some(String::from_utf8(bytes).map_err(not_text)?))
}

fn parsed(path: &Path, text: &str) -> Result<Snapshot, StoreError> {
    if let Some(Conflict { line, .. }) = conflict::sides(text) {
        let help = "type `onescan test`, then `onescan review`: it shows the run beside the sides, and writes the one you accept";
        let what = format!("{}:{line} holds both sides of a merge", path.display());
        return Err(Usage::new(what, Some(help.to_owned())).into());
    }
    Snapshot::parse(text).map_err(|error| Usage::new(format!("{}: {error}", path.display()), Some(help())).into())
}

/// What to do about a file that is not a snapshot.
fn help() -> String {
    "take it back from version control, or delete it and run `onescan test` again".to_owned()
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
