//! What a case asks of a PLC that only one in this process does: a real one runs its own program and keeps its own variables.

use onescan_server::signal::ClientName;

use super::settings_of;
use crate::load::Scenario;

impl Scenario {
    /// What the case wants of PLC `name` that a real one does not do, in words; nothing if that is nothing.
    pub fn beyond_a_real_plc(&self, name: &ClientName) -> Option<String> {
        let applied = self.applied()?;
        if let Some(setting) = settings_of(applied, name).next() {
            return Some(format!("`{}` is set before it starts", setting.path));
        }
        if let Some(code) = self.code_of_case(name).next() {
            return Some(format!("it runs another `{}`", code.source));
        }
        let operations = self.timeline().iter().filter_map(|scheduled| scheduled.operation.for_client());
        operations.filter(|(client, _)| *client == name).map(|(_, operation)| operation.to_string()).next()
    }
}
