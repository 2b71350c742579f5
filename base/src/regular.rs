//! Files as they are read everywhere: regular ones only, and no more of them than anybody needs.
//!
//! A scenario may name any path. A device has no end, a pipe may have no writer, a text of gigabytes is a mistake: each
//! is refused at once, with its reason.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

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
    let file = File::open(path)?;
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

/// All that is in a file.
///
/// # Errors
/// As [`open`], or it is larger than `limit`.
pub fn read(path: &Path, limit: Limit) -> Result<Vec<u8>> {
    let file = open(path)?;
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
/// As [`read`] with [`Limit::TEXT`], or it is no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    String::from_utf8(read(path, Limit::TEXT)?)
        .map_err(|_| Error::new(ErrorKind::InvalidData, "stream did not contain valid UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(path: &str) -> String {
        read(Path::new(path), Limit::TEXT).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_file_is_refused() {
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
}
