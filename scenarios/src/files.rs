//! The files that a scenario is made of: what is copied with a recording, and what a kept result depends on.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::case;
use crate::error::ScenarioError;
use crate::file::ClientFile;
use crate::load::{FILE_NAME, Scenario};

impl Scenario {
    /// The files that the scenario is made of, itself first, then its bases, as it names them: relative to its folder. With them are those of the
    /// kinds of component that its scenes read from their `libraries`.
    ///
    /// # Errors
    /// A scene that cannot be read.
    pub fn files(&self) -> Result<Vec<PathBuf>, ScenarioError> {
        let mut files = vec![self.path().file_name().map_or_else(|| FILE_NAME.into(), PathBuf::from)];
        files.extend(self.bases().map(|base| self.relative(base)));
        let mut kinds = BTreeSet::new();
        for (name, client) in &self.file().clients {
            match client.get_ref() {
                ClientFile::Plant { scene, .. } => {
                    files.push(scene.into());
                    for path in self.scene_once(name, scene)?.kind_files {
                        kinds.insert(self.relative(&path));
                    }
                }
                ClientFile::SoftPlc { sources, .. } => files.extend(sources.iter().map(PathBuf::from)),
                ClientFile::Operator { .. }
                | ClientFile::Gateway { .. }
                | ClientFile::OpcUa { .. }
                | ClientFile::External { .. } => {}
            }
        }
        files.extend(self.file().panel.iter().filter_map(|panel| Some(panel.picture.as_ref()?.get_ref().into())));
        files.extend(self.files_of_case());
        // cases and lessons stand beside the scenario
        files.extend(self.applied().map(|applied| self.relative(Path::new(&applied.source.0))));
        files.extend(kinds);
        files.dedup();
        Ok(files)
    }

    /// The file with its cases, whether it is there or not, as the scenario would name it.
    ///
    /// # Errors
    /// A base cannot be read.
    pub fn cases_file(&self) -> Result<PathBuf, ScenarioError> {
        Ok(self.relative(&case::beside(self.path())?))
    }

    /// A path of a file beside the scenario's own, as the scenario would name it.
    fn relative(&self, path: &Path) -> PathBuf {
        path.strip_prefix(self.folder()).unwrap_or(path).to_owned()
    }
}
