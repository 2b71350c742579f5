//! The library of components, listed, or one kind in full.

use std::io::Write;

use onescan_clients::plant::component::kind::Kind;
use onescan_clients::plant::component::kinds;
use onescan_clients::plant::component::page::page;
use onescan_report::OutputError;
use onescan_server::signal::did_you_mean;

use super::error::PlantError;
use crate::error::Usage;
use crate::format::Format;

/// Writes every kind with a line about it, or all about one.
///
/// # Errors
/// There is no such kind; those of `out`.
pub fn write(name: Option<&str>, format: Format, out: &mut dyn Write) -> Result<(), PlantError> {
    let all = kinds();
    let Some(name) = name else {
        return match format {
            Format::Json => json(&all, out),
            Format::Human => Ok(list(&all, out).map_err(OutputError)?),
        };
    };
    let kind = all.iter().find(|kind| kind.name == name).ok_or_else(|| {
        let help = did_you_mean(name, all.iter().map(|kind| kind.name));
        let help = help.unwrap_or_else(|| "`onescan components` names them all".to_owned());
        Usage::new(format!("there is no component `{name}`"), Some(help))
    })?;
    match format {
        Format::Json => json(kind, out),
        Format::Human => Ok(out.write_all(page(kind).as_bytes()).map_err(OutputError)?),
    }
}

fn list(all: &[Kind], out: &mut dyn Write) -> std::io::Result<()> {
    let width = all.iter().map(|kind| kind.name.len()).max().unwrap_or_default();
    all.iter().try_for_each(|kind| writeln!(out, "{:width$}  {}", kind.name, kind.summary))
}

fn json(value: &(impl serde::Serialize + ?Sized), out: &mut dyn Write) -> Result<(), PlantError> {
    serde_json::to_writer_pretty(&mut *out, value).map_err(std::io::Error::from).map_err(OutputError)?;
    Ok(writeln!(out).map_err(OutputError)?)
}
