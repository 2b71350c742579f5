//! The program that a snapshot was reviewed with, out of the repository.
//!
//! A snapshot holds no program. Where the scenario is in a repository, the program is there: at the commit that is
//! checked out, or at the one that last changed the snapshot. It is believed only if its run is the reviewed one.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use onescan_report::FileError;
use onescan_scenario::Scenario;
use tempfile::TempDir;

use super::TestError;
use super::plan::CaseUnit;
use crate::repository::Repository;
use crate::snapshot::take::Taker;
use crate::snapshot::{Snapshot, compare};
use onescan_runner::interrupt::Interrupt;
use onescan_runner::run::{RunConfig, watched};

/// Scenarios of commits that have been taken out; kept until the tests are over.
#[derive(Debug)]
pub(super) struct References {
    /// The commit that the user names.
    named: Option<String>,
    taken: Vec<Taken>,
}

/// A scenario's folder as it was at a commit.
#[derive(Debug)]
struct Taken {
    commit: String,
    scenario: PathBuf,
    folder: TempDir,
}

/// A program with the reviewed behaviour.
#[derive(Debug)]
pub(super) struct Reference {
    /// Its commit, as a person names it.
    pub(super) commit: String,
    /// The scenario with the case.
    pub(super) scenario: Scenario,
}

impl References {
    /// Those of a test run; the commit that the user names is the only one, if there is one.
    pub(super) fn new(named: Option<String>) -> Self {
        Self { named, taken: Vec::new() }
    }

    /// The program with the reviewed behaviour of a case; nothing if the repository has none, or there is no
    /// repository.
    ///
    /// # Errors
    /// The commit that the user names is none.
    pub(super) fn of(&mut self, unit: &CaseUnit, reviewed: &Snapshot) -> Result<Option<Reference>, TestError> {
        let repository = match (Repository::of(&unit.place.scenario), &self.named) {
            (Ok(repository), _) => repository,
            // Without a repository nothing is lost but the reason.
            (Err(_), None) => return Ok(None),
            (Err(error), Some(_)) => return Err(error.into()),
        };
        let mut names = Vec::from_iter(self.named.clone());
        if names.is_empty() {
            names.push("HEAD".to_owned());
            let place = unit.place.reviewed();
            let file = place.strip_prefix(unit.place.folder()).unwrap_or(&place);
            // A snapshot that no commit has, or a history that is cut off, has no last change: HEAD remains.
            names.extend(repository.last_change(file).unwrap_or_default());
        }
        for name in names {
            let commit = match repository.commit(&name) {
                Ok(commit) => commit,
                Err(error) if self.named.is_some() => return Err(error.into()),
                // A repository without a commit.
                Err(_) => continue,
            };
            let Some(tree) = self.tree(&repository, &commit)? else { continue };
            let file = unit.place.scenario.strip_prefix(unit.place.folder()).unwrap_or(Path::new(""));
            if let Some(scenario) = believed(&tree.join(repository.scenario()).join(file), unit, reviewed) {
                let short = commit.get(..12).unwrap_or(&commit).to_owned();
                let commit = if name == commit { short } else { name };
                return Ok(Some(Reference { commit, scenario }));
            }
        }
        Ok(None)
    }

    /// The files of a commit; nothing if they cannot be had.
    fn tree(&mut self, repository: &Repository, commit: &str) -> Result<Option<PathBuf>, TestError> {
        let scenario = repository.scenario();
        let is_it = |taken: &&Taken| taken.commit == commit && taken.scenario == scenario;
        if let Some(taken) = self.taken.iter().find(is_it) {
            return Ok(Some(taken.folder.path().to_owned()));
        }
        let folder = tempfile::tempdir().map_err(|source| FileError { path: std::env::temp_dir(), source })?;
        // A scenario reads its own folder.
        if let Err(why) = repository.take_out(commit, scenario, folder.path())? {
            tracing::debug!(commit, why, "a commit cannot be taken out");
            return Ok(None);
        }
        let path = folder.path().to_owned();
        self.taken.push(Taken { commit: commit.to_owned(), scenario: scenario.to_owned(), folder });
        Ok(Some(path))
    }
}

/// The scenario of another commit, if its run is the reviewed one.
fn believed(path: &Path, unit: &CaseUnit, reviewed: &Snapshot) -> Option<Scenario> {
    let scenario = Scenario::load_case(path, Some(&unit.place.case)).ok()?;
    let snapshot = Rc::new(RefCell::new(None));
    let taker = Taker::new(&scenario, unit.choice.clone(), Rc::clone(&snapshot));
    let config = RunConfig::headless(path.to_owned(), Some(unit.place.case.clone()));
    watched(&config, &scenario, &Interrupt::new(), vec![Box::new(taker)]).ok()?;
    let taken = snapshot.borrow_mut().take()?;
    compare(reviewed, &taken, &unit.choice.tolerances).is_empty().then_some(scenario)
}
