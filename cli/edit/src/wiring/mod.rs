//! The wiring of a scenario: one map of all signals between its clients, and what is wrong with it.
//!
//! A session stops at the first signal that cannot be connected; here all of them are reported.
//!
//! | module | subject |
//! |---|---|
//! | `ends` | where signals begin and end inside of a client |
//! | `map` | the map: writers, readers, troubles |
//! | `strain` | what scenes ask of plants beyond what these carry |
//! | `fold` | many lines that differ in an index as one |
//! | `text` | the map for people |
//! | `drawing` | the map as SVG |

mod drawing;
mod ends;
mod error;
mod fold;
mod map;
mod strain;
mod text;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use onescan_report::OutputError;
use onescan_report::file::write_output;
use onescan_scenario::Scenario;
use serde::Serialize;

use onescan_runner::format::Format;

use strain::Strain;

pub use error::WiringError;
pub use map::{Map, OpenInput, Trouble, TroubleKind, UndrivenInput};

/// What to report about a scenario's wiring.
#[derive(Clone, Debug)]
pub struct WiringConfig {
    /// The scenario: a folder or a file.
    pub scenario: PathBuf,
    /// For people or machines.
    pub format: Format,
    /// Where to draw it, if anywhere.
    pub svg: Option<PathBuf>,
}

/// The map for machines, with what it does not need where it is made again at every change.
#[derive(Serialize)]
struct Whole<'m> {
    #[serde(flatten)]
    map: &'m Map,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    plants: Vec<Strain>,
}

/// Writes the wiring of a scenario; true if nothing is wrong with it.
///
/// # Errors
/// A scenario, scene or source that cannot be read; those of `out` and of the drawing's file.
pub fn write(config: &WiringConfig, out: &mut dyn Write) -> Result<bool, WiringError> {
    let scenario = Scenario::load(&config.scenario)?;
    let map = Map::of(&scenario)?;
    if let Some(path) = &config.svg {
        draw(&map, scenario.name(), path)?;
    }
    match config.format {
        Format::Json => {
            let whole = Whole { map: &map, plants: strain::of(&scenario)? };
            serde_json::to_writer_pretty(&mut *out, &whole).map_err(io::Error::from).map_err(OutputError)?;
            writeln!(out).map_err(OutputError)?;
        }
        Format::Human => {
            text::write(&map, out).map_err(OutputError)?;
            strain::write(&strain::of(&scenario)?, out).map_err(OutputError)?;
        }
    }
    Ok(map.is_sound())
}

fn draw(map: &Map, title: &str, path: &Path) -> Result<(), WiringError> {
    Ok(write_output(path, drawing::svg(map, title).as_bytes())?)
}
