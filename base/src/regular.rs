//! Files as they are read everywhere: regular ones only, and no more of them than anybody needs.
//!
//! A scenario may name any path. A device has no end, a pipe may have no writer, a text of gigabytes is a mistake: each
//! is refused at once, with its reason.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Path, PathBuf};

/// How much of a file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    mib: u64,
}

impl Limit {
    /// What people write and tools export: scenarios, scenes, sources, lists, snapshots.
    pub const TEXT: Self = Self { mib: 64 };
    /// What programs write: checkpoints, meshes, events of a recording.
    pub const DATA: Self = Self { mib: 1024 };

    fn bytes(self) -> u64 {
        self.mib << 20
    }

    fn exceeded(self) -> Error {
        Error::new(ErrorKind::FileTooLarge, format!("it is larger than {} MiB, which is the limit", self.mib))
    }
}

/// Opens a regular file to be read.
///
/// # Errors
/// It cannot be opened, or is a folder, a device or a pipe.
pub fn open(path: &Path) -> Result<File> {
    // A pipe without a writer would not open; so its kind is looked at before, and once more behind a swap.
    regular(&std::fs::metadata(path)?)?;
    checked(File::open(path)?)
}

/// An open file, if it is a regular one.
fn checked(file: File) -> Result<File> {
    regular(&file.metadata()?)?;
    Ok(file)
}

fn regular(found: &std::fs::Metadata) -> Result<()> {
    if found.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder, not a file"));
    }
    if !found.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "it is a device or a pipe, not a file"));
    }
    Ok(())
}

/// Opens a regular file where it was found, at a path without links: one that has come onto the way since then is refused, so
/// that nothing that is swapped between the look and the open leads elsewhere.
#[cfg(target_os = "linux")]
fn open_found(real: &Path) -> Result<File> {
    use rustix::fs::{CWD, Mode, OFlags, ResolveFlags, openat2};
    use rustix::io::Errno;

    // A pipe without a writer would not open otherwise; for a file it means nothing.
    let flags = OFlags::RDONLY | OFlags::CLOEXEC | OFlags::NOCTTY | OFlags::NONBLOCK;
    match openat2(CWD, real, flags, Mode::empty(), ResolveFlags::NO_SYMLINKS) {
        Ok(opened) => checked(File::from(opened)),
        Err(Errno::LOOP) => {
            Err(Error::new(ErrorKind::PermissionDenied, "it was swapped for a link while it was looked for"))
        }
        // A kernel before 5.6, or a sandbox that knows no such call.
        Err(Errno::NOSYS | Errno::PERM | Errno::INVAL) => open(real),
        Err(error) => Err(error.into()),
    }
}

/// The same without that promise: see `docs/decisions/019-what-is-found-is-what-is-opened.md`.
#[cfg(not(target_os = "linux"))]
fn open_found(real: &Path) -> Result<File> {
    open(real)
}

/// All that is in a file.
///
/// # Errors
/// As [`open`], or it is larger than `limit`.
pub fn read(path: &Path, limit: Limit) -> Result<Vec<u8>> {
    read_open(open(path)?, limit)
}

fn read_open(file: File, limit: Limit) -> Result<Vec<u8>> {
    let size = file.metadata()?.len();
    if size > limit.bytes() {
        return Err(limit.exceeded());
    }
    let mut bytes = Vec::with_capacity(size as usize);
    // It may grow while it is read.
    file.take(limit.bytes() + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit.bytes() { Err(limit.exceeded()) } else { Ok(bytes) }
}

/// All that is in a file of text.
///
/// # Errors
/// As [`read`] with [`Limit::TEXT`], or it is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    text(read(path, Limit::TEXT)?)
}

fn text(bytes: Vec<u8>) -> Result<String> {
    String::from_utf8(bytes).map_err(|_| Error::new(ErrorKind::InvalidData, "stream did not contain valid UTF-8"))
}

/// The folders and files that may be read, wherever links lead: what is found elsewhere is not opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Within {
    places: Option<Vec<PathBuf>>,
}

impl Within {
    /// Everything: for files that the user names, not another file.
    pub fn anywhere() -> Self {
        Self::default()
    }

    /// These folders with all that is in them, and these files; an empty path is the folder in which the program runs.
    pub fn places(places: Vec<PathBuf>) -> Self {
        Self { places: Some(places) }
    }

    /// Where `path` is, without links.
    ///
    /// # Errors
    /// It is not there, or it lies elsewhere, which the error names.
    pub fn find(&self, path: &Path) -> std::result::Result<PathBuf, NotWithin> {
        let real = path.canonicalize().map_err(NotWithin::Missing)?;
        let Some(places) = &self.places else { return Ok(real) };
        let holds = |place: &PathBuf| {
            let place = if place.as_os_str().is_empty() { Path::new(".") } else { place };
            place.canonicalize().is_ok_and(|place| real.starts_with(place))
        };
        if places.iter().any(holds) { Ok(real) } else { Err(NotWithin::Elsewhere(real)) }
    }

    /// As [`read`]. What was found to lie within is what is read: a link that is put there meanwhile is refused (on Linux).
    ///
    /// # Errors
    /// As [`read`], or the file lies elsewhere.
    pub fn read(&self, path: &Path, limit: Limit) -> Result<Vec<u8>> {
        let real = self.find(path)?;
        let file = if self.places.is_some() { open_found(&real)? } else { open(&real)? };
        read_open(file, limit)
    }

    /// As [`read_text`].
    ///
    /// # Errors
    /// As [`read_text`], or the file lies elsewhere.
    pub fn read_text(&self, path: &Path) -> Result<String> {
        text(self.read(path, Limit::TEXT)?)
    }
}

/// Why a file is not within what may be read.
#[derive(Debug)]
pub enum NotWithin {
    /// It is not there, or cannot be looked for.
    Missing(Error),
    /// It is at this path, which is outside.
    Elsewhere(PathBuf),
}

impl From<NotWithin> for Error {
    fn from(not: NotWithin) -> Self {
        match not {
            NotWithin::Missing(error) => error,
            NotWithin::Elsewhere(real) => {
                let text =
                    format!("it is {}, outside of the scenario's folder; `--allow-path` allows more", real.display());
                Self::new(ErrorKind::PermissionDenied, text)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(path: &str) -> String {
        read(Path::new(path), Limit::TEXT).unwrap_err().to_string()
    }

    #[test]
    fn what_is_not_a_file_is_refused() {
        assert_eq!(refused(env!("CARGO_MANIFEST_DIR")), "it is a folder, not a file");
        assert!(read_text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap().contains("onescan-base"));
    }

    #[cfg(unix)]
    #[test]
    fn what_has_no_end_is_refused() {
        assert_eq!(refused("/dev/zero"), "it is a device or a pipe, not a file");
    }

    #[test]
    fn what_is_too_large_is_refused() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let error = read(&path, Limit { mib: 0 }).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
    }

    /// What somebody may do between the look and the open. A plain open would read the other file both times.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_is_swapped_for_a_link_is_not_read() {
        use std::os::unix::fs::symlink;

        let place = std::env::temp_dir().join(format!("onescan-below-{}", std::process::id()));
        let (own, other) = (place.join("own"), place.join("other"));
        for folder in [&own, &other] {
            std::fs::create_dir_all(folder.join("plc")).unwrap();
            std::fs::write(folder.join("plc/a.st"), folder.file_name().unwrap().to_str().unwrap()).unwrap();
        }
        let bounds = Within::places(vec![own.clone()]);
        let found = bounds.find(&own.join("plc/a.st")).unwrap();
        assert_eq!(bounds.read_text(&own.join("plc/a.st")).unwrap(), "own");
        assert!(open_found(&found).is_ok());
        // The folder, and then the file.
        std::fs::rename(own.join("plc"), own.join("was")).unwrap();
        symlink(other.join("plc"), own.join("plc")).unwrap();
        let swapped = |what: &str| {
            assert_eq!(std::fs::read_to_string(&found).unwrap(), "other", "{what}: the window");
            let refused = open_found(&found).unwrap_err().to_string();
            assert_eq!(refused, "it was swapped for a link while it was looked for", "{what}");
            assert!(bounds.read(&own.join("plc/a.st"), Limit::TEXT).is_err(), "{what}: a new look finds it elsewhere");
        };
        swapped("the folder");
        std::fs::remove_file(own.join("plc")).unwrap();
        std::fs::create_dir(own.join("plc")).unwrap();
        symlink(other.join("plc/a.st"), own.join("plc/a.st")).unwrap();
        swapped("the file");
        std::fs::remove_dir_all(place).unwrap();
    }
}
