//! Git, asked in a folder that may be a stranger's.
//!
//! A repository's own configuration and attributes name programs: filters, hooks, a file system monitor, pagers, programs
//! that show signatures, transports that fetch what is missing. So git is asked with commands that read objects alone
//! ("plumbing"), which start none of these, and sees nothing of the user's environment but where programs are. A folder
//! that is itself a bare repository, made of plain files, is not one for us.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use onescan_runner::error::Usage;

use super::RepositoryError;

/// Variables without which git does not start: where programs and libraries are, and what Windows needs.
const KEPT: [&str; 7] = ["PATH", "LD_LIBRARY_PATH", "TMPDIR", "TEMP", "TMP", "SYSTEMROOT", "SystemRoot"];

/// What git is asked before anything else.
const SETTINGS: [&str; 14] = [
    "-c",
    "safe.bareRepository=explicit",
    // Whose folder it is does not matter where nothing in it is started; containers often run as somebody else.
    "-c",
    "safe.directory=*",
    "-c",
    "core.fsmonitor=false",
    "-c",
    "core.hooksPath=/dev/null",
    "-c",
    "protocol.allow=never",
    "--no-pager",
    "--no-optional-locks",
    "--no-replace-objects",
    "--literal-pathspecs",
];

/// Settings of the environment, which go before those of a repository.
const VARIABLES: [(&str, &str); 8] = [
    ("LC_ALL", "C"),
    ("GIT_CONFIG_NOSYSTEM", "1"),
    ("GIT_CONFIG_GLOBAL", if cfg!(windows) { "NUL" } else { "/dev/null" }),
    ("GIT_ATTR_NOSYSTEM", "1"),
    ("GIT_TERMINAL_PROMPT", "0"),
    // What is not here is not fetched: by this setting from git 2.44 on, by the next one before.
    ("GIT_NO_LAZY_FETCH", "1"),
    ("GIT_ALLOW_PROTOCOL", "none"),
    ("GIT_OPTIONAL_LOCKS", "0"),
];

/// Why git does not answer.
#[derive(Debug)]
pub(super) enum Silent {
    /// It cannot be started.
    NotStarted(std::io::Error),
    /// It says why not.
    Refused(String),
}

impl From<Silent> for RepositoryError {
    fn from(silent: Silent) -> Self {
        let usage = match silent {
            Silent::NotStarted(source) => {
                Usage::new(format!("cannot start `git`: {source}"), Some("this needs git".to_owned()))
            }
            Silent::Refused(said) => Usage::new(format!("git: {said}"), None),
        };
        usage.into()
    }
}

fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new("git");
    command.current_dir(folder).args(SETTINGS).args(words).env_clear();
    command.envs(KEPT.iter().filter_map(|name| Some((name, std::env::var_os(name)?)))).envs(VARIABLES);
    command
}

/// What git writes to its standard output, as bytes.
pub(super) fn ask(folder: &Path, words: &[&str]) -> Result<Vec<u8>, Silent> {
    let output = command(folder, words).stdin(Stdio::null()).output().map_err(Silent::NotStarted)?;
    if output.status.success() {
        return Ok(output.stdout);
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let line = said.lines().next().unwrap_or("it does not say why").trim_start_matches("fatal: ").to_owned();
    Err(Silent::Refused(line))
}

/// The same, as a line.
pub(super) fn line(folder: &Path, words: &[&str]) -> Result<String, Silent> {
    let said = ask(folder, words)?;
    Ok(String::from_utf8_lossy(&said).trim_end().to_owned())
}

/// Objects of a repository, by their names.
pub(super) struct Objects {
    git: Child,
    wanted: Option<ChildStdin>,
    given: BufReader<ChildStdout>,
}

impl Objects {
    pub(super) fn of(folder: &Path) -> Result<Self, Silent> {
        let mut command = command(folder, &["cat-file", "--batch"]);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut git = command.spawn().map_err(Silent::NotStarted)?;
        let (Some(wanted), Some(given)) = (git.stdin.take(), git.stdout.take()) else {
            return Err(Silent::NotStarted(std::io::Error::other("it has no pipes")));
        };
        Ok(Self { git, wanted: Some(wanted), given: BufReader::new(given) })
    }

    /// The bytes of an object.
    ///
    /// # Errors
    /// There is no such object, or git has ended.
    pub(super) fn read(&mut self, name: &str) -> std::io::Result<Vec<u8>> {
        let gone = || std::io::Error::other("git has ended");
        let wanted = self.wanted.as_mut().ok_or_else(gone)?;
        wanted.write_all(format!("{name}\n").as_bytes())?;
        wanted.flush()?;
        let mut head = String::new();
        self.given.read_line(&mut head)?;
        // `NAME KIND SIZE`, or `NAME missing`.
        let size = head.trim_end().rsplit(' ').next().and_then(|size| size.parse::<u64>().ok());
        let Some(size) = size else {
            return Err(std::io::Error::other(format!("git: {}", head.trim_end())));
        };
        let mut bytes = Vec::new();
        self.given.by_ref().take(size).read_to_end(&mut bytes)?;
        let mut end = [0];
        self.given.read_exact(&mut end)?;
        if bytes.len() as u64 == size && end == *b"\n" { Ok(bytes) } else { Err(gone()) }
    }
}

impl Drop for Objects {
    fn drop(&mut self) {
        // It ends when nobody asks any more; what it says then is of no use.
        self.wanted = None;
        self.git.wait().ok();
    }
}
