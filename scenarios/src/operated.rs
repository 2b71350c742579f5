//! People in the place of a client: what it would write, they write.

use std::collections::BTreeMap;

use onescan_server::signal::{ClientName, did_you_mean};

use crate::error::ScenarioError;
use crate::file::ClientFile;
use crate::load::Scenario;

impl Scenario {
    /// Lets operators stand in for client `name`: its signals begin at 0, FALSE or empty, and nobody but they writes them.
    ///
    /// # Errors
    /// No such client.
    pub fn operate(&mut self, name: &ClientName) -> Result<(), ScenarioError> {
        let Some(entry) = self.file().clients.get(name) else {
            let help = did_you_mean(name.as_str(), self.file().clients.keys().map(ClientName::as_str));
            return Err(self.wrong_client(name, format!("the scenario has no client `{name}`"), help));
        };
        let operators = match entry.get_ref() {
            ClientFile::Operator { .. } => return Ok(()),
            _ => toml::Spanned::new(entry.span(), ClientFile::Operator { initial: BTreeMap::new() }),
        };
        self.set_client(name.clone(), operators);
        Ok(())
    }
}
