//! The scenario's maps on the page: tables of values that no signal has, as they are now.
//!
//! A table is sent as often as people read it, and only if it has changed since. Its values are bytes. Where its cells lie is
//! sent before the first values, and whenever it is no longer so.

use std::collections::{BTreeMap, BTreeSet};

use axum::body::Bytes;
use onescan_report::plot::value_map::colours;
use onescan_report::plot::{MapAxis, ValueMap};
use onescan_scenario::Scenario;
use onescan_scenario::map_file::MapFile;
use onescan_server::published::SessionView;
use schemars::JsonSchema;
use serde::Serialize;

use super::error::Refused;
use super::picture::PAST;
use crate::value_map;

/// The kind of message that values of a map are.
const KIND: u8 = 2;
const HEAD_BYTES: usize = 16;

/// A map, as far as it is known before it is seen.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "MapInfo")]
pub(super) struct Map {
    name: String,
    title: String,
    #[schemars(default)]
    unit: String,
    client: String,
    /// The values of the scale's ends; those of the map if absent.
    scale: Option<[f64; 2]>,
    /// From the least value to the greatest, each written as `#0a1a52`.
    #[schemars(inner(regex(pattern = "^#[0-9a-f]{6}$")))]
    colours: Vec<String>,
}

/// Where the cells of a map lie.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(super) struct Cells {
    map: usize,
    #[schemars(with = "Axis")]
    across: MapAxis,
    #[schemars(with = "Axis")]
    down: MapAxis,
}

/// An axis of a map: where each of its cells begins, and where the last one ends, in rising order.
#[derive(JsonSchema)]
#[schemars(extend("x-check" = "axis"))]
#[expect(dead_code, reason = "the form of `MapAxis`, whose crate has no schemas")]
struct Axis {
    name: String,
    edges: Vec<f64>,
}

/// Something new of a map.
#[derive(Debug, PartialEq)]
pub(super) enum New {
    /// Where its cells lie.
    Cells(Cells),
    /// Its values, as a message.
    Values(Bytes),
}

/// The maps of a scenario.
pub(super) fn of(scenario: &Scenario) -> Vec<Map> {
    let map = |file: &MapFile| Map {
        name: file.name.get_ref().clone(),
        title: value_map::title(file),
        unit: file.unit.clone(),
        client: file.client.get_ref().to_string(),
        scale: file.scale,
        colours: colours().collect(),
    };
    scenario.file().map.iter().map(map).collect()
}

/// Which maps one viewer looks at, and what it has been shown of them.
#[derive(Debug, Default)]
pub(super) struct Mapped {
    wanted: BTreeSet<usize>,
    shown: BTreeMap<usize, (Cells, Bytes)>,
}

impl Mapped {
    /// From now on these maps; all of each are shown the next time.
    pub(super) fn want(&mut self, maps: Vec<usize>, known: &[MapFile]) -> Result<(), Refused> {
        if let Some(unknown) = maps.iter().find(|map| **map >= known.len()) {
            return Err(Refused::NoMap(*unknown));
        }
        *self = Self { wanted: maps.into_iter().collect(), shown: BTreeMap::new() };
        Ok(())
    }

    /// Whether any map is looked at.
    pub(super) fn is_wanted(&self) -> bool {
        !self.wanted.is_empty()
    }

    /// What is new in a view, of the past if `is_past`.
    pub(super) fn see(&mut self, view: &SessionView, known: &[MapFile], is_past: bool) -> Vec<New> {
        let mut news = Vec::new();
        for &map in &self.wanted {
            let drawn = known.get(map).and_then(|file| value_map::of(file, &view.clients.tables));
            // A body that nothing heats yet has no table.
            let Some(ValueMap { across, down, values, .. }) = drawn else { continue };
            let cells = Cells { map, across, down };
            let bytes = Bytes::from(bytes(&cells, &values, is_past));
            let shown = self.shown.get(&map);
            if shown.is_none_or(|(before, _)| *before != cells) {
                news.push(New::Cells(cells.clone()));
            }
            if shown.is_none_or(|(_, before)| *before != bytes) {
                news.push(New::Values(bytes.clone()));
                self.shown.insert(map, (cells, bytes));
            }
        }
        news
    }
}

/// The values of a map as a message: `web/PROTOCOL.md`.
fn bytes(cells: &Cells, values: &[f64], is_past: bool) -> Vec<u8> {
    let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX).to_le_bytes();
    let mut bytes = Vec::with_capacity(HEAD_BYTES + 4 * values.len());
    bytes.extend([KIND, if is_past { PAST } else { 0 }, 0, 0]);
    bytes.extend(number(cells.map));
    bytes.extend([&cells.across, &cells.down].map(|axis| number(axis.edges.len().saturating_sub(1))).concat());
    for value in values {
        #[expect(clippy::cast_possible_truncation, reason = "for the eye")]
        bytes.extend((*value as f32).to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use onescan_server::client::{Parts, ValueTable};
    use onescan_server::signal::ClientName;
    use onescan_server::time::VirtualTime;

    use super::*;

    fn file(row: u32) -> MapFile {
        let text = format!("name = 'a'\nclient = 'plc'\nvariable = 'GV_Last'\nrow = {row}\nfirst = 1\nunit = '°C'");
        toml::from_str(&text).unwrap()
    }

    fn view(values: &[f64]) -> SessionView {
        let mut view = SessionView::before(0);
        view.clients.clear(Parts::ALL);
        view.t_v = VirtualTime::from_nanos(5);
        let table = |client: &str, columns, values: &[f64]| ValueTable {
            client: ClientName::new(client).unwrap(),
            name: "GV_Last".into(),
            columns,
            across: [0.0, 1.0],
            down: [0.0, 1.0],
            values: values.to_vec(),
        };
        view.clients.tables = vec![table("other", 3, &[9.0; 3]), table("plc", 6, &[8.0; 6]), table("plc", 3, values)];
        view
    }

    #[test]
    fn what_is_new_is_shown() {
        let known = [file(3)];
        let mut mapped = Mapped::default();
        assert!(mapped.see(&view(&[1.0; 6]), &known, false).is_empty(), "nobody looks");
        mapped.want(vec![0], &known).unwrap();
        let first = mapped.see(&view(&[0.0, 1.0, 2.0, 0.0, 3.0, 4.0]), &known, false);
        let [New::Cells(cells), New::Values(bytes)] = &first[..] else { panic!("{first:?}") };
        assert_eq!((&*cells.across.edges, &*cells.down.edges), (&[0.0, 1.0, 2.0][..], &[0.0, 1.0, 2.0][..]));
        assert_eq!(bytes[..HEAD_BYTES], [2, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0]);
        let values: Vec<f32> =
            bytes[HEAD_BYTES..].as_chunks().0.iter().map(|value| f32::from_le_bytes(*value)).collect();
        assert_eq!(values, [1.0, 2.0, 3.0, 4.0]);
        assert!(mapped.see(&view(&[0.0, 1.0, 2.0, 0.0, 3.0, 4.0]), &known, false).is_empty(), "nothing has changed");
        let next = mapped.see(&view(&[0.0, 1.0, 2.0, 0.0, 3.0, 5.0]), &known, false);
        assert!(matches!(&next[..], [New::Values(_)]), "{next:?}");
        let past = mapped.see(&view(&[0.0, 1.0, 2.0, 0.0, 3.0, 5.0]), &known, true);
        assert!(matches!(&past[..], [New::Values(bytes)] if bytes[1] == PAST), "{past:?}");
        let more = mapped.see(&view(&[0.0, 1.0, 2.0]), &known, true);
        assert!(matches!(&more[..], [New::Cells(_), New::Values(_)]), "a row less: {more:?}");
    }

    #[test]
    fn a_map_that_is_not_there_is_refused() {
        let mut mapped = Mapped::default();
        assert_eq!(mapped.want(vec![0, 1], &[file(3)]), Err(Refused::NoMap(1)));
        assert!(!mapped.is_wanted());
        // none of this name is a row of six without its first
        mapped.want(vec![0], &[file(5)]).unwrap();
        assert!(mapped.see(&view(&[1.0; 6]), &[file(5)], false).is_empty());
    }
}
