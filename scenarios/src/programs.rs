//! Programs in the place of those that a scenario's file names.

use std::collections::BTreeMap;
use std::sync::Arc;

use onescan_iec::Input;
use onescan_server::signal::ClientName;

/// Them, by client.
#[derive(Clone, Debug, Default)]
pub(crate) struct Programs(BTreeMap<ClientName, Arc<[Input]>>);

impl Programs {
    /// The program in the place of that of `name`, if there is one.
    pub(crate) fn of(&self, name: &ClientName) -> Option<&[Input]> {
        self.0.get(name).map(|program| &**program)
    }

    /// Puts a program in the place of that of `name`.
    pub(crate) fn put(&mut self, name: ClientName, program: Vec<Input>) {
        self.0.insert(name, program.into());
    }
}
