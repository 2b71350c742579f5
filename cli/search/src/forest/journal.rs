//! A journal of runs that are done, so that a search continues after whatever ended it.
//!
//! Each line is an object of JSON. It counts once its end is written: a process that is killed, or whose disk is full, leaves half
//! of one at most, which readers leave out.

use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use onescan_base::disk::SystemDisk;
use onescan_base::lines::{self, Lines};
use onescan_base::regular::{self, Limit};
use onescan_report::FileError;
use serde::Serialize;
use serde::de::DeserializeOwned;

use onescan_runner::error::{Unreadable, Usage, sum_of_errors};

sum_of_errors! {
    /// Why a journal cannot be used.
    pub enum JournalError {
        /// It is damaged, or another process works with it.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// It cannot be read.
        Unreadable(Unreadable),
        /// It cannot be written.
        File(FileError),
    }
}

/// A journal, locked as long as it is open.
pub(crate) struct Journal {
    path: PathBuf,
    /// The lock is the file's, and ends with it.
    lines: Mutex<Lines>,
}

impl Journal {
    /// Opens the journal of a search at `path`, and reads what stands in it.
    ///
    /// # Errors
    /// It cannot be used, has other lines, or another process works with it.
    pub(crate) fn open<L: DeserializeOwned>(path: PathBuf, search: &str) -> Result<(Self, Vec<L>), JournalError> {
        let options = OpenOptions::new().create(true).append(true).read(true).open(&path);
        let file = options.map_err(unusable(&path))?;
        if let Err(error) = file.try_lock() {
            let message = format!("{}: another process works on it ({error})", path.display());
            return Err(Usage::new(message, Some("wait for it, or use another folder".to_owned())).into());
        }
        let (done, whole_bytes) = whole_lines(&path, search)?;
        // Half a line at the end is what a process left that was killed while it wrote.
        file.set_len(whole_bytes).map_err(unusable(&path))?;
        Ok((Self { path, lines: Mutex::new(Lines::of(Box::new(file))) }, done))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a run that is done, as one line.
    ///
    /// # Errors
    /// The journal cannot be written.
    pub(crate) fn append(&self, line: &impl Serialize) -> Result<(), JournalError> {
        // A thread that panicked here left a whole value.
        let mut lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        push(&mut lines, &self.path, line)
    }
}

/// Adds a line to the journal at `path`, which another process has opened.
///
/// # Errors
/// The journal cannot be written.
pub(crate) fn append(path: &Path, line: &impl Serialize) -> Result<(), JournalError> {
    push(&mut Lines::append_to(&SystemDisk, path).map_err(unusable(path))?, path, line)
}

/// What stands in the journal of a search with which nobody works any more.
///
/// # Errors
/// There is none, or it has other lines.
pub(crate) fn read<L: DeserializeOwned>(path: &Path, search: &str) -> Result<Vec<L>, JournalError> {
    Ok(whole_lines(path, search)?.0)
}

fn push(lines: &mut Lines, path: &Path, line: &impl Serialize) -> Result<(), JournalError> {
    let text = serde_json::to_vec(line).map_err(|error| unusable(path)(error.into()))?;
    Ok(lines.push(&text).map_err(unusable(path))?)
}

fn unusable(path: &Path) -> impl FnOnce(std::io::Error) -> FileError + use<> {
    let path = path.to_owned();
    move |source| FileError { path, source }
}

/// The whole lines of a journal, and the bytes up to the end of the last.
fn whole_lines<L: DeserializeOwned>(path: &Path, search: &str) -> Result<(Vec<L>, u64), JournalError> {
    let bytes = regular::read(path, Limit::DATA).map_err(Unreadable::at(path))?;
    let mut done = Vec::new();
    for (place, line) in lines::whole(&bytes) {
        match serde_json::from_slice(line) {
            Ok(line) => done.push(line),
            // What a full disk took of a line: that run counts as not done.
            Err(cut) if cut.is_eof() => {}
            Err(error) => {
                tracing::debug!(%error, "not a line of a journal");
                let message = format!("{}:{}: not a line of a {search}'s journal", path.display(), place + 1);
                return Err(Usage::new(message, Some("remove the folder to begin again".to_owned())).into());
            }
        }
    }
    let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
    Ok((done, whole as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_line_is_cut_off_and_the_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let (journal, lines) = Journal::open::<u32>(path.clone(), "search").unwrap();
        assert!(lines.is_empty());
        journal.append(&1).unwrap();
        append(&path, &2).unwrap();
        let busy = Journal::open::<u32>(path.clone(), "search").map(drop).unwrap_err().to_string();
        assert!(busy.contains("another process works on it"), "{busy}");
        drop(journal);
        std::fs::write(&path, "1\n2\n\"thr").unwrap();
        let (journal, lines) = Journal::open::<u32>(path.clone(), "search").unwrap();
        journal.append(&4).unwrap();
        assert_eq!((lines, read::<u32>(&path, "search").unwrap()), (vec![1, 2], vec![1, 2, 4]));
        let wrong = read::<bool>(&path, "search").unwrap_err().to_string();
        assert!(wrong.contains("journal.jsonl:1: "), "{wrong}");
    }
}
