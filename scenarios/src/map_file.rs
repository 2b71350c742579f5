//! `[[map]]` of `scenario.toml`, as it is written: tables of values that a run draws when it is over.

use onescan_plant::scanner::Optics;
use onescan_server::signal::ClientName;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::form::Name;

/// A table of values over two axes, drawn by `onescan run --maps`: the surface of a body of a plant, or an array of a
/// soft PLC.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapFile {
    /// Its name among maps, and of its files.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// What it shows, in one line.
    #[serde(default)]
    pub title: String,
    /// The client that has it.
    #[schemars(with = "Name")]
    pub client: Spanned<ClientName>,
    /// Of a plant: the body whose surface is shown, unrolled: position along it, and angle around it.
    #[schemars(with = "Option<String>")]
    pub body: Option<Spanned<String>>,
    /// Of a soft PLC: an array, row after row in memory, by its path.
    #[schemars(with = "Option<String>")]
    pub variable: Option<Spanned<String>>,
    /// Elements of a row of the array, all of them.
    pub row: Option<u32>,
    /// Elements in front of the first that is shown of each row.
    #[serde(default)]
    pub first: u32,
    /// Elements that are shown of each row; all behind `first` if absent.
    pub points: Option<u32>,
    /// Rows that are shown; all if absent.
    pub rows: Option<u32>,
    /// What the bytes 0 and 255 of the array mean; the elements themselves if absent.
    pub bytes_mean: Option<[f64; 2]>,
    /// How a scanner looks at a shell: its points lie where it sees them, in m.
    pub optics: Option<OpticsFile>,
    /// The unit of the values.
    #[serde(default)]
    pub unit: String,
    /// What a row is.
    #[serde(default)]
    pub rows_are: String,
    /// The values of the ends of the colours' scale; the least and the greatest of the map if absent.
    pub scale: Option<[f64; 2]>,
}

/// How a line scanner with a field of 90° looks at a shell.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OpticsFile {
    /// The place along the shell that the middle of its field sees, m.
    pub middle_m: f64,
    /// From the scanner to the shell, m.
    pub distance_m: f64,
}

impl OpticsFile {
    /// Where the spots of so many points begin and end along the shell, m.
    pub fn edges_m(self, points: usize) -> Vec<f64> {
        let optics = Optics { middle_m: self.middle_m, distance_m: self.distance_m, off_square_deg: 0.0 };
        (0..=points).filter_map(|edge| optics.edge_m(edge, points)).collect()
    }
}

impl MapFile {
    /// The name under which its client shows it.
    pub fn shown_as(&self) -> Option<&str> {
        self.body.as_ref().or(self.variable.as_ref()).map(|name| name.get_ref().as_str())
    }
}
