//! `onescan model`: the states of a session as a table, or as a model for NuSMV.

mod error;

use std::io::Write;
use std::path::PathBuf;

use onescan_report::OutputError;
use onescan_report::file::write_output;
use onescan_server::nusmv::{self, Size};
use onescan_server::state::ServerState;

pub use error::ModelError;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct ModelConfig {
    /// The size of the model for NuSMV; the table if absent.
    pub nusmv: Option<Size>,
    /// The file; what is typed to if absent.
    pub output: Option<PathBuf>,
}

/// Writes the model to its file, or to `out`.
///
/// # Errors
/// It cannot be written.
pub fn write(config: &ModelConfig, out: &mut dyn Write) -> Result<(), ModelError> {
    let text = config.nusmv.map_or_else(table, nusmv::model);
    match &config.output {
        Some(path) => write_output(path, text.as_bytes())?,
        None => out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(OutputError)?,
    }
    Ok(())
}

/// The table by which a session runs.
fn table() -> String {
    let row = |[server, clients, then]: [&str; 3]| format!("{server:15}{clients:9}{then}\n");
    let of = |state: ServerState| row([&state.to_string(), &state.of_clients().to_string(), &state.next().to_string()]);
    row(["server", "clients", "then"]) + &ServerState::ALL.map(of).concat()
}
