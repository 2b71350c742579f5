//! Machines to learn on, as texts: what of `scenarios/learn` is handed out. The build script gathers them, so that a folder
//! there is a task of the program.

use super::template::File;

/// A task that the program has.
#[derive(Clone, Copy, Debug)]
pub struct Task {
    /// Its name, which is that of its folder.
    pub name: &'static str,
    /// Its files, in the order of their names.
    pub files: &'static [File],
}

include!(concat!(env!("OUT_DIR"), "/tasks.rs"));

impl Task {
    /// All tasks, in the order of their names.
    pub fn all() -> &'static [Self] {
        TASKS
    }

    /// The task of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        TASKS.iter().find(|task| task.name == name)
    }

    /// What it is about, as its scenario says; empty if that says nothing.
    pub fn title(&self) -> String {
        let scenario = self.files.iter().find(|(file, _)| *file == super::load::FILE_NAME);
        let title = scenario.and_then(|(_, text)| toml::from_str::<Titled>(text).ok());
        title.map_or_else(String::new, |titled| titled.title)
    }
}

/// The part of a scenario that is listed.
#[derive(serde::Deserialize)]
struct Titled {
    #[serde(default)]
    title: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_task_has_a_title_a_sheet_and_a_skeleton() {
        for task in Task::all() {
            let Task { name, files } = task;
            let has = |wanted: &str| files.iter().any(|(file, _)| *file == wanted);
            assert!(has("scenario.toml") && has("README.md"), "{name}");
            assert!(files.iter().any(|(file, _)| file.starts_with("skeleton/")), "{name}");
            assert!(!task.title().is_empty(), "{name}");
            assert!(files.iter().all(|(file, _)| !file.contains("solution")), "{name}: {files:?}");
        }
    }
}
