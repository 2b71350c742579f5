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

    /// The folder of a package as a path that stands for itself wherever it is written, as ROS gives it: `file://` and
    /// other texts are put before it, and more behind it.
    pub(super) fn find_absolute(&self, name: &str, file: &Path) -> Option<PathBuf> {
        self.find(name, file).as_deref().map(absolute)
    }

    /// A file that a robot's file names: beside it, at a `file://`, or in a package.
    ///
    /// # Errors
    /// Why it is not found, in words that follow the file's name.
    pub fn file(&self, named: &str, from: &Path) -> Result<PathBuf, String> {
        let beside = |path: &str| from.parent().unwrap_or_else(|| Path::new("")).join(path);
        let (package, inside) = match named.strip_prefix("package://").or_else(|| named.strip_prefix("model://")) {
            Some(packaged) => packaged.split_once('/').unwrap_or(("", packaged)),
            None => return Ok(named.strip_prefix("file://").map_or_else(|| beside(named), |path| local(path, from))),
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

/// What stands behind `file://`. Files are published with two slashes, three or four before a path that begins at the
/// root, and with two or three before one that begins beside the file.
fn local(path: &str, from: &Path) -> PathBuf {
    let bare = path.trim_start_matches('/');
    // where paths begin with a drive, no slash stands before it
    let rooted = if Path::new(bare).is_absolute() { bare.to_owned() } else { format!("/{bare}") };
    let beside = from.parent().unwrap_or_else(|| Path::new("")).join(bare);
    let is_rooted = path.starts_with('/') || Path::new(bare).is_absolute();
    if is_rooted && (Path::new(&rooted).is_file() || !beside.is_file()) { rooted.into() } else { beside }
}

/// A folder as a path from the root.
pub(super) fn absolute(folder: &Path) -> PathBuf {
    // an empty path is the folder in which the program runs
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf())
}

/// A path for people: from the folder in which the program runs, if it lies in there.
pub(super) fn shown(path: &Path) -> String {
    let here = std::env::current_dir().ok();
    let inside = here.as_ref().and_then(|here| path.strip_prefix(here).ok());
    inside.unwrap_or(path).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_url_leads_to_its_file_whatever_its_slashes() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mesh, urdf) = (folder.path().join("meshes/a.stl"), folder.path().join("arm.urdf"));
        std::fs::create_dir(folder.path().join("meshes")).expect("a folder");
        std::fs::write(&mesh, "solid").expect("written");
        let packages = Packages::default();
        let whole = mesh.display().to_string();
        for named in [&*format!("file://{whole}"), &format!("file:///{whole}"), &whole] {
            let found = packages.file(named, &urdf).expect(named);
            assert_eq!(found.canonicalize().expect(named), mesh.canonicalize().expect("there"), "{named}");
        }
        for named in ["file://meshes/a.stl", "file:///meshes/a.stl", "meshes/a.stl"] {
            assert_eq!(packages.file(named, &urdf), Ok(mesh.clone()), "{named}");
        }
        let lost = packages.file("file:///no/such.stl", &urdf);
        assert!(lost.is_ok_and(|path| path.is_absolute() && path.ends_with("no/such.stl")));
    }

    #[test]
    fn a_package_is_found_as_an_absolute_path() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("arm/urdf/arm.xacro");
        std::fs::create_dir_all(folder.path().join("arm/urdf")).expect("a folder");
        assert!(Packages::default().find_absolute("arm", &file).is_some_and(|found| found.is_absolute()));
        // the crate's own folder, in which its tests run
        let named = Packages::new(vec![("here".to_owned(), PathBuf::new())], Within::anywhere());
        let here = named.find_absolute("here", Path::new("arm.xacro")).expect("named");
        assert!(here.is_absolute() && here.join("Cargo.toml").is_file());
        assert_eq!(shown(&here.join("src/lib.rs")), Path::new("src").join("lib.rs").display().to_string());
    }
}
