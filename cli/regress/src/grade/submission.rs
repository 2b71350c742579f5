//! Which submissions are meant by what was typed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use onescan_base::foreign::one_line;
use onescan_iec::input::kind::FileKind;
use onescan_runner::error::{Unreadable, Usage};

use super::error::GradeError;

/// A folder or file that was handed in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Submission {
    /// What it is called in reports.
    pub(super) name: String,
    pub(super) path: PathBuf,
}

/// The submissions behind `paths`, each once, in the order of their names. One is called as its folder, or as its file
/// without the ending; where two would have one name, as their paths.
///
/// # Errors
/// One is not there.
pub(super) fn meant(paths: &[PathBuf]) -> Result<Vec<Submission>, GradeError> {
    let mut found = Vec::new();
    for path in paths {
        found.extend(expanded(path)?);
    }
    let mut seen = BTreeSet::new();
    let mut submissions = Vec::new();
    for path in found {
        let real = path.canonicalize().map_err(Unreadable::at(&path))?;
        if seen.insert(real.clone()) {
            submissions.push(Submission { name: name_of(&path, &real), path });
        }
    }
    if submissions.is_empty() {
        let named = paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        let help = "name the folders or PLC sources that were handed in, as in `class/*`".to_owned();
        return Err(Usage::new(format!("{named} holds no submission"), Some(help)).into());
    }
    let names: Vec<String> = submissions.iter().map(|one| one.name.clone()).collect();
    for submission in &mut submissions {
        if names.iter().filter(|name| **name == submission.name).count() > 1 {
            submission.name = one_line(&submission.path.to_string_lossy()).into_owned();
        }
    }
    submissions.sort_by(|a, b| (&a.name, &a.path).cmp(&(&b.name, &b.path)));
    Ok(submissions)
}

/// What `class/*` stands for, which some shells leave as it is: the folders and PLC sources there.
fn expanded(path: &Path) -> Result<Vec<PathBuf>, Unreadable> {
    let folder = path.parent().filter(|_| path.file_name().is_some_and(|name| name == "*") && !path.exists());
    let Some(folder) = folder else { return Ok(vec![path.to_owned()]) };
    let folder = if folder == Path::new("") { Path::new(".") } else { folder };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(Unreadable::at(folder))? {
        let path = entry.map_err(Unreadable::at(folder))?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if !is_hidden && (path.is_dir() || FileKind::of(&path).is_some()) {
            found.push(path);
        }
    }
    Ok(found)
}

fn name_of(path: &Path, real: &Path) -> String {
    // `.` and `..` have names of their own only where they lead.
    let named = if path.file_name().is_some() { path } else { real };
    let name = if real.is_dir() { named.file_name() } else { named.file_stem() };
    name.map_or_else(|| path.display().to_string(), |name| one_line(&name.to_string_lossy()).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_called_by_its_folder_or_file() {
        let place = tempfile::tempdir().unwrap();
        for file in ["class/ben/main.st", "class/anna/main.st", "class/carl.st", "class/.git/config", "class/notes.txt"]
        {
            let path = place.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        let names = |path: &str| -> Vec<String> {
            meant(&[place.path().join(path)]).unwrap().into_iter().map(|one| one.name).collect()
        };
        assert_eq!(names("class/*"), ["anna", "ben", "carl"]);
        let both = ["anna", "ben"].map(|name| place.path().join("class").join(name).join("main.st"));
        let both = meant(&both).unwrap();
        assert!(both[0].name.ends_with("main.st") && both[0].name != both[1].name, "{both:?}");
        assert!(meant(&[place.path().join("nobody")]).is_err());
        std::fs::create_dir(place.path().join("empty")).unwrap();
        let none = meant(&[place.path().join("empty/*")]).unwrap_err();
        assert!(none.to_string().ends_with("empty/* holds no submission"), "{none}");
    }
}
