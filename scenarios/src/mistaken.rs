//! Scenarios with a small mistake in a program.

use std::sync::Arc;

use onescan_iec_project::mutate::mutants;
use onescan_server::signal::ClientName;

use crate::compilations::Compilations;
use crate::error::ScenarioError;
use crate::file::ClientFile;
use crate::load::Scenario;
use crate::mistake::Mistake;

impl Scenario {
    /// All small mistakes that could be in the programs of its soft PLCs, or of one of them: PLC by PLC, each source in the
    /// order of its text.
    ///
    /// # Errors
    /// A source cannot be read.
    pub fn mistakes(&self, only: Option<&ClientName>) -> Result<Vec<Mistake>, ScenarioError> {
        let mut found = Vec::new();
        for (client, entry) in &self.file().clients {
            let ClientFile::SoftPlc { sources, dialect, .. } = entry.get_ref() else { continue };
            if only.is_some_and(|only| only != client) {
                continue;
            }
            for (source, input) in sources.iter().zip(self.inputs(client, sources, *dialect)?) {
                let mistake = |mutant| Mistake { client: client.clone(), source: source.clone(), mutant };
                found.extend(mutants(input.file()).into_iter().map(mistake));
            }
        }
        Ok(found)
    }

    /// The same with a mistake in the program of a soft PLC.
    #[must_use]
    pub fn with_mistake(&self, mistake: Mistake) -> Self {
        let mut mistaken = self.clone();
        mistaken.set_mistake(Arc::new(mistake), Compilations::default());
        mistaken
    }
}
