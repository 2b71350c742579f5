//! A file of lessons, read: `lessons.toml`, or one in the folder `lessons` beside it.

use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::Spanned;

use super::file::{LessonFile, LessonsFile, VERSION};
use super::{FILE_NAME, FOLDER_NAME};
use crate::error::{ScenarioError, wrong};
use crate::expect::FormulaError;
use crate::expectations::place_within;
use crate::permission;

/// A file of lessons.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub(super) path: PathBuf,
    pub(super) text: String,
    pub(super) file: LessonsFile,
}

impl Sheet {
    /// All files of lessons of the scenario in `folder`: `lessons.toml` first, then those of the folder `lessons` in the order
    /// of their names.
    ///
    /// # Errors
    /// There is none; one cannot be read or is not a file of lessons.
    pub(super) fn all(folder: &Path) -> Result<Vec<Self>, ScenarioError> {
        let (alone, beside) = (folder.join(FILE_NAME), folder.join(FOLDER_NAME));
        let mut paths = if alone.exists() { vec![alone.clone()] } else { Vec::new() };
        if beside.is_dir() {
            permission::granted().check(folder, &beside)?;
            paths.extend(listed(&beside).map_err(|source| unreadable(&beside, source))?);
        }
        if paths.is_empty() {
            // What is usual is what is missing.
            paths.push(alone);
        }
        paths.into_iter().map(|path| Self::read(folder, path)).collect()
    }

    fn read(folder: &Path, path: PathBuf) -> Result<Self, ScenarioError> {
        let text = permission::granted().read_text(folder, &path)?.map_err(|source| unreadable(&path, source))?;
        let file: LessonsFile = toml::from_str(&text)
            .map_err(|error| wrong(&path, &text, error.message().trim().to_owned(), error.span(), None))?;
        if file.version != VERSION {
            let message = format!("version {} of the format of lessons is not known", file.version);
            return Err(wrong(&path, &text, message, None, Some(format!("write `version = {VERSION}`"))));
        }
        Ok(Self { path, text, file })
    }

    /// The lesson of this name as it is written here.
    pub(super) fn lesson(&self, name: &str) -> Option<&LessonFile> {
        self.file.lessons.iter().map(Spanned::get_ref).find(|file| file.name.get_ref() == name)
    }

    /// An error at a place of the file.
    pub(super) fn wrong(&self, message: String, place: Range<usize>, help: Option<String>) -> ScenarioError {
        wrong(&self.path, &self.text, message, Some(place), help)
    }

    /// An error at a part of a formula.
    pub(super) fn wrong_formula(&self, formula: &Spanned<String>, error: FormulaError) -> ScenarioError {
        let place = place_within(formula, &self.text, &error.place);
        self.wrong(error.to_string(), place, error.help)
    }
}

/// The TOML files of a folder, in the order of their names.
fn listed(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let paths: std::io::Result<Vec<PathBuf>> =
        std::fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path())).collect();
    let mut paths = paths?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    Ok(paths)
}

fn unreadable(path: &Path, source: std::io::Error) -> ScenarioError {
    let help = format!(
        "lessons stand in a `{FILE_NAME}` beside the scenario, or in files of a folder `{FOLDER_NAME}` (docs/training.md)"
    );
    ScenarioError::Unreadable { path: path.to_owned(), source, help: Some(help) }
}
