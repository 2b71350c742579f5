//! `onescan bisect`: the commit that first changed what a scenario does.
//!
//! The commits between a good and a bad one are searched by halves. Each is taken out of the
//! repository into a folder of its own (`git archive`); the user's working tree is not touched. A
//! commit whose scenario does not load or compile is skipped.

mod error;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use onescan_recording::Recording;
use onescan_report::FileError;
use onescan_report::OutputError;
use onescan_server::digest::Digest;
use onescan_server::time::VirtualTime;
use serde_json::json;

pub use error::BisectError;

use crate::diff;
use onescan_runner::error::ExitCode;
use onescan_runner::error::Usage;

use crate::repository::Repository;
use onescan_runner::format::Format;
use onescan_runner::interrupt::Interrupt;
use onescan_runner::run::config::RecordRequest;
use onescan_runner::run::{RunConfig, execute};

#[derive(Clone, Debug)]
pub struct BisectConfig {
    /// The scenario's folder, in a working tree of git.
    pub scenario: PathBuf,
    /// A commit that does what is right.
    pub good: String,
    /// A later one that does not do the same.
    pub bad: String,
    /// How long each runs; as long as the scenario says if absent.
    pub until: Option<VirtualTime>,
    /// For whom the report is.
    pub format: Format,
}

/// A commit, and what came of its run.
#[derive(Clone, Debug)]
struct Tried {
    commit: String,
    /// Its recording; nothing if it could not be run, with why.
    run: Result<(PathBuf, Option<Digest>), String>,
}

/// Searches, and writes what was found to `out`, each commit as it is tried to `progress`.
///
/// # Errors
/// No working tree, no such commit, a good or bad commit that cannot be run.
pub fn bisect(
    config: &BisectConfig,
    interrupt: &Interrupt,
    out: &mut dyn Write,
    progress: &mut dyn Write,
) -> Result<ExitCode, BisectError> {
    let repository = Repository::of(&config.scenario)?;
    let commits = repository.between(&config.good, &config.bad)?;
    let folder = tempfile::tempdir().map_err(|source| FileError { path: std::env::temp_dir(), source })?;
    let mut search = Search { config, repository, folder, interrupt, progress };
    let good = search.ends(&commits[0])?;
    let bad = search.ends(&commits[commits.len() - 1])?;
    if good.digest() == bad.digest() {
        match config.format {
            Format::Human => writeln!(out, "{} and {} have the same digest", config.good, config.bad),
            Format::Json => writeln!(out, "{}", json!({ "found": false })),
        }
        .map_err(OutputError)?;
        return Ok(ExitCode::Ok);
    }
    let found = search.first_bad(&commits, good, bad)?;
    found.write(&search.repository, config.format, out)?;
    Ok(ExitCode::Unmet)
}

/// The first commit that differs, the last before it that does not, and those between that cannot be
/// run.
struct Found {
    before: Tried,
    first: Tried,
    skipped: Vec<Tried>,
}

struct Search<'c> {
    config: &'c BisectConfig,
    repository: Repository,
    folder: tempfile::TempDir,
    interrupt: &'c Interrupt,
    progress: &'c mut dyn Write,
}

impl Search<'_> {
    /// A commit that must run.
    fn ends(&mut self, commit: &str) -> Result<Tried, BisectError> {
        let tried = self.try_commit(commit)?;
        match &tried.run {
            Ok(_) => Ok(tried),
            Err(why) => Err(Usage::new(format!("commit {} cannot be run: {why}", short(commit)), None).into()),
        }
    }

    /// Invariant: what is at `low` has the digest of the good commit, what is at `high` has not.
    fn first_bad(&mut self, commits: &[String], good: Tried, bad: Tried) -> Result<Found, BisectError> {
        let wanted = good.digest();
        let (mut low, mut high) = (0, commits.len() - 1);
        let (mut before, mut first) = (good, bad);
        let mut skipped: Vec<(usize, Tried)> = Vec::new();
        loop {
            let open: Vec<usize> =
                (low + 1..high).filter(|index| skipped.iter().all(|(known, _)| known != index)).collect();
            let Some(&middle) = open.get(open.len() / 2) else { break };
            let tried = self.try_commit(&commits[middle])?;
            match &tried.run {
                Err(_) => skipped.push((middle, tried)),
                Ok(_) if tried.digest() == wanted => (low, before) = (middle, tried),
                Ok(_) => (high, first) = (middle, tried),
            }
        }
        skipped.sort_by_key(|(index, _)| *index);
        let between = skipped.into_iter().filter(|(index, _)| (low..high).contains(index));
        Ok(Found { before, first, skipped: between.map(|(_, tried)| tried).collect() })
    }

    fn try_commit(&mut self, commit: &str) -> Result<Tried, BisectError> {
        if self.interrupt.is_raised() {
            return Err(Usage::new("interrupted", None).into());
        }
        let folder = self.folder.path().join(commit);
        let run =
            self.repository.take_out(commit, Path::new(""), &folder.join("tree"))?.and_then(|()| self.run(&folder));
        let said = match &run {
            Ok((_, Some(digest))) => digest.to_string()[..16].to_owned(),
            Ok((_, None)) => "no digest".to_owned(),
            Err(why) => format!("skipped: {}", why.lines().next().unwrap_or_default()),
        };
        if self.config.format == Format::Human {
            writeln!(self.progress, "{}  {said}", short(commit)).map_err(OutputError)?;
        }
        Ok(Tried { commit: commit.to_owned(), run })
    }

    fn run(&self, folder: &Path) -> Result<(PathBuf, Option<Digest>), String> {
        let record = folder.join("record");
        let scenario = folder.join("tree").join(self.repository.scenario());
        let mut config = RunConfig::headless(scenario, None);
        config.subject.until = self.config.until;
        config.reports.record = Some(RecordRequest { folder: record.clone(), ..RecordRequest::default() });
        execute(&config, self.interrupt, &mut io::sink()).map_err(|error| error.to_string())?;
        let recording = Recording::open(&record).map_err(|error| error.to_string())?;
        let last = recording.steps().map(|steps| recording.digest(*steps.end()));
        Ok((record, last.transpose().map_err(|error| error.to_string())?))
    }
}

impl Tried {
    fn digest(&self) -> Option<Digest> {
        self.run.as_ref().ok().and_then(|(_, digest)| *digest)
    }

    fn recording(&self) -> Option<&Path> {
        self.run.as_ref().ok().map(|(folder, _)| folder.as_path())
    }
}

impl Found {
    fn write(&self, repository: &Repository, format: Format, out: &mut dyn Write) -> Result<(), BisectError> {
        let report = match (self.before.recording(), self.first.recording()) {
            (Some(before), Some(first)) => Some(diff::compare(before, first, VirtualTime::ZERO, &[])?),
            _ => None,
        };
        let [commit, author, date, subject] = repository.about(&self.first.commit)?;
        match format {
            Format::Json => {
                let skipped: Vec<&str> = self.skipped.iter().map(|tried| tried.commit.as_str()).collect();
                let report = report.as_ref().map(diff::report::Report::json);
                let all = json!({
                    "found": true, "commit": commit, "author": author, "date": date, "subject": subject,
                    "before": self.before.commit, "skipped": skipped, "diff": report,
                });
                Ok(writeln!(out, "{all}").map_err(OutputError)?)
            }
            Format::Human => {
                writeln!(out, "first to differ: {} {subject}\n  {author}, {date}", short(&commit))
                    .map_err(OutputError)?;
                if !self.skipped.is_empty() {
                    let names: Vec<&str> = self.skipped.iter().map(|tried| short(&tried.commit)).collect();
                    writeln!(out, "  or one of those that cannot be run: {}", names.join(", ")).map_err(OutputError)?;
                }
                writeln!(out).map_err(OutputError)?;
                Ok(report.map_or(Ok(()), |report| report.write_findings(out)).map_err(OutputError)?)
            }
        }
    }
}

fn short(commit: &str) -> &str {
    commit.get(..12).unwrap_or(commit)
}
