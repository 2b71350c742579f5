//! The workspace: its members, and the files that belong to each.

use std::path::{Path, PathBuf};

use crate::error::TaskError;

/// Folders with files that are built or fetched.
const PASSED_OVER: [&str; 4] = ["target", "node_modules", "dist", "build"];

/// A member of the workspace.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Member {
    /// Its package's name.
    pub(crate) name: String,
    /// Its folder, from the root of the repository.
    pub(crate) folder: PathBuf,
}

impl Member {
    /// True if all of it is tests, by its place.
    pub(crate) fn is_tests(&self) -> bool {
        self.folder.components().any(|part| part.as_os_str() == "tests")
    }
}

/// The repository's root, above this crate.
pub(crate) fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().nth(2).unwrap_or(own).to_owned()
}

/// A TOML file as a table.
///
/// # Errors
/// It cannot be read, or is not TOML.
pub(crate) fn toml(path: &Path) -> Result<toml::Table, TaskError> {
    let text = read(path)?;
    text.parse().map_err(|error: toml::de::Error| TaskError::wrong(path, error.message()))
}

/// # Errors
/// The file cannot be read as text.
pub(crate) fn read(path: &Path) -> Result<String, TaskError> {
    std::fs::read_to_string(path).map_err(|source| TaskError::Unreadable { path: path.to_owned(), source })
}

/// The members that `Cargo.toml` in `root` lists, in its order.
///
/// # Errors
/// A manifest cannot be read, or does not name its package.
pub(crate) fn members(root: &Path) -> Result<Vec<Member>, TaskError> {
    let path = root.join("Cargo.toml");
    let manifest = toml(&path)?;
    let listed = manifest.get("workspace").and_then(|table| table.get("members")).and_then(toml::Value::as_array);
    let listed = listed.ok_or_else(|| TaskError::wrong(&path, "it does not list `workspace.members`"))?;
    let folders = listed.iter().filter_map(toml::Value::as_str);
    folders.map(|folder| member(root, Path::new(folder))).collect()
}

fn member(root: &Path, folder: &Path) -> Result<Member, TaskError> {
    let path = root.join(folder).join("Cargo.toml");
    let manifest = toml(&path)?;
    let name = manifest.get("package").and_then(|table| table.get("name")).and_then(toml::Value::as_str);
    let name = name.ok_or_else(|| TaskError::wrong(&path, "it does not name its package"))?.to_owned();
    Ok(Member { name, folder: folder.to_owned() })
}

/// The files below `folder` whose names end with `.extension`, in order: those of the repository, without hidden
/// folders and those that are built.
///
/// # Errors
/// A folder cannot be read.
pub(crate) fn files(folder: &Path, extension: &str) -> Result<Vec<PathBuf>, TaskError> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let unreadable = |source| TaskError::Unreadable { path: folder.clone(), source };
        for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if path.is_dir() {
                if !name.starts_with('.') && !PASSED_OVER.contains(&name.as_str()) {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|own| own == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// The files of Rust of each member, from `root`: a file belongs to the member with the deepest folder around it.
///
/// # Errors
/// A folder cannot be read.
pub(crate) fn sources(root: &Path, members: &[Member]) -> Result<Vec<(Member, Vec<PathBuf>)>, TaskError> {
    let mut of: Vec<(Member, Vec<PathBuf>)> = members.iter().map(|member| (member.clone(), Vec::new())).collect();
    for file in files(root, "rs")? {
        let file = file.strip_prefix(root).unwrap_or(&file).to_owned();
        let owner = of.iter_mut().filter(|(member, _)| file.starts_with(&member.folder));
        if let Some((_, files)) = owner.max_by_key(|(member, _)| member.folder.components().count()) {
            files.push(file);
        }
    }
    Ok(of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_belong_to_the_deepest_member() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write("Cargo.toml", "[workspace]\nmembers = [\"a\", \"a/b\", \"tests\"]\n");
        for (folder, name) in [("a", "one"), ("a/b", "two"), ("tests", "three")] {
            write(&format!("{folder}/Cargo.toml"), &format!("[package]\nname = \"{name}\"\n"));
        }
        for file in ["a/src/lib.rs", "a/b/src/lib.rs", "a/target/x.rs", "tests/.hidden/x.rs", "z.rs"] {
            write(file, "");
        }
        let members = members(root.path()).unwrap();
        let names: Vec<_> = members.iter().map(|member| (member.name.as_str(), member.is_tests())).collect();
        assert_eq!(names, [("one", false), ("two", false), ("three", true)]);
        let found: Vec<_> = sources(root.path(), &members).unwrap().into_iter().map(|(_, files)| files).collect();
        assert_eq!(found, [vec![PathBuf::from("a/src/lib.rs")], vec![PathBuf::from("a/b/src/lib.rs")], vec![]]);
    }
}
