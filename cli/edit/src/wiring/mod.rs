//! The wiring of a scenario: one map of all signals between its clients, and what is wrong with it.
//!
//! A session stops at the first signal that cannot be connected; here all of them are reported.
//!
//! | module | subject |
//! |---|---|
//! | `ends` | where signals begin and end inside of a client |
//! | `map` | the map: writers, readers, troubles |
//! | `fold` | many lines that differ in an index as one |
//! | `text` | the map for people |
//! | `drawing` | the map as SVG |

mod drawing;
mod ends;
mod error;
mod fold;
mod map;
mod text;

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_report::OutputError;
use onescan_report::file::write_whole;
use onescan_scenario::Scenario;

use onescan_runner::format::Format;

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
            serde_json::to_writer_pretty(&mut *out, &map).map_err(std::io::Error::from).map_err(OutputError)?;
            writeln!(out).map_err(OutputError)?;
        }
        Format::Human => text::write(&map, out).map_err(OutputError)?,
    }
    Ok(map.is_sound())
}

fn draw(map: &Map, title: &str, path: &Path) -> Result<(), WiringError> {
    Ok(write_whole(path, drawing::svg(map, title).as_bytes())?)
}
