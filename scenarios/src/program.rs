//! The programs of soft PLCs: those that the file names, or others in their place.

use onescan_iec::Input;
use onescan_server::signal::ClientName;

use super::compilations::Compilations;
use super::error::ScenarioError;
use super::file::ClientFile;
use super::load::Scenario;

impl Scenario {
    /// The scenario with another program in the soft PLC `name`. Its file says all else of that PLC: dialect, tasks, memory.
    #[must_use]
    pub fn with_program(mut self, name: &ClientName, program: Vec<Input>) -> Self {
        self.programs.put(name.clone(), program);
        // What was compiled of the other program is not this one.
        self.compilations = Compilations::default();
        self
    }

    /// The program of soft PLC `name`, as it is read.
    ///
    /// # Errors
    /// No such PLC, or a source that cannot be read.
    pub fn program(&self, name: &ClientName) -> Result<Vec<Input>, ScenarioError> {
        match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { sources, dialect, .. }) => self.inputs(name, sources, *dialect),
            _ => Err(self.wrong_client(name, format!("`{name}` is not a soft PLC of the scenario"), None)),
        }
    }
}
