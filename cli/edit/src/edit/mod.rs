//! The editor of a scenario in a browser: `onescan edit`. Connections are drawn, a machine is built, and both are written into
//! the files as a person would have written them.
//!
//! | module | subject |
//! |---|---|
//! | [`change`] | a change, as data, and the files that it is made in |
//! | `document` | a TOML file as text, and the places in it where something is written |
//! | `field` | what a table of a scene may say, with units and ranges |
//! | `reference` | who refers to what |
//! | `wire` | connections in `scenario.toml` |
//! | `construct` | the tables of a scene |
//! | `apply` | what a change makes of the files |
//! | [`workspace`] | the files as they are worked on: changed, taken back, done again |
//! | `files` | the files on the disk |
//! | [`ends`] | where connections can begin and end |
//! | [`join`] | which changes connect two ends |
//! | `finding` | what the check finds, with places |
//! | `state` | all that the page shows |
//! | `server` | the page, served to browsers of this machine |
//!
//! Up to `workspace` no module reads or writes a file. What is written is checked by the code of every other command; nothing here
//! knows what a correct scenario is. The protocol is in `web/PROTOCOL.md`.

mod apply;
pub mod change;
mod construct;
mod document;
pub mod ends;
pub mod error;
mod field;
mod files;
mod finding;
pub mod join;
mod reference;
mod server;
mod state;
mod wire;
pub mod workspace;

use onescan_base::notice::NOTICE;
use std::net::SocketAddr;
use std::path::PathBuf;

pub use error::EditorError;

use files::Files;
use onescan_runner::access::admission::Admission;
use onescan_runner::how_far::HowFar;
use onescan_runner::web;
use server::Editor;

/// What is edited, and where.
#[derive(Clone, Debug)]
pub struct EditConfig {
    /// The scenario: a folder or a file.
    pub scenario: PathBuf,
    /// Where the page is served; an address of this machine.
    pub address: SocketAddr,
    /// Counts the changes that are written, for one whom a signal interrupts.
    pub how_far: HowFar,
}

/// Serves the editor until the program is ended, and says where it is.
///
/// # Errors
/// Files that cannot be read; an address that cannot be listened on, or that others reach.
pub fn serve(config: &EditConfig) -> Result<(), EditorError> {
    web::of_this_machine(config.address, &Admission::ThisMachine)?;
    let editor = Editor::open(Files::of(&config.scenario)?, config.address, config.how_far.clone())?;
    match web::Page::is_absent() {
        None => tracing::info!(target: NOTICE, "the editor is at {}", editor.url()),
        Some(how) => tracing::warn!(target: NOTICE, "no page at {}: {how}", editor.url()),
    }
    editor.serve()
}
