//! `onescan browse`: what a PLC has, and a mapping to start from.
//!
//! | module | subject |
//! |---|---|
//! | `matching` | which variable of the PLC is which point |

mod error;
mod matching;

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use onescan_base::foreign::one_line;
use onescan_links::gateway::Settings;
use onescan_links::gateway::link::Found;
use onescan_report::OutputError;
use onescan_report::file::write_output;
use onescan_scenario::Scenario;
use onescan_server::signal::ClientName;
use serde::Serialize;

pub use error::BrowseError;

use crate::map::fragment::{Entry, Fragment, Place, by_name};
use onescan_runner::format::Format;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct BrowseConfig {
    pub url: String,
    /// The scenario whose signals are mapped, and the client that speaks for the PLC.
    pub scenario: Option<(PathBuf, ClientName)>,
    /// File for the mapping.
    pub map: Option<PathBuf>,
    /// For whom the list is.
    pub format: Format,
}

/// A variable for machines.
#[derive(Serialize)]
struct Line<'a> {
    name: &'a str,
    address: &'a str,
    #[serde(rename = "type")]
    ty: Option<String>,
    writable: bool,
}

/// Lists the PLC's variables to `out`, and writes the mapping.
///
/// # Errors
/// The PLC cannot be reached or has no names, or the scenario is wrong.
pub fn run(config: &BrowseConfig, out: &mut dyn Write) -> Result<(), BrowseError> {
    let scenario = config.scenario.as_ref().map(|(path, name)| Ok::<_, BrowseError>((Scenario::load(path)?, name)));
    let scenario = scenario.transpose()?;
    let declared = match &scenario {
        Some((scenario, name)) => declared(scenario, name)?,
        None => Settings::default(),
    };
    let settings = Settings { url: config.url.clone(), ..declared };
    let found = settings.browse()?;
    let listed = match config.format {
        Format::Json => json(&found, out),
        Format::Human => human(&found, out),
    };
    listed.and_then(|()| out.flush()).map_err(OutputError)?;
    let Some(path) = &config.map else { return Ok(()) };
    let fragment = match &scenario {
        Some((scenario, name)) => {
            // What is mapped already is not asked for: the mapping is to be made again.
            let unmapped = Settings { map: BTreeMap::new(), ..settings };
            let agreed = scenario.agreement_over(name, unmapped)?;
            Fragment { client: name.to_string(), url: config.url.clone(), ..matching::mapped(&agreed.exchange, &found) }
        }
        None => everything(&config.url, &found),
    };
    Ok(write_output(path, fragment.to_string().as_bytes())?)
}

/// The link that the scenario declares.
fn declared(scenario: &Scenario, name: &ClientName) -> Result<Settings, BrowseError> {
    match scenario.file().clients.get(name).map(toml::Spanned::get_ref) {
        Some(client) if client.is_plc() => Ok(scenario.declared(name)),
        _ => Err(scenario.wrong_client(name, format!("`{name}` is no PLC of the scenario"), None).into()),
    }
}

fn human(found: &[Found], out: &mut dyn Write) -> std::io::Result<()> {
    let width = found.iter().map(|found| one_line(&found.name).chars().count()).max().unwrap_or(0);
    for Found { name, address, ty, is_writable } in found {
        // What a PLC calls its variables is text of others.
        let (name, address) = (one_line(name), one_line(address));
        let ty = ty.map_or_else(|| "?".to_owned(), |ty| ty.to_string());
        let access = if *is_writable { "read, write" } else { "read" };
        writeln!(out, "{name:width$}  {ty:8} {access:11}  {address}")?;
    }
    let count = found.len();
    writeln!(out, "{count} variable{}", if count == 1 { "" } else { "s" })
}

fn json(found: &[Found], out: &mut dyn Write) -> std::io::Result<()> {
    for Found { name, address, ty, is_writable } in found {
        let line = Line { name, address, ty: ty.map(|ty| ty.to_string()), writable: *is_writable };
        serde_json::to_writer(&mut *out, &line)?;
        writeln!(out)?;
    }
    Ok(())
}

/// Every variable that a signal can be; those that have the same name are the points of one.
fn everything(url: &str, found: &[Found]) -> Fragment {
    let typed = found.iter().filter(|found| found.ty.is_some());
    let names = by_name(typed.map(|found| (found.name.as_str(), found)));
    let entry = |(name, all): (&str, Vec<&Found>)| {
        let place = |found: &&Found| match all.len() {
            1 => Place::Only(found.address.clone()),
            _ => Place::Next(found.address.clone()),
        };
        Entry::Mapped { name: name.to_owned(), places: all.iter().map(place).collect() }
    };
    let entries = names.into_iter().map(entry).collect();
    Fragment { client: "plc".to_owned(), url: url.to_owned(), system_words: false, entries }
}
