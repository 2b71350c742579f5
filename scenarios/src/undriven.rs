//! Inputs of its soft PLCs that nobody drives.

use onescan_iec::Diagnostics;
use onescan_iec_run::{Application, Variable};
use onescan_server::signal::ClientName;
use onescan_soft_plc::undriven::undriven;

use super::compilations::Compiled;
use super::error::ScenarioError;
use super::file::ClientFile;
use super::load::Scenario;

impl Scenario {
    /// The inputs that nobody drives of each soft PLC that has some: a warning each, at its declaration.
    ///
    /// # Errors
    /// Sources that cannot be read or do not compile; a signal without a variable.
    pub fn undriven_inputs(&self) -> Result<Vec<(ClientName, Diagnostics)>, ScenarioError> {
        let mut found = Vec::new();
        for name in self.file().clients.keys() {
            let Some(compiled) = self.compiled_plc(name)? else { continue };
            let warnings = self.undriven_of(name, &compiled)?;
            if !warnings.is_empty() {
                found.push((name.clone(), warnings));
            }
        }
        Ok(found)
    }

    /// The same of soft PLC `name`; none in a scenario without signals, in which nothing is connected yet.
    ///
    /// # Errors
    /// A signal without a variable.
    pub fn undriven_of(
        &self,
        name: &ClientName,
        Compiled { application, paths, .. }: &Compiled,
    ) -> Result<Diagnostics, ScenarioError> {
        if self.plan().signals().is_empty() {
            return Ok(Diagnostics::new(Vec::new(), application.sources()));
        }
        let bindings = self.bindings(name, application, paths)?;
        let set = self.set_in(name);
        let others: Vec<Variable> = set.filter_map(|path| application.variable(path).ok()).collect();
        let warnings = undriven(application, &bindings, self.plan().signals(), &others);
        Ok(Diagnostics::new(warnings, application.sources()))
    }

    /// The same of an application that was compiled of the sources of soft PLC `name` elsewhere; none if it is not one.
    ///
    /// # Errors
    /// A `bind` that is wrong; a signal without a variable.
    pub fn undriven_in(
        &self,
        name: &ClientName,
        application: Application,
    ) -> Result<Option<Diagnostics>, ScenarioError> {
        let Some(ClientFile::SoftPlc { bind, .. }) = self.file().clients.get(name).map(toml::Spanned::get_ref) else {
            return Ok(None);
        };
        let paths = self.paths(name, bind)?;
        self.undriven_of(name, &Compiled { application, paths, inputs: Vec::new() }).map(Some)
    }

    /// Paths of variables of `name` that something else than a signal writes: ports, and what the case sets. Whether
    /// there are such variables is asked elsewhere.
    fn set_in<'a>(&'a self, name: &'a ClientName) -> impl Iterator<Item = &'a str> {
        let ports = match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { ports, .. }) => Some(ports),
            _ => None,
        };
        let images = ports.into_iter().flat_map(|ports| ports.values());
        let images = images.filter_map(|port| port.serial.as_ref()?.input.as_deref());
        let settings = self.case().map(|case| case.settings.as_slice()).unwrap_or_default();
        let applied = self.applied().into_iter().flat_map(|applied| &applied.variables);
        let written = applied.filter(|at| at.client == *name).map(|at| at.variable.as_str());
        images
            .chain(written)
            .chain(settings.iter().filter_map(|one| one.path.strip_prefix(name.as_str())?.strip_prefix('.')))
    }
}
