//! What a scenario was at other commits: its repository, asked through git. The user's working tree is not touched.

mod git;
mod tree;

use std::path::{Path, PathBuf};

use onescan_report::{FileError, file};
use onescan_runner::error::{Usage, sum_of_errors};
use onescan_scenario::permission::granted;

use self::tree::NotTaken;

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
    /// There is none, or no git, or nothing may be started.
    pub fn of(scenario: &Path) -> Result<Self, RepositoryError> {
        if granted().no_commands {
            let help = "leave `--no-commands` away, in a folder that you trust".to_owned();
            return Err(Usage::new("this asks git, which `--no-commands` forbids", Some(help)).into());
        }
        let folder = if scenario.is_dir() { scenario } else { scenario.parent().unwrap_or(Path::new(".")) };
        let folder = if folder == Path::new("") { Path::new(".") } else { folder };
        let root = git::line(folder, &["rev-parse", "--show-toplevel"])?;
        let prefix = git::line(folder, &["rev-parse", "--show-prefix"])?;
        Ok(Self { root: PathBuf::from(root), scenario: PathBuf::from(prefix) })
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
        let unknown = |_| Usage::new(format!("the repository has no commit `{name}`"), None);
        Ok(git::line(&self.root, &words).map_err(unknown)?)
    }

    /// The last commit that changed a file of the scenario; nothing if none has.
    ///
    /// # Errors
    /// Git does not say.
    pub fn last_change(&self, file: &Path) -> Result<Option<String>, RepositoryError> {
        let path = self.scenario.join(file);
        let words = ["rev-list", "--max-count=1", "HEAD", "--", &path.to_string_lossy()];
        let commit = git::line(&self.root, &words)?;
        Ok(Some(commit).filter(|commit| !commit.is_empty()))
    }

    /// The commits from `good` to `bad`, both included, by the first parent: the good one first.
    ///
    /// # Errors
    /// There is no such commit, or none after the good one.
    pub fn between(&self, good: &str, bad: &str) -> Result<Vec<String>, RepositoryError> {
        let (good, bad) = (self.commit(good)?, self.commit(bad)?);
        let range = format!("{good}..{bad}");
        let words = ["rev-list", "--first-parent", "--reverse", &range];
        let list = git::line(&self.root, &words)?;
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
        // Unlike `git show` it starts no program that looks at signatures.
        let words = ["rev-list", "--max-count=1", "--format=%H%n%an <%ae>%n%aI%n%s", commit];
        let text = git::line(&self.root, &words)?;
        // Behind `commit NAME`. A commit may have no subject, which is then no line.
        let mut lines = text.lines().skip(1).map(str::to_owned);
        Ok(std::array::from_fn(|_| lines.next().unwrap_or_default()))
    }

    /// Writes the files of a commit that are in `part` of the repository into `folder`, all of them where `part` is
    /// empty. The inner error says why it has no such files.
    ///
    /// # Errors
    /// Git cannot be started, or a file cannot be written.
    pub fn take_out(&self, commit: &str, part: &Path, folder: &Path) -> Result<Result<(), String>, RepositoryError> {
        file::create_folder(folder)?;
        match tree::take_out(&self.root, commit, part, folder) {
            Ok(()) => Ok(Ok(())),
            Err(NotTaken::Commit(why) | NotTaken::Git(git::Silent::Refused(why))) => Ok(Err(why)),
            Err(NotTaken::Git(silent)) => Err(silent.into()),
            Err(NotTaken::File(error)) => Err(error.into()),
        }
    }
}
