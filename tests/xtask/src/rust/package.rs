//! The sources of a package, with what of them only tests compile.

use std::path::{Path, PathBuf};

use super::source::Source;
use crate::error::TaskError;
use crate::workspace::{Member, read};

/// A file of a package.
#[derive(Debug)]
pub(crate) struct File {
    /// From the root of the repository.
    pub(crate) path: PathBuf,
    pub(crate) source: Source,
    /// True if only tests, benches and examples have it.
    pub(crate) is_test: bool,
}

/// Reads the files of a member; their paths begin at `root`.
///
/// # Errors
/// A file cannot be read as text.
pub(crate) fn package(root: &Path, member: &Member, files: &[PathBuf]) -> Result<Vec<File>, TaskError> {
    let mut found = Vec::new();
    let mut tests = Vec::new();
    for path in files {
        let source = Source::new(&read(&root.join(path))?);
        tests.extend(source.test_modules.iter().map(|name| module_folder(path).join(name)));
        found.push(File { path: path.clone(), source, is_test: !is_product(member, path) });
    }
    for file in &mut found {
        // The module's file, or one in its folder.
        let own = file.path.with_extension("");
        file.is_test |= tests.iter().any(|module| own.starts_with(module));
    }
    Ok(found)
}

fn is_product(member: &Member, path: &Path) -> bool {
    let own = path.strip_prefix(&member.folder).unwrap_or(path);
    !member.is_tests() && (own.starts_with("src") || own == Path::new("build.rs"))
}

/// Where the modules lie that a file declares.
fn module_folder(path: &Path) -> PathBuf {
    let is_folder = path.file_stem().is_some_and(|stem| stem == "mod" || stem == "lib" || stem == "main");
    if is_folder { path.parent().unwrap_or(path).to_owned() } else { path.with_extension("") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_test_modules_and_folders_of_tests_are_tests() {
        let root = tempfile::tempdir().unwrap();
        let files = [
            ("a/src/lib.rs", "mod b;\n#[cfg(test)]\nmod rig;\n", false),
            ("a/src/b.rs", "#[cfg(test)]\nmod tests;\n", false),
            ("a/src/b/tests.rs", "", true),
            ("a/src/rig/mod.rs", "mod inner;\n", true),
            ("a/src/rig/inner.rs", "", true),
            ("a/src/rigid.rs", "", false),
            ("a/benches/c.rs", "", true),
            ("a/build.rs", "", false),
        ];
        for (path, text, _) in files {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let member = Member { name: "a".to_owned(), folder: "a".into() };
        let paths: Vec<PathBuf> = files.iter().map(|(path, ..)| path.into()).collect();
        for (file, (path, _, is_test)) in package(root.path(), &member, &paths).unwrap().iter().zip(files) {
            assert_eq!(file.is_test, is_test, "{path}");
        }
    }
}
