//! The files of a commit, written into a folder of our own.

use std::io;
use std::path::{Component, Path, PathBuf};

use onescan_report::FileError;

use super::git::{self, Objects, Silent};

/// What stands in a commit.
struct Entry {
    kind: Kind,
    object: String,
    path: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    File,
    Program,
    Link,
}

/// Why the files of a commit are not there.
#[derive(Debug)]
pub(super) enum NotTaken {
    Git(Silent),
    /// Its list or one of its objects is not what it should be.
    Commit(String),
    File(FileError),
}

impl From<Silent> for NotTaken {
    fn from(silent: Silent) -> Self {
        Self::Git(silent)
    }
}

/// Writes the files of `commit` in `part` into `folder`.
pub(super) fn take_out(root: &Path, commit: &str, part: &Path, folder: &Path) -> Result<(), NotTaken> {
    let mut words = vec!["ls-tree", "-r", "-z", "--full-tree", commit];
    let part = part.to_string_lossy();
    // A folder is listed by what is in it.
    let part = part.trim_end_matches('/');
    words.extend((!part.is_empty()).then_some(part));
    let list = git::ask(root, &words)?;
    let entries = list.split(|byte| *byte == 0).filter(|line| !line.is_empty()).map(entry);
    let entries: Vec<Entry> =
        entries.filter_map(Result::transpose).collect::<Result<_, _>>().map_err(NotTaken::Commit)?;
    if entries.is_empty() {
        return Err(NotTaken::Commit("it has no such files".to_owned()));
    }
    let mut objects = Objects::of(root)?;
    // Links last: nothing is written through one.
    let (links, files): (Vec<_>, Vec<_>) = entries.into_iter().partition(|entry| entry.kind == Kind::Link);
    for entry in files.iter().chain(&links) {
        let bytes = objects.read(&entry.object).map_err(|source| NotTaken::Commit(source.to_string()))?;
        let path = folder.join(&entry.path);
        write(&path, entry, &bytes).map_err(|source| NotTaken::File(FileError { path, source }))?;
    }
    Ok(())
}

/// `100644 blob NAME<tab>PATH`; nothing for a repository in this one.
fn entry(line: &[u8]) -> Result<Option<Entry>, String> {
    let shown = || format!("git lists `{}`", String::from_utf8_lossy(line));
    let (head, path) = line.split_at(line.iter().position(|byte| *byte == b'\t').ok_or_else(shown)?);
    let head = String::from_utf8_lossy(head);
    let mut words = head.split(' ');
    let (Some(mode), Some("blob" | "commit"), Some(object)) = (words.next(), words.next(), words.next()) else {
        return Err(shown());
    };
    let kind = match mode {
        "100755" => Kind::Program,
        "120000" => Kind::Link,
        "160000" => return Ok(None),
        _ => Kind::File,
    };
    let path = path_of(&path[1..]).ok_or_else(shown)?;
    // A commit that was made by hand may have any name in it.
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    is_inside.then_some(Some(Entry { kind, object: object.to_owned(), path })).ok_or_else(shown)
}

#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "elsewhere names are text")]
fn path_of(bytes: &[u8]) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt as _;

    Some(PathBuf::from(std::ffi::OsStr::from_bytes(bytes)))
}

#[cfg(not(unix))]
fn path_of(bytes: &[u8]) -> Option<PathBuf> {
    std::str::from_utf8(bytes).ok().map(PathBuf::from)
}

fn write(path: &Path, entry: &Entry, bytes: &[u8]) -> io::Result<()> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent)?;
    }
    match entry.kind {
        Kind::File => write_new(path, bytes),
        Kind::Program => write_new(path, bytes).and_then(|()| make_program(path)),
        Kind::Link => link(path, &entry.path, bytes),
    }
}

/// A file that is not there yet: a commit made by hand may name one twice.
fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = std::fs::File::options().write(true).create_new(true).open(path)?;
    io::Write::write_all(&mut file, bytes)
}

#[cfg(unix)]
fn make_program(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;

    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))
}

#[cfg(not(unix))]
fn make_program(_path: &Path) -> io::Result<()> {
    Ok(())
}

/// A link to what is in the commit, too; one that leads out of it is left out.
#[cfg(unix)]
fn link(path: &Path, inside: &Path, target: &[u8]) -> io::Result<()> {
    let Some(target) = path_of(target) else { return Ok(()) };
    let mut depth = inside.components().count() as i64 - 1;
    for part in target.components() {
        match part {
            Component::Normal(_) => depth += 1,
            Component::ParentDir => depth -= 1,
            Component::CurDir => {}
            Component::RootDir | Component::Prefix(_) => return Ok(()),
        }
        if depth < 0 {
            return Ok(());
        }
    }
    std::os::unix::fs::symlink(target, path)
}

#[cfg(not(unix))]
fn link(_path: &Path, _inside: &Path, _target: &[u8]) -> io::Result<()> {
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_leads_out_of_the_folder_is_refused() {
        let of =
            |path: &str| entry(format!("100644 blob 0123\t{path}").as_bytes()).map(|found| found.map(|each| each.path));
        assert_eq!(of("plc/a b.st"), Ok(Some(PathBuf::from("plc/a b.st"))));
        for path in ["../x", "/etc/x", "a/../../x"] {
            assert!(of(path).is_err(), "{path}");
        }
        assert!(entry(b"040000 tree 0123\tplc").is_err() && entry(b"100644 blob 0123").is_err());
        assert!(entry(b"160000 commit 0123\tother").is_ok_and(|found| found.is_none()));
    }

    #[test]
    fn a_link_that_leads_out_is_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("in");
        std::fs::create_dir(&target).unwrap();
        let made = |target: &str| {
            let path = folder.path().join("in/link");
            link(&path, Path::new("in/link"), target.as_bytes()).unwrap();
            std::fs::remove_file(&path).is_ok()
        };
        assert_eq!(["x", "../x", "./../in/x"].map(made), [true; 3]);
        assert_eq!(["../../x", "/etc/passwd", "x/../../../y"].map(made), [false; 3]);
    }

    #[test]
    fn a_file_is_not_written_twice_nor_through_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        std::os::unix::fs::symlink(folder.path().join("target"), &path).unwrap();
        assert!(write_new(&path, b"y").is_err() && !folder.path().join("target").exists());
    }
}
