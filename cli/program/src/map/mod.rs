//! `onescan map`: every point of a gateway with its address, before anything runs.
//!
//! | module | subject |
//! |---|---|
//! | [`fragment`] | a mapping as a part of a `scenario.toml` |
//! | `table` | the mapping for people and machines |

mod error;
pub mod fragment;
mod table;

use std::io::Write;
use std::path::PathBuf;

use onescan_links::gateway::listing::Listing;
use onescan_report::OutputError;
use onescan_report::file::write_output;
use onescan_scenario::Scenario;
use onescan_server::signal::ClientName;

pub use error::MapError;
pub use fragment::Fragment;

use self::table::Table;
use onescan_runner::error::Usage;
use onescan_runner::format::Format;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct MapConfig {
    /// The scenario: a folder or a file.
    pub scenario: PathBuf,
    /// The PLC; the only one if absent.
    pub client: Option<ClientName>,
    /// A PLC and its URL, if that is not where the scenario says.
    pub gateway: Option<(ClientName, Option<String>)>,
    /// For people or machines.
    pub format: Format,
    /// File for the mapping, as a part of a `scenario.toml`.
    pub output: Option<PathBuf>,
}

/// Writes the mapping of a PLC to `out`, and into a file if that is asked for.
///
/// # Errors
/// The scenario or its mapping is wrong, or nothing says where the PLC is.
pub fn run(config: &MapConfig, out: &mut dyn Write) -> Result<(), MapError> {
    let mut scenario = Scenario::load(&config.scenario)?;
    let (name, url) = the_plc(&scenario, config)?;
    scenario.commission(&name, url)?;
    let agreed = scenario.agreement(&name)?;
    let listing = Listing::new(&agreed.settings, &agreed.exchange);
    let listing = listing.map_err(|fault| scenario.wrong_settings(&name, fault))?;
    let table = Table { client: name.as_str(), url: &agreed.settings.url, layout: agreed.layout, listing: &listing };
    match config.format {
        Format::Json => table.write_json(out),
        Format::Human => table.write(out),
    }
    .and_then(|()| out.flush())
    .map_err(OutputError)?;
    match &config.output {
        Some(path) => Ok(write_output(path, Fragment::of(&name, &agreed, &listing).to_string().as_bytes())?),
        None => Ok(()),
    }
}

/// The PLC that is meant, and its URL if that is not the scenario's.
fn the_plc(scenario: &Scenario, config: &MapConfig) -> Result<(ClientName, Option<String>), MapError> {
    match (&config.client, &config.gateway) {
        (Some(client), Some((name, _))) if client != name => {
            let message = format!("--client {client} and --gateway {name} are two PLCs");
            return Err(Usage::new(message, Some("one mapping is printed at a time".to_owned())).into());
        }
        (_, Some((name, url))) => return Ok((name.clone(), url.clone())),
        (Some(name), None) => return Ok((name.clone(), None)),
        (None, None) => {}
    }
    let clients = scenario.file().clients.iter();
    let mut plcs = clients.filter(|(_, client)| client.get_ref().is_plc()).map(|(name, _)| name);
    match (plcs.next(), plcs.next()) {
        (Some(one), None) => Ok((one.clone(), None)),
        (None, _) => Err(Usage::new("the scenario has no PLC", None).into()),
        (Some(one), Some(other)) => {
            let help = Some(format!("say which: `--client {one}` or `--client {other}`"));
            Err(Usage::new("the scenario has several PLCs", help).into())
        }
    }
}
