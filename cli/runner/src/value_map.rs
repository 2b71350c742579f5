//! A map of the scenario, of what clients show at one moment.

use onescan_report::plot::{MapAxis, ValueMap};
use onescan_scenario::map_file::MapFile;
use onescan_server::client::ValueTable;

/// The greatest value of a byte.
const GREATEST: f64 = 255.0;

/// What it shows, in one line.
pub(crate) fn title(map: &MapFile) -> String {
    if map.title.is_empty() { map.name.get_ref().clone() } else { map.title.clone() }
}

/// The map, as the scenario wants it to be drawn; nothing if its client shows no such table.
pub(crate) fn of(map: &MapFile, tables: &[ValueTable]) -> Option<ValueMap> {
    let name = map.shown_as()?;
    // One array may be shown with rows of several lengths.
    let is_its = |table: &&ValueTable| {
        table.client == *map.client.get_ref()
            && *table.name == *name
            && map.row.is_none_or(|row| table.columns == row as usize)
    };
    tables.iter().find(is_its).map(|table| drawn(map, table))
}

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
        title: title(map),
        unit: map.unit.clone(),
        across,
        down,
        values: (0..rows).flat_map(row).collect(),
        scale: map.scale,
    }
}
