//! A folder of kinds: which files are in it.

use std::path::{Path, PathBuf};

use onescan_iec::input::kind::{FileKind, SourceKind};

use crate::scene::error::SceneFaultKind;
use crate::scene::faults::Faults;
use crate::scene::placed::Placed;
use crate::scene::text;

/// A folder of kinds.
pub(super) struct Folder {
    files: Vec<KindFile>,
}

/// A file that defines a kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct KindFile {
    /// The kind that it defines.
    pub(super) kind: String,
    /// What it is called in faults: the folder as the scene names it, and the file.
    pub(super) named: String,
    pub(super) path: PathBuf,
    pub(super) form: Form,
}

/// In which form a kind is defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Parts of a scene, in TOML.
    Assembly,
    Program(SourceKind),
}

impl Folder {
    /// A folder that a scene names, beside its own.
    pub(super) fn read(named: &Placed<String>, faults: &mut Faults<'_>) -> Option<Self> {
        let path = faults.beside(text(named));
        let found = faults.within().find(&path).map_err(std::io::Error::from);
        match found.and_then(|found| Self::list(&found, &path, text(named))) {
            Ok(folder) => Some(folder),
            Err(error) => {
                let cause = format!("cannot be read: {error}");
                faults.add(named.span(), SceneFaultKind::Kinds { folder: text(named).to_owned(), cause });
                None
            }
        }
    }

    /// What is in a folder, in the order of the names. Its files are below `path`, as the scene's other files are named: what
    /// copies these has the kinds, too.
    pub(super) fn list(found: &Path, path: &Path, named: &str) -> std::io::Result<Self> {
        let mut files = Vec::new();
        for entry in std::fs::read_dir(found)? {
            let path = path.join(entry?.file_name());
            let form = match path.extension().and_then(|extension| extension.to_str()) {
                Some("toml") => Form::Assembly,
                _ => match FileKind::of(&path) {
                    Some(FileKind::Source(source)) => Form::Program(source),
                    Some(FileKind::Project) | None => continue,
                },
            };
            let (Some(kind), Some(file)) = (path.file_stem(), path.file_name()) else { continue };
            let named = format!("{}/{}", named.trim_end_matches('/'), file.to_string_lossy());
            files.push(KindFile { kind: kind.to_string_lossy().into_owned(), named, path, form });
        }
        // the order of a folder is that of its file system
        files.sort_by(|a, b| a.named.cmp(&b.named));
        Ok(Self { files })
    }

    pub(super) fn find(&self, kind: &str) -> impl Iterator<Item = &KindFile> {
        self.files.iter().filter(move |file| file.kind == kind)
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|file| file.kind.as_str())
    }
}
