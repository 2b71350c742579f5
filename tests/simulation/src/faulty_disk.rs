//! A disk that refuses at any call, or a process that is killed there: what has been written until then is on the system's disk,
//! where the test looks at it.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_base::disk::{Disk, DiskFile, SystemDisk};

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The process ends within the call, and so do all that follow.
    Kill,
    /// One call is refused.
    Once(Refusal),
    /// All from this one on are refused that need room.
    Full,
}

/// Why a call is refused: an error number of the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refusal(pub i32);

/// Input or output error.
pub const EIO: Refusal = Refusal(5);
/// Too many open files.
pub const EMFILE: Refusal = Refusal(24);
/// No space left on the device.
pub const ENOSPC: Refusal = Refusal(28);

/// A folder of the system's disk, in which something goes wrong once.
#[derive(Clone, Debug)]
pub struct FaultyDisk(Arc<Mutex<State>>);

#[derive(Debug)]
struct State {
    folder: PathBuf,
    /// How many calls there have been.
    calls: u64,
    /// At which call, and what.
    fault: Option<(u64, Fault)>,
    /// Whether it has happened.
    is_faulty: bool,
    /// A path outside of the folder.
    outside: Option<PathBuf>,
    /// Of all calls.
    trace: blake3::Hasher,
}

/// What a call must do.
enum Verdict {
    Do,
    /// Only a part of it, and then it fails.
    Part(io::Error),
}

impl FaultyDisk {
    /// Nothing goes wrong if there is no fault.
    pub fn new(folder: &Path, fault: Option<(u64, Fault)>) -> Self {
        let (folder, trace) = (folder.to_owned(), blake3::Hasher::new());
        Self(Arc::new(Mutex::new(State { folder, calls: 0, fault, is_faulty: false, outside: None, trace })))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether something has gone wrong.
    pub fn is_faulty(&self) -> bool {
        self.state().is_faulty
    }

    /// Whether the process has been killed.
    pub fn is_killed(&self) -> bool {
        let state = self.state();
        state.is_faulty && matches!(state.fault, Some((_, Fault::Kill)))
    }

    /// How many calls there have been.
    pub fn calls(&self) -> u64 {
        self.state().calls
    }

    /// A path outside of the folder that was touched.
    pub fn outside(&self) -> Option<PathBuf> {
        self.state().outside.clone()
    }

    /// A hash of all calls, by their paths within the folder.
    pub fn trace(&self) -> u64 {
        let hash = self.state().trace.finalize();
        u64::from_le_bytes(hash.as_bytes()[..8].try_into().expect("eight bytes"))
    }

    fn call(&self, what: &str, path: &Path, needs_room: bool) -> Verdict {
        self.state().call(what, path, needs_room)
    }

    /// A call that is done as a whole or not at all.
    fn whole<T>(
        &self,
        what: &str,
        path: &Path,
        needs_room: bool,
        call: impl FnOnce() -> io::Result<T>,
    ) -> io::Result<T> {
        match self.call(what, path, needs_room) {
            Verdict::Do => call(),
            Verdict::Part(error) => Err(error),
        }
    }

    fn file(&self, path: &Path, inner: Box<dyn DiskFile>) -> Box<dyn DiskFile> {
        Box::new(FaultyFile { disk: self.clone(), path: path.to_owned(), inner })
    }
}

impl State {
    fn call(&mut self, what: &str, path: &Path, needs_room: bool) -> Verdict {
        match path.strip_prefix(&self.folder) {
            Ok(within) => {
                self.trace.update(what.as_bytes()).update(within.to_string_lossy().as_bytes());
            }
            Err(_) => self.outside = Some(path.to_owned()),
        }
        let number = self.calls;
        self.calls += 1;
        let Some((at, fault)) = self.fault else { return Verdict::Do };
        let refused = match fault {
            Fault::Kill if number >= at => io::Error::other("the process is killed"),
            Fault::Once(Refusal(number_of_error)) if number == at => io::Error::from_raw_os_error(number_of_error),
            Fault::Full if number >= at && needs_room => io::Error::from_raw_os_error(ENOSPC.0),
            _ => return Verdict::Do,
        };
        // What comes after a kill does nothing at all.
        let is_first = !std::mem::replace(&mut self.is_faulty, true);
        if is_first || fault != Fault::Kill { Verdict::Part(refused) } else { Verdict::Part(io::Error::other("")) }
    }
}

impl Disk for FaultyDisk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.whole("create_folder", path, true, || SystemDisk.create_folder(path))
    }

    fn create(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        let file = self.whole("create", path, true, || SystemDisk.create(path))?;
        Ok(self.file(path, file))
    }

    fn append(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        let file = self.whole("append", path, false, || SystemDisk.append(path))?;
        Ok(self.file(path, file))
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.whole("rename", from, false, || SystemDisk.rename(from, to))
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        self.whole("remove_file", path, false, || SystemDisk.remove_file(path))
    }

    /// What is in it goes one by one, in the order of names.
    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        let mut inside: Vec<PathBuf> =
            std::fs::read_dir(path)?.map(|entry| entry.map(|entry| entry.path())).collect::<io::Result<_>>()?;
        inside.sort();
        for each in inside {
            if each.is_dir() { self.remove_folder(&each)? } else { self.remove_file(&each)? }
        }
        self.whole("remove_folder", path, false, || std::fs::remove_dir(path))
    }
}

#[derive(Debug)]
struct FaultyFile {
    disk: FaultyDisk,
    path: PathBuf,
    inner: Box<dyn DiskFile>,
}

impl Write for FaultyFile {
    /// Takes less than it is given now and then, as a file may.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let was_dead = self.disk.is_killed();
        match self.disk.call("write", &self.path, true) {
            Verdict::Do if self.disk.calls().is_multiple_of(5) => self.inner.write(&bytes[..bytes.len().div_ceil(2)]),
            Verdict::Do => self.inner.write(bytes),
            Verdict::Part(error) => {
                // Some of it may be on the disk all the same.
                if !was_dead {
                    self.inner.write_all(&bytes[..bytes.len() / 2])?;
                }
                Err(error)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl Read for FaultyFile {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.inner.read(into)
    }
}

impl Seek for FaultyFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}
