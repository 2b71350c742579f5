//! The scenario's maps as they are when a run is over: pictures, and the same as text.

use std::path::Path;

use onescan_report::file;
use onescan_report::plot::{MapAxis, ValueMap};
use onescan_scenario::Scenario;
use onescan_scenario::map_file::MapFile;
use onescan_server::client::ValueTable;

use super::error::RunError;
use crate::error::Usage;

/// The greatest value of a byte.
const GREATEST: f64 = 255.0;

/// Writes each map as `NAME.svg` and `NAME.csv` into a folder, of what the clients showed at the end.
///
/// # Errors
/// A file cannot be written; a map of something that no client showed.
pub(super) fn write(scenario: &Scenario, tables: &[ValueTable], folder: &Path) -> Result<(), RunError> {
    file::create_folder(folder)?;
    for map in &scenario.file().map {
        let shown = map.shown_as().and_then(|name| tables.iter().find(|table| *table.name == *name));
        let Some(table) = shown else {
            let message = format!("map `{}`: nothing of `{}` was to be seen", map.name.get_ref(), map.client.get_ref());
            let help = "a body needs a component that heats its surface; a run that is over at once shows nothing";
            return Err(Usage::new(message, Some(help.to_owned())).into());
        };
        let drawn = drawn(map, table);
        let file = |ending: &str| folder.join(format!("{}.{ending}", map.name.get_ref()));
        file::write_whole(&file("svg"), drawn.to_svg().as_bytes())?;
        file::write_whole(&file("csv"), drawn.to_csv().as_bytes())?;
    }
    Ok(())
}

/// The pictures of all maps of which something was to be seen.
pub(super) fn svgs(scenario: &Scenario, tables: &[ValueTable]) -> Vec<String> {
    let table = |map: &MapFile| map.shown_as().and_then(|name| tables.iter().find(|table| *table.name == *name));
    scenario.file().map.iter().filter_map(|map| Some(drawn(map, table(map)?).to_svg())).collect()
}

/// A table as the scenario wants it to be drawn.
fn drawn(map: &MapFile, table: &ValueTable) -> ValueMap {
    let columns = table.columns.max(1);
    let first = (map.first as usize).min(columns - 1);
    let points = map.points.map_or(columns - first, |points| (points as usize).min(columns - first));
    let is_part = map.variable.is_some();
    let all = table.values.len() / columns;
    let rows = map.rows.map_or(all, |rows| (rows as usize).min(all));
    let meant = |value: f64| match map.bytes_mean {
        Some([least, most]) => least + value * (most - least) / GREATEST,
        None => value,
    };
    let row =
        |row: usize| table.values[row * columns + first..row * columns + first + points].iter().copied().map(meant);
    let across = match map.optics {
        Some(optics) => MapAxis { name: "position (m)".to_owned(), edges: optics.edges_m(points) },
        None if is_part => MapAxis::even("point", 0.0, points as f64, points),
        None => MapAxis::even("position (m)", table.across[0], table.across[1], columns),
    };
    let rows_are = if map.rows_are.is_empty() { "row" } else { &map.rows_are };
    let down = if is_part {
        MapAxis::even(rows_are, 0.0, rows as f64, rows)
    } else {
        MapAxis::even("angle (°)", table.down[0], table.down[1], rows)
    };
    ValueMap {
        title: if map.title.is_empty() { map.name.get_ref().clone() } else { map.title.clone() },
        unit: map.unit.clone(),
        across,
        down,
        values: (0..rows).flat_map(row).collect(),
        scale: map.scale,
    }
}
