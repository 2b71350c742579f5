//! The folder of a recording while it is made, and an earlier recording in it that the new one replaces: that is set aside until
//! the new one is whole, so that a run that is cut short, or does not even begin, costs none.
//!
//! Whatever ends the process between two steps, the earlier recording is whole in one place: in its folder, aside, or on its way
//! between the two, which the next run there completes.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use onescan_base::disk::{Disk, growing, write_whole};
use onescan_base::notice::NOTICE;
use onescan_server::observer::RecordError;

use crate::csv::CSV;
use crate::event::{self, Event};
use crate::mcap::MCAP;
use crate::parquet::TRAJECTORY;
use crate::recorder::{EVENTS, HEADER};
use crate::sink::failed;

/// Name of the folder of a recording with the scenario's files.
pub const SCENARIO: &str = "scenario";
/// Name of the file of a recording that is written last: what came of the run.
pub const REPORT: &str = "run.json";

/// Where an earlier recording lies meanwhile, within the folder of the new one.
const ASIDE: &str = ".earlier";
/// The same while it is moved there, or back.
const ON_ITS_WAY: &str = ".earlier.partial";

/// What a recording consists of. What else lies in its folder is the user's, and stays there.
const PARTS: [&str; 7] = [HEADER, SCENARIO, TRAJECTORY, CSV, MCAP, EVENTS, REPORT];

/// The folder of a recording that is being made.
#[derive(Debug)]
pub struct Place {
    disk: Arc<dyn Disk>,
    folder: PathBuf,
    /// An earlier recording is aside.
    is_replacing: bool,
}

impl Place {
    /// Sets aside what the folder holds. Where an earlier run was cut short itself, the recording that it was to replace stays the
    /// earlier one.
    ///
    /// # Errors
    /// A file cannot be moved.
    pub fn begin(disk: Arc<dyn Disk>, folder: &Path) -> Result<Self, RecordError> {
        let mut place = Self { disk, folder: folder.to_owned(), is_replacing: false };
        place.is_replacing = place.set_aside().map_err(|error| {
            // What has been moved of it belongs to the rest.
            if let Err(again) = place.come_back() {
                place.report_stranded(&again);
            }
            failed(folder)(error)
        })?;
        Ok(place)
    }

    fn set_aside(&self) -> io::Result<bool> {
        let (aside, on_its_way) = (self.folder.join(ASIDE), self.folder.join(ON_ITS_WAY));
        self.come_back()?;
        let report = self.folder.join(REPORT);
        if aside.join(HEADER).exists() && !report.exists() {
            self.remove_parts()?;
            return Ok(true);
        }
        if aside.exists() {
            self.disk.remove_folder(&aside)?;
        }
        let is_there = self.folder.join(HEADER).exists();
        if is_there {
            self.disk.create_folder(&on_its_way)?;
            self.move_parts(&self.folder, &on_its_way)?;
            self.disk.rename(&on_its_way, &aside)?;
        } else if report.exists() {
            // What was left of something else would be taken for the new run's.
            self.disk.remove_file(&report)?;
        }
        Ok(is_there)
    }

    /// Gives what was on its way its places again.
    fn come_back(&self) -> io::Result<()> {
        let on_its_way = self.folder.join(ON_ITS_WAY);
        if on_its_way.exists() {
            self.move_parts(&on_its_way, &self.folder)?;
            self.disk.remove_folder(&on_its_way)?;
        }
        Ok(())
    }

    /// The run is over: adds what is known of it only now, and its report. From here on the recording is whole, and the earlier
    /// one is no longer needed.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn end(mut self, events: &[Event], report: &[u8]) -> Result<(), RecordError> {
        event::append(self.disk.as_ref(), &self.folder.join(EVENTS), events)?;
        let failed = failed(&self.folder);
        write_whole(self.disk.as_ref(), &self.folder.join(REPORT), report).map_err(&failed)?;
        if std::mem::take(&mut self.is_replacing) {
            self.disk.remove_folder(&self.folder.join(ASIDE)).map_err(&failed)?;
        }
        Ok(())
    }

    /// The new recording is not whole. Where it holds nothing, the earlier one takes its place again.
    fn stay(&self) -> io::Result<()> {
        let aside = self.folder.join(ASIDE);
        if self.folder.join(HEADER).exists() {
            tracing::info!(target: NOTICE, "the recording that was to be replaced is kept in {}", aside.display());
            return Ok(());
        }
        self.remove_parts()?;
        self.disk.rename(&aside, &self.folder.join(ON_ITS_WAY))?;
        self.come_back()
    }

    fn report_stranded(&self, error: &io::Error) {
        let place = [ASIDE, ON_ITS_WAY].map(|name| self.folder.join(name)).into_iter().find(|place| place.exists());
        let place = place.unwrap_or_else(|| self.folder.clone());
        let place = place.display();
        tracing::warn!(%error, "the recording that was to be replaced is in {place}, and comes back with the next run into this folder");
    }

    fn move_parts(&self, from: &Path, to: &Path) -> io::Result<()> {
        for part in PARTS.iter().filter(|part| from.join(part).symlink_metadata().is_ok()) {
            self.disk.rename(&from.join(part), &to.join(part))?;
        }
        Ok(())
    }

    fn remove_parts(&self) -> io::Result<()> {
        let parts = PARTS.map(|part| self.folder.join(part));
        for part in parts.iter().flat_map(|part| [part.clone(), growing(part)]) {
            // A link goes, and not what it leads to.
            match part.symlink_metadata() {
                Ok(found) if found.is_dir() => self.disk.remove_folder(&part)?,
                Ok(_) => self.disk.remove_file(&part)?,
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        if self.is_replacing
            && let Err(error) = self.stay()
        {
            self.report_stranded(&error);
        }
    }
}

/// Where the recording lies that was to be replaced by the one in `folder`, if it is still there.
pub fn kept_in(folder: &Path) -> Option<PathBuf> {
    Some(folder.join(ASIDE)).filter(|aside| aside.join(HEADER).exists())
}

#[cfg(test)]
mod tests {
    use onescan_base::disk::SystemDisk;

    use super::*;

    fn begin(folder: &Path) -> Place {
        Place::begin(Arc::new(SystemDisk), folder).unwrap()
    }

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
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path();
        write(folder, &WHOLE, "old");
        write(folder, &["notes.txt"], "mine");
        let place = begin(folder);
        assert!(!folder.join("trajectory.csv").exists() && !folder.join("scenario").exists());
        assert_eq!(
            (read(folder.join(ASIDE).join(REPORT)), read(folder.join("notes.txt"))),
            ("old".into(), "mine".into())
        );
        write(folder, &[HEADER], "new");
        place.end(&[], b"new").unwrap();
        assert_eq!((read(folder.join(REPORT)), kept_in(folder)), ("new".to_owned(), None));
        assert!(!folder.join(ASIDE).exists());
    }

    #[test]
    fn it_stays_as_long_as_the_other_is_cut_short() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path();
        write(folder, &WHOLE, "old");
        for _ in 0..2 {
            let place = begin(folder);
            write(folder, &[HEADER, EVENTS], "cut");
            drop(place);
            assert_eq!(read(kept_in(folder).unwrap().join(REPORT)), "old");
        }
        // One that holds nothing, as no session came about, takes no place.
        let place = begin(folder);
        write(folder, &["scenario/b.st"], "none");
        drop(place);
        assert_eq!((read(folder.join(REPORT)), folder.join("scenario/b.st").exists()), ("old".to_owned(), false));
        assert_eq!(kept_in(folder), None);
    }

    #[test]
    fn one_that_was_on_its_way_comes_back() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path();
        write(folder, &WHOLE[1..], "old");
        write(&folder.join(ON_ITS_WAY), &WHOLE[..1], "old");
        let place = begin(folder);
        assert_eq!(WHOLE.map(|part| read(folder.join(ASIDE).join(part))), ["old"; 5]);
        drop(place);
        assert_eq!(WHOLE.map(|part| read(folder.join(part))), ["old"; 5]);
    }

    #[test]
    fn one_that_was_on_its_way_back_comes_back() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path();
        write(folder, &WHOLE[..2], "old");
        write(&folder.join(ON_ITS_WAY), &WHOLE[2..], "old");
        drop(begin(folder));
        assert_eq!(WHOLE.map(|part| read(folder.join(part))), ["old"; 5]);
    }
}
