//! `onescan browse`: what a PLC has, and a mapping to start from.

mod error;

use std::io::Write;
use std::path::PathBuf;

use onescan_clients::gateway::Settings;
use onescan_clients::gateway::link::Found;
use onescan_report::OutputError;
use onescan_report::file::write_whole;
use onescan_scenario::Scenario;
use onescan_scenario::file::ClientFile;
use onescan_server::signal::{ClientName, nearest};
use serde::Serialize;

pub use error::BrowseError;

use crate::format::Format;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct BrowseConfig {
    /// The PLC.
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
    let text = match &scenario {
        Some((scenario, name)) => mapping(scenario, name, &config.url, &found),
        None => everything(&config.url, &found),
    };
    Ok(write_whole(path, text.as_bytes())?)
}

/// The link that the scenario declares.
fn declared(scenario: &Scenario, name: &ClientName) -> Result<Settings, BrowseError> {
    match scenario.file().clients.get(name).map(toml::Spanned::get_ref) {
        Some(ClientFile::SoftPlc { gateway, .. }) => Ok(gateway.clone().unwrap_or_default()),
        Some(ClientFile::Gateway { gateway, .. }) => Ok(gateway.clone()),
        _ => Err(scenario.wrong_client(name, format!("`{name}` is no PLC of the scenario"), None).into()),
    }
}

fn human(found: &[Found], out: &mut dyn Write) -> std::io::Result<()> {
    let width = found.iter().map(|found| found.name.chars().count()).max().unwrap_or(0);
    for Found { name, address, ty, is_writable } in found {
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

/// A line of the mapping; TOML's strings are JSON's, for what a name or an address holds.
fn entry(name: &str, address: &str) -> String {
    format!("{} = {}\n", serde_json::Value::from(name), serde_json::Value::from(address))
}

/// The scenario's signals, each with the variable of its name, or the nearest to look at.
fn mapping(scenario: &Scenario, client: &ClientName, url: &str, found: &[Found]) -> String {
    let mut text = format!(
        "[clients.{client}.gateway]\nurl = {}\n\n[clients.{client}.gateway.map]\n",
        serde_json::Value::from(url)
    );
    let words = onescan_clients::gateway::exchange::WORDS_TO_PLC.iter();
    let words = words.chain(&onescan_clients::gateway::exchange::WORDS_FROM_PLC).map(|(word, _)| *word);
    let signals = scenario.file().signals.keys().map(onescan_server::signal::SignalName::as_str);
    for name in signals.chain(words) {
        let is_it = |found: &&Found| last(&found.name).eq_ignore_ascii_case(last(name));
        if let Some(found) = found.iter().find(is_it) {
            text += &entry(name, &found.address);
            continue;
        }
        let near = nearest(name, found.iter().map(|found| found.name.as_str()));
        let near = near.and_then(|near| found.iter().find(|found| found.name == near));
        let near = near.map(|near| format!("; perhaps {}", near.address)).unwrap_or_default();
        text.extend(["# ", name, " was not found", &near, "\n"]);
    }
    text
}

/// The last name of a path.
fn last(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// Every variable that a signal can be.
fn everything(url: &str, found: &[Found]) -> String {
    let mut text =
        format!("[clients.plc.gateway]\nurl = {}\n\n[clients.plc.gateway.map]\n", serde_json::Value::from(url));
    text.extend(found.iter().filter(|found| found.ty.is_some()).map(|found| entry(&found.name, &found.address)));
    text
}
