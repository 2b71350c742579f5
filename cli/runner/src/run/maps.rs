//! The scenario's maps as they are when a run is over: pictures, and the same as text.

use std::path::Path;

use onescan_report::file;
use onescan_scenario::Scenario;
use onescan_server::client::ValueTable;

use super::error::RunError;
use crate::error::Usage;
use crate::value_map;

/// Writes each map as `NAME.svg` and `NAME.csv` into a folder, of what the clients showed at the end.
///
/// # Errors
/// A file cannot be written; a map of something that no client showed.
pub(super) fn write(scenario: &Scenario, tables: &[ValueTable], folder: &Path) -> Result<(), RunError> {
    file::create_folder(folder)?;
    for map in &scenario.file().map {
        let Some(drawn) = value_map::of(map, tables) else {
            let message = format!("map `{}`: nothing of `{}` was to be seen", map.name.get_ref(), map.client.get_ref());
            let help = "a body needs a component that heats its surface; a run that is over at once shows nothing";
            return Err(Usage::new(message, Some(help.to_owned())).into());
        };
        let file = |ending: &str| folder.join(format!("{}.{ending}", map.name.get_ref()));
        file::write_whole(&file("svg"), drawn.to_svg().as_bytes())?;
        file::write_whole(&file("csv"), drawn.to_csv().as_bytes())?;
    }
    Ok(())
}

/// The pictures of all maps of which something was to be seen.
pub(super) fn svgs(scenario: &Scenario, tables: &[ValueTable]) -> Vec<String> {
    scenario.file().map.iter().filter_map(|map| Some(value_map::of(map, tables)?.to_svg())).collect()
}
