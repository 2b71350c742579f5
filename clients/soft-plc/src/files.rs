//! Files that the program of a PLC finds: put into the variables of `OnescanFiles`, in
//! `plc-shim/iec/library/vendor/codesys_sysfile.st`, at the set-up.
//!
//! From then on they are memory of the PLC: part of its state, and never the machine's.

use onescan_iec_run::{Application, SoftPlc, WriteError};
use thiserror::Error;

/// Files that there can be: the length of `OnescanFiles`.
const COUNT: usize = 8;

/// A file at its place in the PLC's memory.
#[derive(Clone, Debug)]
pub(super) struct PlcFile {
    /// Paths of what is said of it, with literals.
    parameters: Vec<(String, String)>,
    at: usize,
    bytes: Vec<u8>,
}

/// Why a PLC cannot have files.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FileError {
    /// Nothing of the program works with files.
    #[error("the program has no block or function that opens files")]
    NoBlock,
    /// More than there is room for.
    #[error("{0} files are too many: a PLC has at most {most}", most = COUNT)]
    Many(usize),
    /// One that is too long.
    #[error("file `{name}` has {bytes} bytes, and a PLC has room for {room}")]
    Long {
        name: String,
        bytes: usize,
        /// What there is room for.
        room: usize,
    },
    /// A name that no program can write.
    #[error("file `{0}`: its name has characters other than letters, digits and ` ._-/\\:`")]
    Name(String),
}

/// The files of a PLC with this memory, each with its name, in the order of their places.
pub fn files_in(application: &Application, memory: &[u8]) -> Vec<(String, Vec<u8>)> {
    let file = |index: usize| {
        let bytes = |member: &str| {
            let found = application.variable(&format!("OnescanFiles[{index}].{member}")).ok()?;
            let start = found.offset as usize;
            Some((memory.get(start..start + found.size as usize)?, found))
        };
        let (used, _) = bytes("used")?;
        let (size, _) = bytes("size")?;
        let size = u32::from_le_bytes(size.try_into().ok()?) as usize;
        let (name, of_name) = bytes("name")?;
        let name = if of_name.zero_terminated.is_some() {
            name.split(|byte| *byte == 0).next()?
        } else {
            let (length, text) = name.split_first_chunk::<2>()?;
            text.get(..usize::from(u16::from_le_bytes(*length)))?
        };
        let (all, _) = bytes("bytes")?;
        let content = all.get(..size)?.to_vec();
        (used.first() == Some(&1)).then(|| (name.iter().copied().map(char::from).collect(), content))
    };
    (0..COUNT).filter_map(file).collect()
}

impl PlcFile {
    /// Whether a program has files at all.
    pub(super) fn are_in(application: &Application) -> bool {
        application.variable("OnescanFiles[0].used").is_ok()
    }

    pub(super) fn all(application: &Application, files: Vec<(String, Vec<u8>)>) -> Result<Vec<Self>, FileError> {
        if files.len() > COUNT {
            return Err(FileError::Many(files.len()));
        }
        let place = |(index, (name, bytes)): (usize, (String, Vec<u8>))| {
            let path = |member: &str| format!("OnescanFiles[{index}].{member}");
            let room = application.variable(&path("bytes")).map_err(|_| FileError::NoBlock)?;
            if bytes.len() > room.size as usize {
                return Err(FileError::Long { name, bytes: bytes.len(), room: room.size as usize });
            }
            if !name.chars().all(|each| each.is_ascii_alphanumeric() || " ._-/\\:".contains(each)) {
                return Err(FileError::Name(name));
            }
            let parameters = [
                (path("used"), "TRUE".to_owned()),
                (path("name"), format!("'{name}'")),
                (path("size"), bytes.len().to_string()),
            ];
            Ok(Self { parameters: parameters.to_vec(), at: room.offset as usize, bytes })
        };
        files.into_iter().enumerate().map(place).collect()
    }

    pub(super) fn put(&self, plc: &mut SoftPlc) -> Result<(), WriteError> {
        self.parameters.iter().try_for_each(|(path, literal)| plc.write(path, literal))?;
        if let Some(place) = plc.memory_mut().get_mut(self.at..self.at + self.bytes.len()) {
            place.copy_from_slice(&self.bytes);
        }
        Ok(())
    }
}
