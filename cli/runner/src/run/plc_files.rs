//! The files that the programs of soft PLCs have when a run is over, as files of this machine.

use std::collections::BTreeSet;
use std::path::Path;

use onescan_report::file;
use onescan_scenario::Scenario;
use onescan_server::client::Memory;
use onescan_soft_plc::files::files_in;

use super::error::RunError;
use crate::error::Usage;

/// Writes the files of each PLC into a folder of its name, by the last part of the names that the program gave them.
///
/// # Errors
/// A PLC that showed no memory, a name that is none for a file, or is there twice; a file cannot be written.
pub(super) fn write(scenario: &Scenario, memories: &[Memory], folder: &Path) -> Result<(), RunError> {
    for plc in scenario.plcs() {
        let Some(compiled) = scenario.compiled_plc(plc.name)? else { continue };
        let Some(memory) = memories.iter().find(|memory| memory.client == *plc.name) else {
            let help = "files are read out of the PLC's memory: run it in this process, without `--transport tcp`";
            return Err(Usage::new(format!("--files: `{}` showed no memory", plc.name), Some(help.to_owned())).into());
        };
        let target = folder.join(plc.name.as_str());
        file::create_folder(&target)?;
        let mut written = BTreeSet::new();
        for (path, bytes) in files_in(&compiled.application, &memory.bytes) {
            let name = path.rsplit_once(['/', '\\', ':']).map_or(path.as_str(), |(_, name)| name);
            let is_plain = name.chars().any(|letter| letter != '.') && !name.chars().any(char::is_control);
            if !is_plain || !written.insert(name.to_lowercase()) {
                let message =
                    format!("--files: `{}` has a file `{path}`, and `{name}` is not a name for it, or taken", plc.name);
                return Err(Usage::new(message, None).into());
            }
            file::write_whole(&target.join(name), &bytes)?;
        }
    }
    Ok(())
}
