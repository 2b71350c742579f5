//! Where the packages of robots' files are: by name from the scene, or in the folders around a file.
//!
//! A package is a folder that has its name, or whose `package.xml` says so (ROS REP 127 and 149).

use std::path::{Path, PathBuf};

use onescan_base::regular::Within;

/// How many folders up from a file a package is looked for.
const UP_MAX: usize = 8;

/// Folders of packages that the scene names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Packages {
    named: Vec<(String, PathBuf)>,
    within: Within,
}

impl Packages {
    /// Packages by name, each with its folder; files of them and of robots are read where `within` allows it.
    pub fn new(named: Vec<(String, PathBuf)>, within: Within) -> Self {
        Self { named, within }
    }

    /// The text of a file that a robot's file names.
    ///
    /// # Errors
    /// It cannot be read, or may not be.
    pub(super) fn read_text(&self, path: &Path) -> std::io::Result<String> {
        self.within.read_text(path)
    }

    /// The folder of a package that is named, or that is in a folder around `file`.
    pub(super) fn find(&self, name: &str, file: &Path) -> Option<PathBuf> {
        if let Some((_, folder)) = self.named.iter().find(|(known, _)| known == name) {
            return Some(folder.clone());
        }
        let mut around = file.parent().unwrap_or_else(|| Path::new("")).to_path_buf();
        for _ in 0..UP_MAX {
            if self.is_package(&around, name) {
                return Some(around);
            }
            if let Some(beside) =
                [around.join(name), around.join("src").join(name)].into_iter().find(|path| path.is_dir())
            {
                return Some(beside);
            }
            around.push("..");
        }
        None
    }

    /// A file that a robot's file names: beside it, or in a package.
    ///
    /// # Errors
    /// Why it is not found, in words that follow the file's name.
    pub fn file(&self, named: &str, from: &Path) -> Result<PathBuf, String> {
        let beside = |path: &str| from.parent().unwrap_or_else(|| Path::new("")).join(path);
        let (package, inside) = match named.strip_prefix("package://").or_else(|| named.strip_prefix("model://")) {
            Some(packaged) => packaged.split_once('/').unwrap_or(("", packaged)),
            None => return Ok(beside(named.strip_prefix("file://").unwrap_or(named))),
        };
        if let Some(file) = self.find(package, from).map(|folder| folder.join(inside)).filter(|file| file.is_file()) {
            return Ok(file);
        }
        // a package that was copied without its name
        let mut around = beside("");
        for _ in 0..UP_MAX {
            if around.join(inside).is_file() {
                return Ok(around.join(inside));
            }
            around.push("..");
        }
        Err(format!(
            "of which no folder around it has `{inside}`; where package `{package}` is, says `packages = {{ {package} = \
             \"folder\" }}`"
        ))
    }

    /// Whether a folder is the package of a name.
    fn is_package(&self, folder: &Path, name: &str) -> bool {
        let Ok(text) = self.read_text(&folder.join("package.xml")) else { return false };
        let written = text.split_once("<name>").and_then(|(_, rest)| rest.split_once("</name>"));
        written.is_some_and(|(written, _)| written.trim() == name)
    }
}
