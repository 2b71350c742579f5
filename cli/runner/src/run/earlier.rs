//! An earlier recording that another one replaces: it is set aside until the other is whole, so that a run that is cut short, or
//! does not even begin, costs none.

use std::path::{Path, PathBuf};

use onescan_base::notice::NOTICE;
use onescan_recording::recorder::{EVENTS, HEADER};
use onescan_report::FileError;

/// Name of the folder of a recording with the scenario's files.
pub(super) const SCENARIO: &str = "scenario";
/// Name of the file of a recording that is written last.
pub(super) const REPORT: &str = "run.json";

/// Where it lies meanwhile, within the folder of the other one.
const ASIDE: &str = ".earlier";
/// The same while it is moved there.
const ON_ITS_WAY: &str = ".earlier.partial";

/// What a recording consists of. What else lies in its folder is the user's, and stays there.
const PARTS: [&str; 7] = [HEADER, SCENARIO, "trajectory", "trajectory.csv", "trajectory.mcap", EVENTS, REPORT];

/// The earlier recording of a folder that another run records into, if there is one.
#[derive(Debug)]
pub(super) struct Earlier {
    folder: PathBuf,
    is_there: bool,
}

impl Earlier {
    /// Sets aside what the folder holds. Where an earlier run was cut short itself, the one that it was to replace stays the
    /// earlier one.
    ///
    /// # Errors
    /// A file cannot be moved.
    pub(super) fn set_aside(folder: &Path) -> Result<Self, FileError> {
        let (aside, on_its_way) = (folder.join(ASIDE), folder.join(ON_ITS_WAY));
        if on_its_way.exists() {
            move_parts(&on_its_way, folder)?;
            remove_folder(&on_its_way)?;
        }
        let was_cut = !folder.join(REPORT).exists();
        if aside.join(HEADER).exists() && was_cut {
            remove_parts(folder)?;
            return Ok(Self { folder: folder.to_owned(), is_there: true });
        }
        if aside.exists() {
            remove_folder(&aside)?;
        }
        let is_there = folder.join(HEADER).exists();
        if is_there {
            std::fs::create_dir(&on_its_way).map_err(at(&on_its_way))?;
            move_parts(folder, &on_its_way)?;
            std::fs::rename(&on_its_way, &aside).map_err(at(&on_its_way))?;
        }
        Ok(Self { folder: folder.to_owned(), is_there })
    }

    /// The other recording is whole: this one is no longer needed.
    ///
    /// # Errors
    /// It cannot be removed.
    pub(super) fn discard(&mut self) -> Result<(), FileError> {
        if std::mem::take(&mut self.is_there) { remove_folder(&self.folder.join(ASIDE)) } else { Ok(()) }
    }

    /// The other recording is not whole. Where it holds nothing, this one takes its place again.
    fn stay(&self) -> Result<(), FileError> {
        let aside = self.folder.join(ASIDE);
        if self.folder.join(HEADER).exists() {
            tracing::info!(target: NOTICE, "the recording that was to be replaced is kept in {}", aside.display());
            return Ok(());
        }
        remove_parts(&self.folder)?;
        move_parts(&aside, &self.folder)?;
        remove_folder(&aside)
    }
}

impl Drop for Earlier {
    fn drop(&mut self) {
        if self.is_there
            && let Err(error) = self.stay()
        {
            tracing::warn!(%error, "the recording that was to be replaced is kept in {ASIDE}");
        }
    }
}

/// Where the recording lies that was to be replaced by the one in `folder`, if it is still there.
pub(super) fn kept_in(folder: &Path) -> Option<PathBuf> {
    Some(folder.join(ASIDE)).filter(|aside| aside.join(HEADER).exists())
}

fn at(path: &Path) -> impl FnOnce(std::io::Error) -> FileError + use<> {
    let path = path.to_owned();
    move |source| FileError { path, source }
}

fn move_parts(from: &Path, to: &Path) -> Result<(), FileError> {
    for part in PARTS.map(|part| from.join(part)).iter().filter(|part| part.symlink_metadata().is_ok()) {
        let Some(name) = part.file_name() else { continue };
        std::fs::rename(part, to.join(name)).map_err(at(part))?;
    }
    Ok(())
}

fn remove_parts(folder: &Path) -> Result<(), FileError> {
    for part in PARTS.map(|part| folder.join(part)) {
        // A link goes, and not what it leads to.
        match part.symlink_metadata() {
            Ok(found) if found.is_dir() => remove_folder(&part)?,
            Ok(_) => std::fs::remove_file(&part).map_err(at(&part))?,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(at(&part)(error)),
        }
    }
    Ok(())
}

fn remove_folder(folder: &Path) -> Result<(), FileError> {
    std::fs::remove_dir_all(folder).map_err(at(folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, parts: &[&str], text: &str) {
        for part in parts {
            let path = folder.join(part);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
    }

    fn read(path: PathBuf) -> String {
        std::fs::read_to_string(path).unwrap()
    }

    const WHOLE: [&str; 5] = [HEADER, REPORT, EVENTS, "trajectory.csv", "scenario/a.st"];

    #[test]
    fn a_recording_that_is_replaced_goes_when_the_other_is_whole() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        write(folder, &WHOLE, "old");
        write(folder, &["notes.txt"], "mine");
        let mut earlier = Earlier::set_aside(folder).unwrap();
        assert!(!folder.join("trajectory.csv").exists() && !folder.join("scenario").exists());
        assert_eq!(
            (read(folder.join(ASIDE).join(REPORT)), read(folder.join("notes.txt"))),
            ("old".into(), "mine".into())
        );
        write(folder, &[HEADER, REPORT], "new");
        earlier.discard().unwrap();
        drop(earlier);
        assert_eq!((read(folder.join(HEADER)), kept_in(folder)), ("new".to_owned(), None));
        assert!(!folder.join(ASIDE).exists());
    }

    #[test]
    fn it_stays_as_long_as_the_other_is_cut_short() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        write(folder, &WHOLE, "old");
        for _ in 0..2 {
            let earlier = Earlier::set_aside(folder).unwrap();
            write(folder, &[HEADER, EVENTS], "cut");
            drop(earlier);
            assert_eq!(read(kept_in(folder).unwrap().join(REPORT)), "old");
        }
        // One that holds nothing, as no session came about, takes no place.
        let earlier = Earlier::set_aside(folder).unwrap();
        write(folder, &["scenario/b.st"], "none");
        drop(earlier);
        assert_eq!((read(folder.join(REPORT)), folder.join("scenario/b.st").exists()), ("old".to_owned(), false));
        assert_eq!(kept_in(folder), None);
    }

    #[test]
    fn one_that_was_on_its_way_comes_back() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        write(folder, &WHOLE[1..], "old");
        write(&folder.join(ON_ITS_WAY), &WHOLE[..1], "old");
        let earlier = Earlier::set_aside(folder).unwrap();
        assert_eq!(WHOLE.map(|part| read(folder.join(ASIDE).join(part))), ["old"; 5]);
        drop(earlier);
        assert_eq!(WHOLE.map(|part| read(folder.join(part))), ["old"; 5]);
    }
}
