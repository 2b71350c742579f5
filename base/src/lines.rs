//! Files of lines that grow at their end, one call a line: whatever ends a process leaves whole lines, and half a line at most.
//!
//! A disk without room may take half a line and then refuse the rest. So whoever adds one looks whether the last is whole, and
//! begins a new line otherwise; whoever reads gets half lines as such, and knows what to make of them.

use std::io::{Result, SeekFrom};
use std::path::Path;

use crate::disk::{Disk, DiskFile};

/// A file of lines that is open to grow. Several processes may add to one at a time.
#[derive(Debug)]
pub struct Lines {
    file: Box<dyn DiskFile>,
}

impl Lines {
    /// Begins an empty file.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn create(disk: &dyn Disk, path: &Path) -> Result<Self> {
        // Opened to append, as others may add to it meanwhile.
        drop(disk.create(path)?);
        Self::append_to(disk, path)
    }

    /// Goes on with a file, or begins it.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn append_to(disk: &dyn Disk, path: &Path) -> Result<Self> {
        Ok(Self::of(disk.append(path)?))
    }

    /// Goes on with a file that is open to be read and appended to.
    #[must_use]
    pub fn of(file: Box<dyn DiskFile>) -> Self {
        Self { file }
    }

    /// Adds a line, given without its end, in one call.
    ///
    /// # Errors
    /// The file cannot be written. What of the line is on the disk then is not a whole line.
    pub fn push(&mut self, line: &[u8]) -> Result<()> {
        debug_assert!(!line.contains(&b'\n'), "a line has no end within");
        let mut bytes = Vec::new();
        if self.ends_within_a_line()? {
            bytes.push(b'\n');
        }
        bytes.extend_from_slice(line);
        bytes.push(b'\n');
        self.file.write_all(&bytes)
    }

    fn ends_within_a_line(&mut self) -> Result<bool> {
        if self.file.seek(SeekFrom::End(0))? == 0 {
            return Ok(false);
        }
        let mut last = [0];
        self.file.seek(SeekFrom::End(-1))?;
        self.file.read_exact(&mut last)?;
        Ok(last != *b"\n")
    }
}

/// The lines in `bytes` without their ends, from 0 by their place in the file. Half a line at the end is left out, and so is one
/// with nothing in it: a process that looks while another one writes takes that line for half of one.
pub fn whole(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let lines = bytes.split_inclusive(|byte| *byte == b'\n').enumerate();
    let whole = lines.filter_map(|(place, line)| Some((place, line.strip_suffix(b"\n")?)));
    whole.filter(|(_, line)| !line.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::SystemDisk;

    #[test]
    fn a_line_after_half_a_line_is_whole() {
        let folder = std::env::temp_dir().join(format!("onescan-lines-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("lines");
        let mut first = Lines::create(&SystemDisk, &path).unwrap();
        first.push(b"one").unwrap();
        std::fs::write(&path, b"one\ntw").unwrap();
        Lines::append_to(&SystemDisk, &path).unwrap().push(b"three").unwrap();
        first.push(b"four").unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let lines: Vec<_> = whole(&bytes).map(|(place, line)| (place, std::str::from_utf8(line).unwrap())).collect();
        assert_eq!(lines, [(0, "one"), (1, "tw"), (2, "three"), (3, "four")]);
        assert_eq!(whole(b"five\nsi").count(), 1);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
