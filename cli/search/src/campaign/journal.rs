//! The folder of a campaign's work: what has been done of it, so that it can be gone on with after whatever ended it,
//! and put together from parts that were done elsewhere.
//!
//! `journal.jsonl` has a line for what the campaign is, one for the run without faults, and one for each run that is
//! done.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use onescan_base::regular::{self, Limit};
use onescan_report::{FileError, file};
use onescan_scenario::case::Campaign;
use onescan_scenario::{Scenario, permission};
use onescan_server::time::VirtualTime;
use serde::{Deserialize, Serialize};
use tempfile::TempDir;

use super::CampaignError;
use super::reading::{BaseRuns, Reading, Way};
use crate::forest::{self, Journal, JournalError};
use onescan_runner::error::{Unreadable, Usage};
use onescan_runner::run::ForkRequest;

/// Whose journal it is, in messages.
const SEARCH: &str = "campaign";
const JOURNAL: &str = "journal.jsonl";
const FORKS: &str = "forks";

/// What a journal's runs are of: this program, and a campaign with all files of its scenario.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Subject {
    campaign: String,
    version: String,
    /// A hash over the scenario's files and their names.
    files: String,
}

/// A line of a journal.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Line {
    Subject(Subject),
    Healthy(BaseRuns),
    Done { case: String, reading: Reading },
}

/// What a journal says.
#[derive(Clone, Debug, Default)]
pub(super) struct Done {
    /// The run without faults.
    pub(super) healthy: Option<BaseRuns>,
    /// What was read out of runs with faults, by their case.
    pub(super) readings: BTreeMap<String, Reading>,
}

/// The folder of a campaign's work.
pub(super) struct Work {
    folder: PathBuf,
    /// Locked as long as somebody works here.
    journal: Journal,
    /// The folder is removed with it.
    _temporary: Option<TempDir>,
}

impl Subject {
    /// The subject of `campaign` of `scenario`.
    ///
    /// # Errors
    /// A file of the scenario cannot be read.
    pub(super) fn of(scenario: &Scenario, campaign: &Campaign) -> Result<Self, CampaignError> {
        let mut hasher = blake3::Hasher::new();
        let mut files = scenario.files()?;
        files.extend(campaign.program_files().map(PathBuf::from));
        files.push(scenario.cases_file()?);
        files.sort();
        files.dedup();
        for name in files {
            let path = scenario.folder().join(&name);
            permission::granted().check(scenario.folder(), &path)?;
            let bytes = regular::read(&path, Limit::DATA).map_err(Unreadable::at(&path))?;
            for part in [name.to_string_lossy().as_bytes(), &bytes] {
                // With its length, so that no two lists of files are the same stream.
                hasher.update(&(part.len() as u64).to_le_bytes()).update(part);
            }
        }
        let files = hasher.finalize().to_hex().to_string();
        Ok(Self { campaign: campaign.name.clone(), version: env!("CARGO_PKG_VERSION").to_owned(), files })
    }

    /// Refuses a journal of anything else.
    fn check(&self, found: Option<&Self>, path: &Path) -> Result<(), Usage> {
        match found {
            Some(found) if found == self => Ok(()),
            Some(found) => {
                let what = if found.campaign != self.campaign {
                    format!("campaign `{}`", found.campaign)
                } else if found.version != self.version {
                    format!("onescan {}", found.version)
                } else {
                    "other files of the scenario".to_owned()
                };
                let help = "keep the work of this campaign in another folder, or remove that one".to_owned();
                Err(Usage::new(format!("{} was made of {what}", path.display()), Some(help)))
            }
            None => Err(Usage::new(format!("{} is not a journal of a campaign", path.display()), None)),
        }
    }
}

impl Work {
    /// Opens the folder of `subject`'s work below `keep`, or a temporary one, and says what has been done.
    ///
    /// # Errors
    /// The folder cannot be used, is of another campaign, or another process works in it.
    pub(super) fn open(keep: Option<&Path>, subject: &Subject) -> Result<(Self, Done), CampaignError> {
        let (folder, temporary) = if let Some(keep) = keep {
            (keep.join(&subject.campaign), None)
        } else {
            let in_vain = |source| FileError { path: std::env::temp_dir(), source };
            let temporary = TempDir::new().map_err(in_vain)?;
            (temporary.path().to_owned(), Some(temporary))
        };
        file::create_folder(&folder)?;
        let path = folder.join(JOURNAL);
        let (journal, lines) = Journal::open(path.clone(), SEARCH)?;
        let work = Self { folder, journal, _temporary: temporary };
        if lines.is_empty() {
            work.journal.append(&Line::Subject(subject.clone()))?;
            return Ok((work, Done::default()));
        }
        let mut done = done_of(lines, subject, &path)?;
        // Checkpoints that somebody removed are taken again, by the same run.
        done.healthy = done.healthy.filter(|healthy| {
            let variants = healthy.readings.len().max(1);
            healthy.ways.iter().enumerate().all(|(case, way)| work.has_fork(case % variants, *way))
        });
        Ok((work, done))
    }

    /// What has been done in a folder in which nobody works any more.
    ///
    /// # Errors
    /// There is no journal, or it is of another campaign.
    pub(super) fn read(keep: &Path, subject: &Subject) -> Result<Done, CampaignError> {
        let path = keep.join(&subject.campaign).join(JOURNAL);
        Ok(done_of(forest::read(&path, SEARCH)?, subject, &path)?)
    }

    /// Where the checkpoints are.
    pub(super) fn forks(&self) -> PathBuf {
        self.folder.join(FORKS)
    }

    fn has_fork(&self, variant: usize, way: Way) -> bool {
        let Way::Fork(t_ns) = way else { return true };
        let folder = of_variant(&self.forks(), variant);
        ForkRequest::fork_file(&folder, VirtualTime::from_nanos(t_ns)).is_file()
    }

    /// Notes the run without faults.
    ///
    /// # Errors
    /// The journal cannot be written.
    pub(super) fn healthy(&self, healthy: &BaseRuns) -> Result<(), JournalError> {
        self.journal.append(&Line::Healthy(healthy.clone()))
    }

    /// The journal, in which processes note what they have done.
    pub(super) fn journal(&self) -> &Path {
        self.journal.path()
    }
}

/// The folder of the checkpoints of a variant's run without faults.
pub(super) fn of_variant(forks: &Path, variant: usize) -> PathBuf {
    forks.join(variant.to_string())
}

/// Notes that the run of `case` is done, in the journal at `path`.
///
/// # Errors
/// The journal cannot be written.
pub(super) fn note_done(path: &Path, case: &str, reading: &Reading) -> Result<(), JournalError> {
    forest::append(path, &Line::Done { case: case.to_owned(), reading: reading.clone() })
}

fn done_of(lines: Vec<Line>, subject: &Subject, path: &Path) -> Result<Done, Usage> {
    let first = if let Some(Line::Subject(found)) = lines.first() { Some(found) } else { None };
    subject.check(first, path)?;
    let mut done = Done::default();
    for line in lines {
        match line {
            Line::Subject(_) => {}
            Line::Healthy(base_runs) => done.healthy = Some(base_runs),
            Line::Done { case, reading } => drop(done.readings.insert(case, reading)),
        }
    }
    Ok(done)
}
