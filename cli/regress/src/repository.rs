//! What a scenario was at other commits: its repository, asked through git. The user's working tree is not touched.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use onescan_report::{FileError, file};

use onescan_runner::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why a repository does not answer.
    pub enum RepositoryError {
        /// There is none, or no such commit.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be written.
        File(FileError),
    }
}

/// The repository that a scenario is in.
#[derive(Clone, Debug)]
pub struct Repository {
    root: PathBuf,
    /// The scenario's folder in it.
    scenario: PathBuf,
}

impl Repository {
    /// The repository around a scenario.
    ///
    /// # Errors
    /// There is none, or no git.
    pub fn of(scenario: &Path) -> Result<Self, RepositoryError> {
        let folder = if scenario.is_dir() { scenario } else { scenario.parent().unwrap_or(Path::new(".")) };
        let folder = if folder == Path::new("") { Path::new(".") } else { folder };
        let root = git(folder, &["rev-parse", "--show-toplevel"])?;
        let prefix = git(folder, &["rev-parse", "--show-prefix"])?;
        Ok(Self { root: PathBuf::from(root.trim_end()), scenario: PathBuf::from(prefix.trim_end()) })
    }

    /// The scenario's folder in the repository.
    pub fn scenario(&self) -> &Path {
        &self.scenario
    }

    /// The whole name of a commit.
    ///
    /// # Errors
    /// There is no such commit.
    pub fn commit(&self, name: &str) -> Result<String, RepositoryError> {
        // What a user names may begin with a dash: it is not to be an option.
        let words = ["rev-parse", "--verify", "--quiet", "--end-of-options", &format!("{name}^{{commit}}")];
        let commit = git(&self.root, &words);
        let unknown = |_| Usage::new(format!("the repository has no commit `{name}`"), None);
        Ok(commit.map_err(unknown)?.trim_end().to_owned())
    }

    /// The last commit that changed a file of the scenario; nothing if none has.
    ///
    /// # Errors
    /// Git does not say.
    pub fn last_change(&self, file: &Path) -> Result<Option<String>, RepositoryError> {
        let path = self.scenario.join(file);
        let commit = git(&self.root, &["log", "-1", "--format=%H", "--", &path.to_string_lossy()])?;
        Ok(Some(commit.trim_end().to_owned()).filter(|commit| !commit.is_empty()))
    }

    /// The commits from `good` to `bad`, both included, by the first parent: the good one first.
    ///
    /// # Errors
    /// There is no such commit, or none after the good one.
    pub fn between(&self, good: &str, bad: &str) -> Result<Vec<String>, RepositoryError> {
        let (good, bad) = (self.commit(good)?, self.commit(bad)?);
        let range = format!("{good}..{bad}");
        let list = git(&self.root, &["rev-list", "--first-parent", "--reverse", &range])?;
        let mut commits = vec![good];
        commits.extend(list.lines().map(str::to_owned));
        if commits.len() < 2 {
            let message = "there is no commit after the good one on the way to the bad one".to_owned();
            return Err(Usage::new(message, Some("name the older commit with `--good`".to_owned())).into());
        }
        Ok(commits)
    }

    /// Hash, author, date and subject.
    ///
    /// # Errors
    /// There is no such commit.
    pub fn about(&self, commit: &str) -> Result<[String; 4], RepositoryError> {
        let text = git(&self.root, &["show", "--no-patch", "--format=%H%n%an <%ae>%n%aI%n%s", commit])?;
        // A commit may have no subject, which is then no line.
        let mut lines = text.lines().map(str::to_owned);
        Ok(std::array::from_fn(|_| lines.next().unwrap_or_default()))
    }

    /// Writes the files of a commit that are in `part` of the repository into `folder`, all of them where `part` is
    /// empty. The inner error says why it has no such files.
    ///
    /// # Errors
    /// Git or tar cannot be started, or the folder cannot be made.
    pub fn take_out(&self, commit: &str, part: &Path, folder: &Path) -> Result<Result<(), String>, RepositoryError> {
        file::create_folder(folder)?;
        let archive = Command::new("git")
            .current_dir(&self.root)
            .args(["archive", "--format=tar", commit])
            .args((part != Path::new("")).then_some(part))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut archive = archive.map_err(|source| spawn("git", &source))?;
        let Some(tar) = archive.stdout.take() else { return Ok(Err("git gives no archive".to_owned())) };
        let unpacked = Command::new("tar").arg("-xf").arg("-").arg("-C").arg(folder).stdin(tar).output();
        let unpacked = unpacked.map_err(|source| spawn("tar", &source))?;
        // After tar: git does not end before somebody has read all that it writes.
        let archived = archive.wait().map_err(|source| spawn("git", &source))?;
        let whole = archived.success() && unpacked.status.success();
        Ok(if whole { Ok(()) } else { Err(String::from_utf8_lossy(&unpacked.stderr).trim().to_owned()) })
    }
}

fn spawn(program: &str, source: &io::Error) -> Usage {
    Usage::new(format!("cannot start `{program}`: {source}"), Some("this needs git and tar".to_owned()))
}

/// What git says.
fn git(folder: &Path, words: &[&str]) -> Result<String, RepositoryError> {
    let output = Command::new("git").current_dir(folder).args(words).output();
    let output = output.map_err(|source| spawn("git", &source))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let line = said.lines().next().unwrap_or("it does not say why").trim_start_matches("fatal: ").to_owned();
    Err(Usage::new(format!("git: {line}"), None).into())
}
