//! Where the files of a project are that was made on Windows, which does not tell `Main.TcPOU` from `MAIN.TcPOU`.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The file `path` below `folder`; if there is none, the first whose names differ in capital letters alone.
pub(super) fn on_disk(folder: &Path, path: &str) -> PathBuf {
    let whole = folder.join(path);
    if whole.exists() {
        return whole;
    }
    Path::new(path).components().fold(folder.to_owned(), |above, part| {
        let exact = above.join(part);
        if exact.exists() { exact } else { alike(&above, part.as_os_str()).unwrap_or(exact) }
    })
}

/// A folder that cannot be read has nothing alike: the file is then reported as missing.
fn alike(folder: &Path, name: &OsStr) -> Option<PathBuf> {
    let wanted = name.to_str()?.to_lowercase();
    let is_alike = |path: &PathBuf| {
        let name = path.file_name().and_then(OsStr::to_str);
        name.is_some_and(|name| name.to_lowercase() == wanted)
    };
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok);
    entries.map(|entry| entry.path()).filter(is_alike).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_may_differ_in_capital_letters() {
        let folder = tempfile::tempdir().unwrap();
        let pous = folder.path().join("POUs");
        std::fs::create_dir(&pous).unwrap();
        std::fs::write(pous.join("MAIN.TcPOU"), "").unwrap();
        std::fs::write(pous.join("Main.tcpou"), "").unwrap();
        assert_eq!(on_disk(folder.path(), "POUs/Main.tcpou"), pous.join("Main.tcpou"));
        assert_eq!(on_disk(folder.path(), "pous/main.TcPOU"), pous.join("MAIN.TcPOU"));
        assert_eq!(on_disk(folder.path(), "POUs/Other.TcPOU"), pous.join("Other.TcPOU"));
    }
}
