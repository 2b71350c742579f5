//! The files on the disk: read, compared with what is known of them, and written whole or not at all.

use std::path::{Path, PathBuf};

use onescan_base::regular;
use onescan_report::FileError;
use onescan_report::file::{Write, write_all_whole};
use onescan_scenario::ScenarioError;
use onescan_scenario::load::FILE_NAME;
use onescan_scenario::permission::granted;
use toml_edit::Item;

use super::change::Texts;
use super::error::{Changed, EditorError};
use super::wire;
use onescan_runner::error::{Unreadable, Usage};

/// Where the files of a scenario are.
#[derive(Clone, Debug)]
pub(super) struct Files {
    /// `scenario.toml`, or as it is called.
    pub(super) path: PathBuf,
}

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unwritten {
    #[error(transparent)]
    Changed(#[from] Changed),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    #[error(transparent)]
    Outside(#[from] Box<ScenarioError>),
}

impl Files {
    /// Those of the scenario in `path`, a folder or its file; links lead to where they lead.
    pub(super) fn of(path: &Path) -> Result<Self, Unreadable> {
        let path = if path.is_dir() { path.join(FILE_NAME) } else { path.to_owned() };
        let path = path.canonicalize().map_err(Unreadable::at(&path))?;
        Ok(Self { path })
    }

    pub(super) fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new("."))
    }

    /// All of them, as they are.
    pub(super) fn read(&self) -> Result<Texts, EditorError> {
        let scenario = regular::read_text(&self.path).map_err(Unreadable::at(&self.path))?;
        refuse_base(&scenario)?;
        let mut texts = Texts { scenario, ..Texts::default() };
        for scene in scenes_of(&texts.scenario) {
            let path = self.folder().join(&scene);
            let text = granted().read_text(self.folder(), &path)?.map_err(Unreadable::at(&path))?;
            texts.scenes.insert(scene, text);
        }
        Ok(texts)
    }

    /// The files that are not as they are known.
    pub(super) fn changed(&self, known: &Texts) -> Vec<String> {
        let is_other = |path: &Path, text: &str| regular::read_text(path).ok().as_deref() != Some(text);
        let scenario = is_other(&self.path, &known.scenario).then(|| wire::FILE.to_owned());
        let scenes = known.scenes.iter().filter(|(file, text)| is_other(&self.folder().join(file), text));
        scenario.into_iter().chain(scenes.map(|(file, _)| file.clone())).collect()
    }

    /// Puts `texts` in the place of the known ones.
    pub(super) fn write(&self, known: &Texts, texts: &Texts) -> Result<(), Unwritten> {
        let changed = self.changed(known);
        if !changed.is_empty() {
            return Err(Changed(changed).into());
        }
        let mut writes = Vec::new();
        if known.scenario != texts.scenario {
            writes.push(Write { path: self.path.clone(), bytes: Some(texts.scenario.clone().into_bytes()) });
        }
        for (file, text) in &texts.scenes {
            if known.scenes.get(file) != Some(text) {
                let path = self.folder().join(file);
                granted().check(self.folder(), &path).map_err(Box::new)?;
                let path = path.canonicalize().map_err(Unreadable::at(&path))?;
                writes.push(Write { path, bytes: Some(text.clone().into_bytes()) });
            }
        }
        Ok(write_all_whole(&writes)?)
    }
}

/// What a scenario takes in stands in another file, which the editor would not see.
fn refuse_base(scenario: &str) -> Result<(), Usage> {
    let Ok(document) = toml_edit::Document::parse(scenario) else { return Ok(()) };
    let Some(base) = document.as_table().get("base").and_then(Item::as_str) else { return Ok(()) };
    let help = format!("edit `{base}`, or make one file of both with `onescan show`");
    Err(Usage::new(format!("the scenario takes in `{base}`, and one file is edited at a time"), Some(help)))
}

/// The files of the scenes that a scenario names; none where it is no TOML.
pub(super) fn scenes_of(scenario: &str) -> Vec<String> {
    let Ok(document) = toml_edit::Document::parse(scenario) else { return Vec::new() };
    let clients = document.as_table().get("clients").and_then(Item::as_table_like);
    let scene = |client: &Item| {
        let is_plant = client.get("kind").and_then(Item::as_str) == Some("plant");
        client.get("scene").and_then(Item::as_str).filter(|_| is_plant).map(str::to_owned)
    };
    let mut scenes: Vec<String> = Vec::new();
    for (_, client) in clients.into_iter().flat_map(|clients| clients.iter()) {
        // plants may share one
        scenes.extend(scene(client).filter(|file| !scenes.contains(file)));
    }
    scenes
}
